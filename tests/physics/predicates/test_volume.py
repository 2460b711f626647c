"""Regions: drawing from them is uniform, also where they overlap."""

from __future__ import annotations

import math
import random
from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.physics.predicates import Ring, Side, Volume, Yaws
from tests.chance import examples


def flat(x: tuple[float, float], y: tuple[float, float], *unions: tuple[Volume, ...]) -> Volume:
    return Volume((x[0], y[0], 0.0), (x[1], y[1], 0.0), unions=unions)


@settings(max_examples=examples(40))
@given(seed=st.integers(0, 10**6))
def test_points_are_drawn_uniformly_from_a_region(seed):
    rng = random.Random(seed)
    angle = rng.uniform(-math.pi, math.pi)
    half = Side(math.cos(angle), math.sin(angle), 0.0)
    volume = Volume((-1.0, -1.0, 0.0), (1.0, 1.0, 0.0), sides=(half,), rings=(Ring(0.0, 0.0, 0.3, 1.0),))
    floor = volume.floor()
    points = [volume.sample(floor, rng.uniform) for _ in range(400)]
    assert all(volume.miss_distance(point) <= 1e-9 for point in points)
    outer = sum(math.hypot(x, y) > 0.74 for x, y, _ in points)  # halves the area of the ring
    assert 120 < outer < 280
    left = sum(-half.b * x + half.a * y > 0.0 for x, y, _ in points)
    assert 120 < left < 280


def test_what_lies_in_two_volumes_of_a_union_is_not_drawn_twice_as_often(chance):
    rng = chance.generator(3)
    left, right, apart = flat((0.0, 2.0), (0.0, 1.0)), flat((1.0, 3.0), (0.0, 1.0)), flat((4.0, 5.0), (0.0, 1.0))
    volume = flat((0.0, 5.0), (0.0, 1.0), (left, right, apart))
    floor = volume.floor()
    draws = chance.examples(2500)
    cells = Counter(int(volume.sample(floor, rng.uniform)[0]) for _ in range(draws))
    assert set(cells) == {0, 1, 2, 4}
    assert all(0.22 < number / draws < 0.28 for number in cells.values())


def test_a_union_within_a_union_and_two_unions_meet_as_sets_do(chance):
    rng = chance.generator(4)
    tall = Volume(unions=((flat((0.0, 1.0), (0.0, 3.0)), flat((2.0, 3.0), (0.0, 3.0))),))
    wide = Volume(unions=((flat((0.0, 3.0), (0.0, 1.0)), flat((0.0, 3.0), (2.0, 3.0))),))
    volume = flat((0.0, 3.0), (0.0, 3.0)).meet(tall).meet(wide)
    assert len(volume.parts()) == 4
    floor = volume.floor()
    for _ in range(chance.examples(200)):
        x, y, z = volume.sample(floor, rng.uniform)
        assert volume.miss_distance((x, y, z)) == 0.0
        assert not 1.0 < x < 2.0 and not 1.0 < y < 2.0
    assert volume.miss_distance((1.25, 0.5, 0.0)) == pytest.approx(0.25)
    assert Volume(unions=((tall, wide),)).parts() == (*tall.parts(), *wide.parts())


def test_a_union_of_nothing_is_empty():
    for volume in (
        flat((0.0, 1.0), (0.0, 1.0), ()),
        flat((0.0, 1.0), (0.0, 1.0), (flat((2.0, 3.0), (0.0, 1.0)),)),
        flat((0.0, 1.0), (0.0, 1.0))._replace(yaws=()),
    ):
        assert volume.floor() is None


def test_a_ring_around_a_rectangle_has_round_corners(chance):
    rng = chance.generator(5)
    ring = Ring(0.0, 0.0, 0.0, 1.0, half_x=1.0, half_y=2.0)
    volume = Volume((-2.0, -3.0, 0.0), (2.0, 3.0, 0.0), rings=(ring,))
    floor = volume.floor()
    points = [volume.sample(floor, rng.uniform) for _ in range(chance.examples(2500))]
    beyond = [point for point in points if abs(point[0]) > 1.0 and abs(point[1]) > 2.0]
    assert all(math.hypot(abs(x) - 1.0, abs(y) - 2.0) <= 1.0 for x, y, _ in beyond)
    share = math.pi / (8.0 + 12.0 + math.pi)  # the corners make up a disc
    assert len(beyond) / len(points) == pytest.approx(share, abs=0.02)


def test_ranges_of_yaws_meet_across_the_turn():
    one = Volume(yaws=(Yaws(math.pi - 0.05, 0.1), Yaws(0.0, 0.2)))
    two = Volume(yaws=(Yaws(-math.pi + 0.05, 0.1),))
    (met,) = one.meet(two).yaws
    assert math.cos(met.centre) == pytest.approx(-1.0) and met.half == pytest.approx(0.05)
    assert one.meet(Volume()).yaws == one.yaws
    assert Volume(yaws=(Yaws(1.0, 0.1),)).meet(two).empty
