"""Cavities that are found on the geometry of bodies, and what stands in them and on them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from prag_asp.physics import check_witness, validate_task
from prag_asp.physics.situation import Situation
from prag_asp.physics.world.support import riders, unsupported
from prag_asp.scene.geometry import Pose
from prag_asp.scene.read.urdf import read_urdf
from prag_asp.scene.scene import Scene, Shape
from tests.physics.random_tasks import scene_with
from tests.physics.scenarios import state, task

PART = "<collision><origin xyz='{} {} {}' rpy='0 0 {}'/><geometry><box size='{} {} {}'/></geometry></collision>"
BODY = "<robot name='x'><link name='a'><inertial><mass value='0.2'/></inertial>{}</link></robot>"


def cup(wall: float = 0.04, handle: float = 0.0, floor: bool = True) -> str:
    """Return a URDF of a square cup, 64 mm wide inside, with a floor of 6 mm, and a handle on its +x side."""
    walls = [(0.035, 0, wall / 2, 0, 0.006, 0.076, wall), (-0.035, 0, wall / 2, 0, 0.006, 0.076, wall)]
    walls += [(0, 0.035, wall / 2, 0, 0.076, 0.006, wall), (0, -0.035, wall / 2, 0, 0.076, 0.006, wall)]
    parts = [*walls, *([(0, 0, 0.003, 0, 0.076, 0.076, 0.006)] if floor else [])]
    parts += [(0.038 + handle / 2, 0, 0.02, 0, handle, 0.01, 0.01)] if handle else []
    return BODY.format("".join(PART.format(*part) for part in parts))


def read(folder, text: str) -> Shape:
    (folder / "m.urdf").write_text(text)
    return read_urdf(folder / "m.urdf", folder)


@pytest.mark.parametrize("handle", [0.0, 0.03])
def test_the_cavity_of_a_cup_is_that_between_its_walls(tmp_path, handle):
    cavity = read(tmp_path, cup(handle=handle)).model.cavity
    # Cells of the grid are 1.2 mm wide without a handle, 1.7 mm with it.
    assert cavity.sides == pytest.approx((0.064, 0.064, 0.034), abs=0.004)
    assert cavity.sides[2] == pytest.approx(0.034, abs=1e-6)
    assert cavity.middle == pytest.approx((-handle / 2, 0.0, 0.006 - 0.02), abs=0.002)


@pytest.mark.parametrize(
    "text", [cup(floor=False), cup(wall=0.012), BODY.format(PART.format(0, 0, 0, 0.3, 0.05, 0.05, 0.05))]
)
def test_a_ring_a_shallow_dish_and_a_block_have_no_cavity(tmp_path, text):
    assert read(tmp_path, text).model.cavity is None


def test_a_round_cup_has_a_cavity_as_wide_as_its_inner_side(tmp_path):
    sides = 24
    wall = [
        PART.format(0.043 * math.cos(a), 0.043 * math.sin(a), 0.03, a, 0.006, 0.0125, 0.06)
        for a in np.arange(sides) * 2 * math.pi / sides
    ]
    floor = (
        "<collision><origin xyz='0 0 0.003'/><geometry><cylinder radius='0.043' length='0.006'/></geometry></collision>"
    )
    cavity = read(tmp_path, BODY.format("".join(wall) + floor)).model.cavity
    assert cavity.sides[:2] == pytest.approx((0.08, 0.08), abs=0.004)
    assert cavity.sides[2] == pytest.approx(0.054, abs=1e-3)


def test_a_ball_stands_in_a_cup_and_a_board_on_its_rim(tmp_path):
    shapes = {"cup": read(tmp_path, cup()), "ball": Shape("sphere", (0.04,) * 3), "lid": Shape("box", (0.1, 0.1, 0.01))}
    cup_at, within, above = Pose((0.5, 0.0, 0.02)), Pose((0.51, 0.0, 0.026)), Pose((0.5, 0.0, 0.045))
    places = {"cup": cup_at, "ball": within, "lid": above}
    situation = Situation(Scene(shapes), places)
    assert unsupported(situation, list(places)) is None
    assert sorted(riders(situation, "cup", places)) == ["ball", "lid"]
    beside = situation.with_pose("ball", Pose((0.55, 0.0, 0.026)))
    assert unsupported(beside, list(places)) == "ball"


@pytest.mark.parametrize(("cup_size", "feasible"), [(1.0, True), (0.6, False)])
def test_a_cube_is_in_a_cup_where_the_cavity_is_wide_enough(tmp_path, cup_size, feasible):
    # The cube is 50 mm wide, the cavity 64 mm, or 38.4 mm at 60 percent.
    text = cup()
    if cup_size < 1.0:
        text = cup().replace("0.035", "0.0222").replace("0.076", "0.0504")
    (tmp_path / "m.urdf").write_text(text)
    scene = scene_with(
        "tabletop",
        {"bin": {"kind": "urdf", "path": "m.urdf"}},
        folder=tmp_path,
        fixed={"bin_1": [0.5, 0.2]},
    )
    inside = task(state("inside(cube_1,bin_1)", "-holding(panda,cube_1)"))
    verdict = validate_task(inside, scene, seed=1)
    assert verdict.feasible == feasible
    assert not feasible or check_witness(inside, verdict.witness, scene) == []
