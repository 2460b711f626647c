from __future__ import annotations

import math
import random
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.domain.scene import PREDICATE_ROLES, Scene, Shape
from prag_asp.errors import SceneError
from prag_asp.physics import PREDICATES
from prag_asp.physics.geometry import IDENTITY, Pose, extents, multiply, yaw_quaternion
from prag_asp.physics.predicates.gripper import grip_width
from prag_asp.physics.predicates.volume import Ring, Side, Volume
from prag_asp.physics.situation import Situation

SHAPES = {
    "panda": Shape("robot"),
    "table": Shape("table"),
    "cube": Shape("box", (0.05, 0.05, 0.05)),
    "brick": Shape("box", (0.12, 0.06, 0.04)),
    "can": Shape("cylinder", (0.066, 0.066, 0.1)),
    "apple": Shape("sphere", (0.07, 0.07, 0.07)),
    "crate": Shape("container", (0.3, 0.24, 0.06), 0.006),
}
ARGUMENTS = {
    "on_top": ("cube", "brick"),
    "inside": ("brick", "crate"),
    "left_of": ("can", "brick"),
    "right_of": ("cube", "crate"),
    "in_front_of": ("apple", "can"),
    "behind": ("brick", "cube"),
    "reachable": ("panda", "can"),
    "holding": ("panda", "cube"),
    "at": ("panda", "can"),
    "gripper_open": ("panda",),
    "over": ("panda", "brick"),
    "located": ("can", "crate"),
    "rotated": ("brick", "quarter"),
}
DOWN = (1.0, 0.0, 0.0, 0.0)
ROOM = Volume((-1.0, -1.5, -0.5), (2.0, 1.5, 1.0))


def _scene(frame: str = "robot") -> Scene:
    return Scene(shapes=SHAPES, frame=frame, rotations={"quarter": math.pi / 2, "straight": 0.0})


def _situation(rng: random.Random, frame: str = "robot", spread: float = 0.5) -> Situation:
    def pose() -> Pose:
        at = (rng.uniform(0.3, 0.3 + spread), rng.uniform(-spread, spread), rng.uniform(0.0, spread / 2))
        return Pose(at, yaw_quaternion(rng.uniform(-math.pi, math.pi)))

    poses = {name: pose() for name, shape in SHAPES.items() if shape.kind not in ("robot", "table")}
    tool = pose()
    tool = Pose(tool.position, multiply(tool.quaternion, DOWN))
    return Situation(_scene(frame), poses, tool, rng.uniform(0.0, 0.08))


def _drawn(name: str, arguments: tuple[str, ...], situation: Situation, rng: random.Random) -> Situation | None:
    """Put the subject (the object with a yaw, or the gripper) somewhere in the predicate's volume."""
    predicate = PREDICATES[name]
    volume = predicate.volume(situation, arguments, IDENTITY)
    yaw = rng.uniform(-math.pi, math.pi)
    if volume.yaw is not None:
        yaw = volume.yaw[0] + rng.uniform(-volume.yaw[1], volume.yaw[1])
    quaternion = yaw_quaternion(yaw)
    volume = predicate.volume(situation, arguments, quaternion).meet(ROOM)
    floor = volume.floor()
    at = None if floor is None else volume.draw(floor, rng.uniform)
    if at is None:
        return None
    assert volume.outside(at) <= 1e-12
    if predicate.of_gripper:
        low, high = volume.width
        width = rng.uniform(low, high if math.isfinite(high) else 0.2)
        return replace(situation, tool=Pose(at, situation.tool.quaternion), width=width)
    return situation.with_pose(arguments[predicate.subject], Pose(at, quaternion))


def _pairs(name: str) -> list[tuple[str, ...]]:
    """Return the arguments of a predicate with every kind of subject and of the other body."""
    given = ARGUMENTS[name]
    if "object" not in PREDICATE_ROLES[name]:
        return [given]
    bodies = ["cube", "brick", "can", "apple", "crate"]
    places = {"inside": ["crate"], "located": ["crate"], "rotated": ["quarter", "straight"]}
    if PREDICATE_ROLES[name][0] == "robot":
        return [("panda", body) for body in bodies]
    others = places.get(name, [*bodies, "table"] if name == "on_top" else bodies)
    return [(one, two) for one in bodies for two in others if one != two]


