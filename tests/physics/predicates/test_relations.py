"""near, far, between, aligned and upright on situations with known answers."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from prag_asp.physics import PREDICATES
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Pose, yaw_quaternion
from prag_asp.scene.scene import Scene, Shape

SHAPES = {
    "cube": Shape("box", (0.05, 0.05, 0.05)),
    "brick": Shape("box", (0.12, 0.06, 0.04)),
    "slab": Shape("box", (0.12, 0.06, 0.04)),
    "can": Shape("cylinder", (0.06, 0.06, 0.1)),
    "ball": Shape("sphere", (0.06, 0.06, 0.06)),
}
Place = tuple[float, float, float]


def at(**places: Place) -> Situation:
    """Return bodies at x, y in metres, turned by degrees."""
    poses = {
        name: Pose((x, y, SHAPES[name].half[2]), yaw_quaternion(math.radians(yaw)))
        for name, (x, y, yaw) in places.items()
    }
    return Situation(Scene(shapes=SHAPES), poses)


def distance(name: str, situation: Situation, *arguments: str) -> float:
    return PREDICATES[name].distance(situation, arguments)


@pytest.mark.parametrize(
    ("dx", "dy", "gap"),
    [
        (0.0, 0.0, 0.0),
        (0.05, 0.04, 0.0),
        (0.185, 0.0, 0.1),  # half of the cube is 25 mm, of the brick 60 mm along x and 30 mm along y
        (0.0, 0.155, 0.1),
        (0.085 + 0.06, 0.055 + 0.08, 0.1),
        (0.0, -0.255, 0.2),
        (-0.085 - 0.3, 0.055 + 0.4, 0.5),
    ],
)
def test_near_and_far_go_by_the_gap_between_the_bounding_boxes(dx, dy, gap):
    situation = at(cube=(0.5 + dx, dy, 0), brick=(0.5, 0.0, 0))
    for pair in (("cube", "brick"), ("brick", "cube")):
        assert distance("near", situation, *pair) == pytest.approx(max(0.0, gap - 0.10), abs=1e-12)
        assert distance("far", situation, *pair) == pytest.approx(max(0.0, 0.25 - gap), abs=1e-12)


def test_what_is_above_is_near_and_not_far():
    situation = at(cube=(0.5, 0.0, 0), brick=(0.5, 0.0, 0)).with_pose("cube", Pose((0.5, 0.0, 0.4)))
    assert PREDICATES["near"].holds(situation, ("cube", "brick"))
    assert not PREDICATES["far"].holds(situation, ("cube", "brick"))


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ((0.5, 0.0, 0), 0.0),
        ((0.5, 0.024, 0), 0.0),  # the line passes through half of the cube, 25 mm
        ((0.5, -0.035, 0), 0.01),
        ((0.5, 0.035, 45), 0.0),  # and through its corner, 35.4 mm
        ((0.361, 0.0, 0), 0.0),  # the can is 30 mm, the cube 25 mm, the gap 5 mm
        ((0.35, 0.0, 0), 0.01),
        ((0.7, 0.0, 0), 0.11),  # the ball begins at 0.62, so the cube has to end at 0.615
        ((0.2, 0.0, 0), 0.16),
    ],
)
def test_between_goes_by_the_line_from_one_centre_to_the_other(place, expected):
    situation = at(can=(0.3, 0.0, 0), ball=(0.65, 0.0, 0), cube=place)
    assert distance("between", situation, "cube", "can", "ball") == pytest.approx(expected, abs=1e-12)
    assert distance("between", situation, "cube", "ball", "can") == pytest.approx(expected, abs=1e-12)


def test_nothing_is_between_two_that_stand_on_one_spot_or_side_by_side():
    for other in (0.3, 0.36):
        situation = at(can=(0.3, 0.0, 0), ball=(other, 0.0, 0), cube=(0.33, 0.0, 0))
        assert distance("between", situation, "cube", "can", "ball") > 0.0
        assert PREDICATES["between"].volume(situation, ("cube", "can", "ball"), (0.0, 0.0, 0.0, 1.0)).floor() is None


@pytest.mark.parametrize(
    ("name", "place", "expected"),
    [
        ("slab", (0.5, 0.2, 0), 0.0),  # a row along y
        ("slab", (0.7, 0.0, 0), 0.0),  # a row along x
        ("slab", (0.5, 0.2, 90), 0.0),
        ("slab", (0.5, 0.2, 184), 0.0),
        ("slab", (0.5, 0.2, -97), math.radians(2)),
        ("slab", (0.509, 0.2, 0), 0.0),
        ("slab", (0.53, 0.2, 0), 0.02),
        ("slab", (0.5, 0.05, 0), 0.015),  # 60 mm and the gap of 5 mm
        ("can", (0.5, -0.2, 33), 0.0),
        ("ball", (0.2, 0.0, 33), 0.0),
        ("can", (0.4, 0.1, 0), 0.09),
    ],
)
def test_aligned_means_parallel_and_in_a_row(name, place, expected):
    situation = at(brick=(0.5, 0.0, 0), **{name: place})
    for pair in ((name, "brick"), ("brick", name)):
        assert distance("aligned", situation, *pair) == pytest.approx(expected, abs=1e-12)


def test_upright_is_up_to_ten_degrees_from_how_a_body_was_made():
    def leaning(degrees: float) -> tuple[float, float, float, float]:
        return (0.0, math.sin(math.radians(degrees) / 2), 0.0, math.cos(math.radians(degrees) / 2))

    situation = at(can=(0.5, 0.0, 0), ball=(0.5, 0.3, 0))
    for degrees, expected in ((0, 0), (9, 0), (20, 10), (90, 80), (180, 170)):
        leant = situation.with_pose("can", Pose((0.5, 0.0, 0.1), leaning(degrees)))
        assert distance("upright", leant, "can") == pytest.approx(math.radians(expected), abs=1e-9)
    assert PREDICATES["upright"].holds(situation.with_pose("ball", Pose((0.5, 0.3, 0.03), leaning(90))), ("ball",))


def test_left_right_front_and_behind_are_all_that_depends_on_the_frame():
    situation = at(cube=(0.4, 0.1, 10), brick=(0.6, -0.1, 0), can=(0.5, 0.3, 0))
    other = replace(situation, scene=replace(situation.scene, frame="viewer"), measured={})
    differ = set()
    for name in ("left_of", "right_of", "in_front_of", "behind", "near", "far", "aligned", "on_top", "located"):
        if distance(name, situation, "cube", "brick") != distance(name, other, "cube", "brick"):
            differ.add(name)
    assert distance("between", situation, "cube", "brick", "can") == distance("between", other, "cube", "brick", "can")
    assert differ == {"left_of", "right_of", "in_front_of", "behind"}
