"""How strongly the weight of a body tilts it out of the pads, against couples of forces found by hand."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from prag_asp.physics.grasps.antipodal import lever_of
from prag_asp.physics.grasps.pads import TOUCH, PadContact, PadPatch, ParallelGripper
from prag_asp.physics.grasps.tilting import tilting_load
from prag_asp.scene.geometry import Pose, matrix
from prag_asp.scene.robots.panda import PANDA
from prag_asp.scene.scene import Shape
from prag_asp.scene.surfaces import surface
from tests.chance import Chance

GRIPPER = ParallelGripper.of(PANDA)
HEIGHT, BREADTH = GRIPPER.high_z - GRIPPER.low_z, 2 * GRIPPER.half_x
DOWN = Pose((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
FROM_THE_SIDE = Pose((0.0, 0.0, 0.0), (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)))
"""The fingers point along x; both tools close along y."""


def wall(slope: float = 0.0) -> NDArray[np.float64]:
    """Return a wall of 100 x 4 x 100 mm that leans towards y, by a slope."""
    triangles = surface(Shape("box", (0.1, 0.004, 0.1)))
    leaning: NDArray[np.float64] = triangles + slope * triangles[:, :, 2:] * (0.0, 1.0, 0.0)
    return leaning


@pytest.mark.parametrize(("tool", "longest"), [(DOWN, HEIGHT), (FROM_THE_SIDE, BREADTH)])
@pytest.mark.parametrize("aside", [0.05, -0.05])
def test_both_ends_of_the_pads_bear_what_hangs_aside(tool: Pose, longest: float, aside: float) -> None:
    load = tilting_load(wall(), (0.02, aside, -0.03), GRIPPER, tool, friction=0.5)
    assert load.pressure == pytest.approx(abs(aside) / longest, rel=1e-6)
    assert load.total == pytest.approx(abs(aside) / (longest + 0.5 * 0.004), rel=1e-6)


@pytest.mark.parametrize("lean", [1.0, -1.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_wall_that_leans_away_from_the_weight_is_held_by_less_than_one_that_leans_towards_it(
    lean: float, side: float
) -> None:
    """The pad on the side of the weight has to press at the top, the other one at the bottom.

    Upright pads touch a leaning wall within `TOUCH` of its outermost points: where it leans to at the top, else below.
    """
    slope = 0.1
    longest = HEIGHT if lean * side > 0.0 else 2 * TOUCH / slope - HEIGHT
    load = tilting_load(wall(lean * slope), (0.0, side * 0.05, 0.0), GRIPPER, DOWN, friction=0.5)
    assert load.pressure == pytest.approx(0.05 / longest, rel=1e-6)


def test_the_lever_of_a_slanted_grip_is_the_torque_about_the_line_between_the_pads(chance: Chance) -> None:
    rng = chance.generator(5)
    patch = PadPatch(1e-4, (0.002, -0.003), 0.005, 1.0)
    contact = PadContact(-0.01, 0.01, (patch, patch))
    for _ in range(100):
        turn = np.array([rng.gauss(0.0, 1.0) for _ in range(4)])
        tool = Pose(tuple(rng.uniform(-0.1, 0.1) for _ in range(3)), tuple((turn / np.linalg.norm(turn)).tolist()))
        centre = tuple(rng.uniform(-0.1, 0.1) for _ in range(3))
        frame = matrix(tool)
        at = frame[:3, :3] @ (0.002, 0.0, -0.003) + frame[:3, 3]
        torque = np.cross(np.array(centre) - at, (0.0, 0.0, -1.0)) @ frame[:3, 1]
        assert lever_of(centre, tool, contact) == pytest.approx(abs(torque), abs=1e-12)


def test_nothing_tilts_that_hangs_below_the_pads_or_is_not_between_them() -> None:
    assert tilting_load(wall(), (0.03, 0.0, -0.04), GRIPPER, DOWN, 0.5) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert tilting_load(np.add(wall(), (0.0, 0.2, 0.0)), (0.0, 0.05, 0.0), GRIPPER, DOWN, 0.5) == (0.0, 0.0)