@pytest.mark.parametrize("frame", ["robot", "viewer"])
@pytest.mark.parametrize("name", sorted(PREDICATES))
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_what_is_drawn_from_a_volume_always_passes_the_check(name, frame, seed):
    rng = random.Random(seed)
    situation = _situation(rng, frame)
    for arguments in _pairs(name):
        for _ in range(5):
            drawn = _drawn(name, arguments, situation, rng)
            if drawn is not None:
                assert PREDICATES[name].holds(drawn, arguments)
                assert PREDICATES[name].distance(drawn, arguments) == 0.0


@pytest.mark.parametrize("name", sorted(PREDICATES))
def test_volumes_are_seldom_empty(name):
    rng = random.Random(5)
    drawn = [_drawn(name, ARGUMENTS[name], _situation(rng), rng) for _ in range(200)]
    assert sum(made is not None for made in drawn) > 150


@settings(max_examples=300, deadline=None)
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.02, 0.1, 0.5]))
def test_what_satisfies_a_predicate_lies_in_its_volume_up_to_the_margin(seed, spread):
    rng = random.Random(seed)
    situation = _situation(rng, spread=spread)
    for name, predicate in PREDICATES.items():
        for arguments in _pairs(name):
            if predicate.of_gripper or not predicate.holds(situation, arguments):
                continue
            pose = situation.pose(arguments[predicate.subject])
            volume = predicate.volume(situation, arguments, pose.quaternion)
            if not volume.empty:
                assert volume.outside(pose.position) <= 0.011  # the height within which a body is inside


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_points_are_drawn_uniformly_from_a_region(seed):
    rng = random.Random(seed)
    angle = rng.uniform(-math.pi, math.pi)
    half = Side(math.cos(angle), math.sin(angle), 0.0)
    volume = Volume((-1.0, -1.0, 0.0), (1.0, 1.0, 0.0), sides=(half,), rings=(Ring(0.0, 0.0, 0.3, 1.0),))
    floor = volume.floor()
    points = [volume.draw(floor, rng.uniform) for _ in range(400)]
    assert all(volume.outside(point) <= 1e-9 for point in points)
    outer = sum(math.hypot(x, y) > 0.74 for x, y, _ in points)  # halves the area of the ring
    assert 120 < outer < 280
    left = sum(-half.b * x + half.a * y > 0.0 for x, y, _ in points)
    assert 120 < left < 280


@settings(max_examples=300, deadline=None)
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.02, 0.1, 0.5]))
def test_the_distance_is_never_negative_and_zero_exactly_where_the_check_holds(seed, spread):
    situation = _situation(random.Random(seed), spread=spread)
    for name, predicate in PREDICATES.items():
        distance = predicate.distance(situation, ARGUMENTS[name])
        assert math.isfinite(distance) and distance >= 0.0
        assert predicate.holds(situation, ARGUMENTS[name]) == (distance == 0.0)


@pytest.mark.parametrize("name", ["left_of", "right_of", "in_front_of", "behind"])
@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_a_relation_holds_exactly_where_its_inverse_holds_of_the_swapped_bodies(name, seed):
    situation = _situation(random.Random(seed))
    inverse = PREDICATES[str(PREDICATES[name].inverse)]
    forward = PREDICATES[name].distance(situation, ("cube", "brick"))
    assert forward == pytest.approx(inverse.distance(situation, ("brick", "cube")))


def test_left_is_plus_y_for_the_robot_and_minus_y_for_who_faces_it():
    poses = {"cube": Pose((0.5, 0.2, 0.025)), "brick": Pose((0.5, 0.0, 0.02))}
    for frame, left in (("robot", True), ("viewer", False)):
        situation = Situation(_scene(frame), poses, Pose((0.0, 0.0, 1.0)), 0.0)
        assert PREDICATES["left_of"].holds(situation, ("cube", "brick")) == left
        assert PREDICATES["right_of"].holds(situation, ("cube", "brick")) != left


