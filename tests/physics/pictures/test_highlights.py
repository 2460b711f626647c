"""Outlines and close-ups, with pictures of a few pixels."""

from __future__ import annotations

import numpy as np
import pytest

from prag_asp.physics.filming.studio import open_studio
from prag_asp.physics.pictures.camera import picture
from prag_asp.physics.pictures.highlights import MARK, changed_entities, highlighted
from prag_asp.physics.pictures.sheet import LEGIBLE, PAGE, Panel, font, sheet, sheet_width, text_sizes, wrap
from prag_asp.physics.witness import Arm, Moment
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import PANDA
from tests.physics.scenarios import stacking

SIZE = (90, 80)
ARMS = {"panda": Arm(PANDA.home, 0.08)}
CUBE, BRICK = Pose((0.45, 0.0, 0.025)), Pose((0.5, 0.2, 0.02))
BEFORE = Moment({"cube_1": CUBE, "brick_1": BRICK}, ARMS)
AFTER = Moment({"cube_1": Pose((0.45, 0.0, 0.2)), "brick_1": BRICK}, ARMS)
NEAR = ((1.1, 0.2, 0.5), (0.45, 0.05, 0.05))


@pytest.fixture(scope="module")
def studio(tabletop):
    with open_studio(tabletop, ("cube_1", "brick_1")) as opened:
        yield opened


def marked(image) -> np.ndarray:
    """Return the pixels that look like an outline, shape (height, width)."""
    return np.abs(np.asarray(image).astype(int) - MARK).max(axis=-1) < 60


def test_what_an_action_moves_has_changed_and_else_what_its_subgoal_names(tabletop):
    moments = [BEFORE, AFTER, AFTER]
    assert changed_entities(stacking(), moments, tabletop, 0) == []
    assert changed_entities(stacking(), moments, tabletop, 1) == ["cube_1"]
    assert changed_entities(stacking(), moments, tabletop, 2) == ["brick_1"]


def test_only_what_has_changed_is_outlined(studio, tabletop):
    studio.show(BEFORE)
    plain = picture(studio, SIZE, NEAR)
    assert not marked(plain).any()
    both = [marked(highlighted(studio, BEFORE, tabletop, [entity], SIZE, NEAR)) for entity in ("cube_1", "brick_1")]
    columns = [np.nonzero(each)[1].mean() for each in both]
    assert all(8 < each.sum() < 400 for each in both)
    assert columns[1] > columns[0] + 10, "the brick stands to the right, at +y"


def test_an_object_behind_the_robot_gets_a_close_up_in_a_corner(studio, tabletop):
    behind = Moment({"cube_1": Pose((-0.12, 0.0, 0.025)), "brick_1": BRICK}, ARMS)
    view = ((1.4, 0.0, 0.12), (0.0, 0.0, 0.1))
    studio.show(behind)
    plain = np.asarray(picture(studio, SIZE, view)).astype(int)
    shown = np.asarray(highlighted(studio, behind, tabletop, ["cube_1"], SIZE, view)).astype(int)
    differ = np.abs(shown - plain).max(axis=-1) > 40
    rows, columns = np.nonzero(differ)
    assert differ.sum() > 300
    assert np.ptp(rows) < 40 and np.ptp(columns) < 40, "one square of two fifths of the picture's height"
    assert marked(shown).sum() > 20, "the cube is outlined in the close-up"


@pytest.mark.parametrize(("width", "columns"), [(90, 3), (260, 3), (360, 3), (360, 6), (960, 2)])
def test_captions_are_legible_at_the_width_of_a_page(width, columns):
    heading, text = text_sizes(width, columns)
    assert heading > text >= LEGIBLE * max(1.0, sheet_width(width, columns) / PAGE) - 0.01


def test_text_is_wrapped_within_its_picture():
    letters = font(text_sizes(90, 1)[1])
    lines = wrap("the red cube is on the yellow brick", letters, 88)
    assert len(lines) > 1 and all(letters.getlength(line) <= 88 for line in lines)
    from PIL import Image

    panels = [Panel(Image.new("RGB", SIZE), "one", "two three four")] * 4
    assert sheet(panels, 3).width == sheet_width(90, 2), "four pictures stand in two even rows"
