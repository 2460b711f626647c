from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.scene.footprint import Footprint, apart
from prag_asp.scene.scene import Shape
from tests.chance import examples

SHAPES = (
    Shape("box", (0.2, 0.1, 0.05)),
    Shape("container", (0.3, 0.2, 0.05), 0.006),
    Shape("cylinder", (0.08, 0.08, 0.1)),
    Shape("sphere", (0.06, 0.06, 0.06)),
)
GRID = 40
PLACES = st.tuples(st.floats(-0.15, 0.15), st.floats(-0.15, 0.15), st.floats(-3.2, 3.2))


def covers(footprint: Footprint, x: float, y: float) -> bool:
    """Tell whether a body covers a point, from its definition."""
    at_x, at_y, yaw = footprint.place
    dx, dy = x - at_x, y - at_y
    half_x, half_y, _ = footprint.shape.half
    if footprint.shape.kind in ("sphere", "cylinder"):
        return math.hypot(dx, dy) < half_x
    along, across = math.cos(yaw) * dx + math.sin(yaw) * dy, math.cos(yaw) * dy - math.sin(yaw) * dx
    return abs(along) < half_x and abs(across) < half_y


@settings(max_examples=examples(60))
@given(st.sampled_from(SHAPES), PLACES, st.sampled_from(SHAPES), PLACES)
def test_bodies_that_share_a_point_are_not_apart_and_those_far_from_it_are(one, place, two, other_place):
    first, second = Footprint(one, place), Footprint(two, other_place)
    points = [(0.4 * (2 * i / GRID - 1), 0.4 * (2 * j / GRID - 1)) for i in range(GRID + 1) for j in range(GRID + 1)]
    if any(covers(first, *point) and covers(second, *point) for point in points):
        assert not apart(first, second, 0.0)
    grown = [
        f._replace(shape=f.shape._replace(size=tuple(side + 0.06 for side in f.shape.size))) for f in (first, second)
    ]
    if not any(covers(grown[0], *point) and covers(grown[1], *point) for point in points):
        assert apart(first, second, 0.0)


@pytest.mark.parametrize(("distance", "expected"), [(0.099, False), (0.101, True)])
def test_a_round_body_comes_nearer_to_the_corner_of_a_box_than_its_square_would(distance, expected):
    box = Footprint(Shape("box", (0.1, 0.1, 0.1)), (0.0, 0.0, 0.0))
    beyond = 0.05 + distance / math.sqrt(2)
    assert apart(box, Footprint(Shape("sphere", (0.2, 0.2, 0.2)), (beyond, beyond, 0.3)), 0.0) is expected
    assert apart(Footprint(Shape("sphere", (0.2, 0.2, 0.2)), (beyond, beyond, 0.3)), box, 0.0) is expected