def test_in_front_is_nearer_to_who_looks():
    poses = {"cube": Pose((0.3, 0.0, 0.025)), "brick": Pose((0.5, 0.0, 0.02))}
    for frame, front in (("robot", True), ("viewer", False)):
        situation = Situation(_scene(frame), poses, Pose((0.0, 0.0, 1.0)), 0.0)
        assert PREDICATES["in_front_of"].holds(situation, ("cube", "brick")) == front
        assert PREDICATES["behind"].holds(situation, ("cube", "brick")) != front


@pytest.mark.parametrize(
    ("height", "expected"), [(0.065, 0.0), (0.068, 0.001), (0.165, 0.098)]
)  # the brick is 40 mm high, the half cube 25 mm, the tolerance 2 mm
def test_the_distance_to_on_top_is_the_gap(height, expected):
    poses = {"cube": Pose((0.5, 0.0, height)), "brick": Pose((0.5, 0.0, 0.02))}
    situation = Situation(_scene(), poses, Pose((0.0, 0.0, 1.0)), 0.0)
    assert PREDICATES["on_top"].distance(situation, ("cube", "brick")) == pytest.approx(expected, abs=1e-12)


def test_a_body_stacked_in_a_container_is_located_there_but_not_inside():
    poses = {"cube": Pose((0.5, 0.0, 0.071)), "crate": Pose((0.5, 0.0, 0.03))}
    situation = Situation(_scene(), poses, Pose((0.0, 0.0, 1.0)), 0.0)
    assert not PREDICATES["inside"].holds(situation, ("cube", "crate"))
    assert PREDICATES["located"].holds(situation, ("cube", "crate"))


def test_a_box_is_held_along_its_narrow_side_only():
    tool = Pose((0.5, 0.0, 0.02), DOWN)
    situation = Situation(_scene(), {"brick": Pose((0.5, 0.0, 0.02))}, tool, 0.06)
    assert grip_width(situation, "brick") == pytest.approx(0.06)
    assert PREDICATES["holding"].holds(situation, ("panda", "brick"))
    turned = situation.with_pose("brick", Pose((0.5, 0.0, 0.02), yaw_quaternion(math.pi / 2)))
    assert PREDICATES["holding"].distance(turned, ("panda", "brick")) == pytest.approx(0.058)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_bounding_box_of_a_turned_body_is_that_of_points_on_it(seed):
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=4)
    quaternion = tuple((quaternion / np.linalg.norm(quaternion)).tolist())
    x, y, z, w = quaternion
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * (0.06, 0.03, 0.02)
    assert extents(SHAPES["brick"], quaternion) == pytest.approx((corners @ turn.T).max(axis=0))
    angles = np.linspace(0, 2 * np.pi, 2000)
    rim = np.stack([0.033 * np.cos(angles), 0.033 * np.sin(angles), np.full(2000, 0.05)], axis=1)
    rims = np.concatenate([rim, rim * (1, 1, -1)])
    assert extents(SHAPES["can"], quaternion) == pytest.approx((rims @ turn.T).max(axis=0), abs=1e-5)


def test_every_predicate_speaks_in_plain_words():
    said = {name: PREDICATES[name].sentence(ARGUMENTS[name]) for name in PREDICATE_ROLES}
    assert said["left_of"] == "can is to the left of brick"
    assert said["holding"] == "cube is held by the gripper"
    assert PREDICATES["inside"].sentence(("cube_1", "crate_1"), value=False) == "cube 1 is not inside crate 1"
    assert len(set(said.values())) == len(said)


def test_an_unknown_body_is_an_error_not_a_silent_no():
    situation = Situation(_scene(), {}, Pose((0.0, 0.0, 1.0)), 0.0)
    with pytest.raises(SceneError, match="cube is not in this situation"):
        PREDICATES["on_top"].holds(situation, ("cube", "brick"))
    with pytest.raises(SceneError, match="ghost has no shape"):
        PREDICATES["inside"].holds(situation, ("ghost", "crate"))
    with pytest.raises(SceneError, match="tilted has no yaw"):
        PREDICATES["rotated"].holds(situation.with_pose("cube", Pose((0.5, 0.0, 0.025))), ("cube", "tilted"))
