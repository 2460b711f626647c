from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from prag_asp.errors import QueryError
from prag_asp.scene.cameras import Camera
from prag_asp.scene.colours import apart
from prag_asp.scene.scene import BodyModel, Material, Ranges, Scene, Shape, Solid
from prag_asp.scene.scene_loader import parse_scene, scene_problems
from prag_asp.scene.solids import weight
from prag_asp.scene.variation import KINDS, USUAL_LIGHT, Variation, draw_variation, variation_of
from tests.scene.read.test_scene_table import CLASSES, ENTITIES, FINE

CUBE = Shape("box", (0.05, 0.05, 0.05))
MUG = Shape("urdf", (0.1, 0.1, 0.1), model=BodyModel((Solid("box", (0.1, 0.1, 0.1)),), 0.3))
SCENE = Scene(
    {"cube_1": CUBE, "mug_1": MUG, "tray_1": CUBE, "desk": Shape("table")},
    colors={"cube_1": "#e4572e", "mug_1": "#2e86ab"},
    fixed={"tray_1": (0.5, 0.0, 0.0)},
    materials={"cube_1": Material(800.0, 0.5)},
    cameras={"front": Camera((1.0, 0.0, 1.0), (0.4, 0.0, 0.0)), "top": Camera((0.4, 0.0, 1.0), (0.4, 0.0, 0.0))},
    vary=Ranges((0.5, 2.0), (0.9, 1.5), 20.0, 0.1, 15.0),
)
OBJECTS = ("mug_1", "cube_1", "tray_1")


@pytest.fixture(scope="module")
def drawn() -> list[Variation]:
    return [draw_variation(SCENE, KINDS, OBJECTS, [seed, 0]) for seed in range(60)]


def test_what_is_drawn_stays_within_its_range_and_uses_it(drawn):
    frictions = [each.friction["cube_1"] / 0.5 for each in drawn]
    masses = [each.mass["mug_1"] / 0.3 for each in drawn]
    usual = np.array(USUAL_LIGHT) / np.linalg.norm(USUAL_LIGHT)
    turns = [math.degrees(math.acos(min(1.0, float(np.dot(each.light, usual))))) for each in drawn]
    moved = [math.dist(each.cameras["top"][0], (0.4, 0.0, 1.0)) for each in drawn]
    recoloured = [apart(each.colours["mug_1"], "#2e86ab") for each in drawn]
    for found, low, high in (
        (frictions, 0.5, 2.0), (masses, 0.9, 1.5), (turns, 0.0, 20.0), (moved, 0.0, 0.1), (recoloured, 0.0, 17.0),
    ):  # fmt: skip
        assert low <= min(found) and max(found) <= high
        assert np.ptp(found) > 0.6 * (high - low)
    assert set(drawn[0].friction) == {*OBJECTS, "desk"}
    assert set(drawn[0].mass) == {"cube_1", "mug_1"}, "what is fixed weighs nothing"


def test_what_else_is_drawn_changes_nothing_and_neither_does_the_order_of_the_objects(drawn):
    for kind in KINDS:
        alone = draw_variation(SCENE, (kind,), sorted(OBJECTS), [3, 0])
        name = {"camera": "cameras", "colour": "colours"}.get(kind, kind)
        assert getattr(alone, name) == getattr(drawn[3], name)
        assert alone == Variation(**{name: getattr(alone, name)})


def test_what_was_drawn_survives_its_text(drawn):
    for each in drawn:
        assert variation_of(each.to_text()) == each
    assert variation_of("{}") == Variation()


def test_what_was_drawn_is_what_the_scene_then_has(drawn):
    one = drawn[0]
    scene = one.applied(SCENE)
    assert scene.material("cube_1").friction == one.friction["cube_1"]
    for entity, kilograms in one.mass.items():
        assert weight(scene, entity) == pytest.approx(kilograms)
    assert (scene.cameras["top"].at, scene.cameras["top"].look_at) == one.cameras["top"]
    assert scene.colors["cube_1"] == one.colours["cube_1"] and scene.table.color == one.colours["desk"]
    assert Variation().applied(SCENE) == SCENE
    assert one.applied(replace(SCENE, shapes={"cube_1": CUBE}, cameras={"front": SCENE.cameras["front"]})).cameras


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[", "not JSON"),
        ('{"friction": {"cube_1": -1}}', r"varied\.friction\.cube_1: needs a positive number; got -1"),
        ('{"mass": {"cube_1": 0}}', r"varied\.mass\.cube_1: needs a positive number; got 0"),
        ('{"mass": {"cube_1": "heavy"}}', r"varied\.mass\.cube_1: needs a finite number"),
        ('{"light": [0, 0, 0]}', r"varied\.light: has no direction"),
        ('{"light": [0, 1]}', r"varied\.light: needs a list of 3"),
        ('{"colours": {"cube_1": "red"}}', r"varied\.colours\.cube_1: needs a colour"),
        (
            '{"cameras": {"top": {"at": [0, 0, 1], "look_at": [0, 0, 1]}}}',
            r"varied\.cameras\.top: its target equals its position",
        ),
    ],
)
def test_a_text_of_another_form_is_reported(text, message):
    with pytest.raises(QueryError, match=message):
        variation_of(text)


def test_ranges_are_read_and_those_left_out_are_the_usual_ones():
    scene = parse_scene({**FINE, "vary": {"mass": [1, 2], "light": 10}}, CLASSES, ENTITIES)
    assert scene.vary == Ranges(mass=(1.0, 2.0), light=10.0)
    assert parse_scene(FINE, CLASSES, ENTITIES).vary == Ranges()


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"friction": 1.1}, "scene.vary.friction: needs a low and a high factor from 0.05 to 20"),
        ({"friction": [1.2, 0.8]}, "scene.vary.friction: needs a low and a high factor"),
        ({"mass": [0, 1]}, "scene.vary.mass: needs a low and a high factor"),
        ({"light": 90}, "scene.vary.light: needs a number from 0 to 80 (degrees); got 90"),
        ({"camera": -1}, "scene.vary.camera: needs a number from 0 to 0.4"),
        ({"color": 3}, "scene.vary.color: unknown key; did you mean colour?"),
    ],
)
def test_one_mistake_in_the_ranges_gives_one_line(table, message):
    (fault,) = scene_problems({**FINE, "vary": table}, CLASSES, ENTITIES)
    assert message in str(fault)
