"""The width of a primitive between two pads, against lines between them."""

import math
import random

import numpy as np
import pytest

from prag_asp.physics.grasps.between_pads import PadWindow, width_between
from prag_asp.scene.geometry import Pose, matrix
from prag_asp.scene.robots.panda import PANDA
from prag_asp.scene.scene import Shape
from tests.chance import Chance

WINDOW = PadWindow.of(PANDA)
AT = Pose((0.0, 0.0, 0.0))
LINES = 121
"""Lines along either side of the pads: every 0.15 mm."""


def _by_lines(shape: Shape, pose: Pose) -> float:
    """Return the width of what lines along y meet of a body within the window."""
    x, z = (each.ravel() for each in np.meshgrid(np.linspace(*WINDOW.x, LINES), np.linspace(*WINDOW.z, LINES)))
    turn = matrix(pose)[:3, :3].T
    starts = turn @ (np.stack([x, np.zeros_like(x), z]) - np.array(pose.position)[:, None])
    way = turn[:, 1]
    low, high = np.full(x.shape, -np.inf), np.full(x.shape, np.inf)
    bands = {"box": (0, 1, 2), "cylinder": (2,), "sphere": ()}[shape.kind]
    around = {"box": (), "cylinder": (0, 1), "sphere": (0, 1, 2)}[shape.kind]
    with np.errstate(all="ignore"):
        for k in bands:
            ends = np.stack([(side * shape.half[k] - starts[k]) / way[k] for side in (-1, 1)])
            if abs(way[k]) < 1e-14:
                ends = np.where(np.abs(starts[k]) <= shape.half[k], [[-np.inf], [np.inf]], [[np.inf], [-np.inf]])
            else:
                ends.sort(axis=0)
            low, high = np.maximum(low, ends[0]), np.minimum(high, ends[1])
        if around:
            a = sum(way[k] ** 2 for k in around)
            b = sum(way[k] * starts[k] for k in around)
            c = sum(starts[k] ** 2 for k in around) - shape.half[0] ** 2
            root = np.sqrt(b * b - a * c)
            low, high = np.fmax(low, (-b - root) / a), np.fmin(high, (root - b) / a)
            high = np.where(b * b < a * c, -np.inf, high)
    met = low < high
    return float(high[met].max() - low[met].min()) if met.any() else 0.0


def _any_turn(rng: random.Random) -> tuple[float, float, float, float]:
    x, y, z, w = (rng.gauss(0.0, 1.0) for _ in range(4))
    x, y, w = rng.choice([(x, y, w), (x, y, w), (0.0, 0.0, w), (0.01 * x, 0.01 * y, 1.0), (1.0, 0.0, w)])
    length = math.hypot(x, y, z, w)
    return (x / length, y / length, z / length, w / length)


def test_no_line_between_the_pads_is_longer_and_a_near_one_is_as_long(chance: Chance) -> None:
    rng = chance.generator(1)
    for _ in range(chance.examples(150)):
        kind, wide = rng.choice(["box", "cylinder", "sphere"]), rng.uniform(0.01, 0.12)
        long = rng.uniform(0.01, 0.15)
        size = {"box": (wide, rng.uniform(0.01, 0.12), long), "cylinder": (wide, wide, long), "sphere": (wide,) * 3}
        shape = Shape(kind, size[kind])
        pose = Pose(tuple(rng.uniform(-0.04, 0.04) for _ in range(3)), _any_turn(rng))
        width, seen = width_between(shape, pose, WINDOW, AT), _by_lines(shape, pose)
        assert seen - 1e-9 <= width <= seen + 1e-3, (shape, pose)


@pytest.mark.parametrize("turn", [(0.5**0.5, 0.0, 0.0, 0.5**0.5), (0.0, 0.5**0.5, 0.0, 0.5**0.5), (0.0, 0.0, 0.0, 1.0)])
@pytest.mark.parametrize("x", [0.0, 0.02])
def test_a_can_that_is_parallel_to_an_axis_of_the_tool_is_as_wide_as_lines_say(turn, x) -> None:
    shape, pose = Shape("cylinder", (0.066, 0.066, 0.1)), Pose((x, 0.003, 0.002), turn)
    assert width_between(shape, pose, WINDOW, AT) == pytest.approx(_by_lines(shape, pose), abs=1e-6)


def test_a_can_that_leans_is_wider_only_by_what_it_leans_between_the_pads() -> None:
    lean = math.radians(3.5)
    pose = Pose((0.0, 0.0, 0.0), (math.sin(lean / 2), 0.0, 0.0, math.cos(lean / 2)))
    expected = 0.066 / math.cos(lean) + (WINDOW.z[1] - WINDOW.z[0]) * math.tan(lean)
    assert width_between(Shape("cylinder", (0.066, 0.066, 0.2)), pose, WINDOW, AT) == pytest.approx(expected, abs=1e-12)


def test_nothing_is_between_the_pads_beside_a_body() -> None:
    for kind in ("box", "cylinder", "sphere"):
        assert width_between(Shape(kind, (0.04, 0.04, 0.04)), Pose((0.03, 0.0, 0.0)), WINDOW, AT) == 0.0


@pytest.mark.parametrize("lean", [1e-13, 5.5e-13, 1e-12, 1e-9])
def test_a_can_that_hardly_leans_is_as_wide_as_an_upright_one(lean: float) -> None:
    shape, at = Shape("cylinder", (0.066, 0.066, 0.1)), (0.0137, -0.006, -0.015)
    upright, leaning = (
        width_between(shape, Pose(at, turn), WINDOW, AT) for turn in ((1.0, 0.0, 0.0, 0.0), (1.0, 0.0, lean, 0.0))
    )
    assert leaning == pytest.approx(upright, abs=1e-9)
