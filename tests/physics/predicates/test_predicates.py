from __future__ import annotations

import math
import random
from dataclasses import replace
from functools import cache
from importlib import import_module
from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.errors import SceneError
from prag_asp.physics import PREDICATES
from prag_asp.physics.predicates import predicate_of
from prag_asp.physics.predicates.grip_geometry import grip_width
from prag_asp.physics.predicates.volume import Volume
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.physics.witness import Arm
from prag_asp.scene.geometry import IDENTITY, Pose, compose, multiply, yaw_quaternion
from prag_asp.scene.predicate_names import PREDICATE_ROLES, VOCABULARY
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import BoxBounds, Own, Scene, Shape
from tests.chance import examples
from tests.physics.scenarios import STUDIO

SHAPES = {
    "panda": Shape("robot"),
    "table": Shape("table"),
    "cube": Shape("box", (0.05, 0.05, 0.05)),
    "brick": Shape("box", (0.12, 0.06, 0.04)),
    "can": Shape("cylinder", (0.066, 0.066, 0.1)),
    "apple": Shape("sphere", (0.07, 0.07, 0.07)),
    "crate": Shape("container", (0.3, 0.24, 0.06), 0.006),
    "drawer": Shape("drawer", (0.3, 0.26, 0.1), 0.008),
    "cupboard": Shape("cupboard", (0.24, 0.22, 0.12), 0.008),
}
LIMITS = {"drawer": 0.3 - 3 * 0.008 - 0.002, "cupboard": math.pi / 2}
EXAMPLES = {
    ("object",): ("can",),
    ("object", "object"): ("cube", "brick"),
    ("object", "object", "object"): ("cube", "brick", "can"),
    ("object", "rotation"): ("brick", "quarter"),
    ("robot",): ("panda",),
    ("robot", "object"): ("panda", "can"),
    ("furniture",): ("drawer",),
}
ARGUMENTS = {
    **{name: EXAMPLES[roles] for name, roles in PREDICATE_ROLES.items()},
    "inside": ("brick", "crate"),
    "left_of": ("can", "brick"),
    "right_of": ("cube", "crate"),
    "in_front_of": ("apple", "can"),
    "behind": ("brick", "cube"),
    "holding": ("panda", "cube"),
    "over": ("panda", "brick"),
    "located": ("can", "crate"),
    "far": ("can", "cube"),
    "aligned": ("brick", "crate"),
    "in_corner": ("cube", "crate"),
    "wholly_in_corner": ("can", "crate"),
    "on_the_left": ("brick", "table"),
    "looks_at": ("brick", "can"),
    "is_closed": ("cupboard",),
}
CORNERS = (
    BoxBounds((0.05, 0.03, 0.0), (0.15, 0.12, 0.2)),
    BoxBounds((0.0, 0.06, -0.1), (0.15, 0.12, 0.1)),  # overlaps the first
    BoxBounds((-0.15, -0.12, -math.inf), (-0.05, -0.03, math.inf)),
)
LEFT = (BoxBounds((-math.inf, -math.inf, 0.0), (math.inf, 0.0, math.inf)),)
PAIR = ("object", "object")
OWN = {
    "in_corner": Own("in_corner", PAIR, CORNERS, sentence="{0} {is} in a corner of {1}"),
    "wholly_in_corner": Own("wholly_in_corner", PAIR, CORNERS, whole=True, sentence="{0} {is} tucked into {1}"),
    "on_the_left": Own("on_the_left", PAIR[:1], LEFT, around="table", sentence="{0} {is} on the left"),
    "looks_at": Own("looks_at", PAIR, file=str(STUDIO / "predicates.py")),
}
NAMES = sorted([*PREDICATES, *OWN])
DOWN = (1.0, 0.0, 0.0, 0.0)
ROOM = Volume((-1.0, -1.5, -0.5), (2.0, 1.5, 1.0))


@cache  # nothing changes a scene, and a hundred thousand situations are made of it
def _scene(frame: str = "robot") -> Scene:
    rotations = {"quarter": math.pi / 2, "straight": 0.0}
    return Scene(shapes=SHAPES, frame=frame, rotations=rotations, own=OWN, trusted=True)


ALL = {name: predicate_of(_scene(), name) for name in NAMES}


def _situation(rng: random.Random, frame: str = "robot", spread: float = 0.5) -> Situation:
    def pose() -> Pose:
        at = (rng.uniform(0.3, 0.3 + spread), rng.uniform(-spread, spread), rng.uniform(0.0, spread / 2))
        return Pose(at, yaw_quaternion(rng.uniform(-math.pi, math.pi)))

    poses = {name: pose() for name, shape in SHAPES.items() if shape.kind not in ("robot", "table")}
    tool = pose()
    tool = Pose(tool.position, multiply(tool.quaternion, DOWN))
    openings = {name: rng.choice((0.0, 1.0, rng.random())) * limit for name, limit in LIMITS.items()}
    return _gripping(Situation(_scene(frame), poses, openings=openings), tool, rng.uniform(0.0, 0.08))


def _gripping(situation: Situation, tool: Pose, width: float) -> Situation:
    """Return a situation with the tool and the opening of the gripper."""
    return replace(situation, arms={"panda": Arm((0.0,) * 7, width)}, tools={"panda": tool})


def _drawn(name: str, arguments: tuple[str, ...], situation: Situation, rng: random.Random) -> Situation | None:
    """Put the subject (the object with a yaw, or the gripper) somewhere in the predicate's volume."""
    predicate = ALL[name]
    volume = predicate.volume(situation, arguments, IDENTITY)
    if _scene().roles(name) == ("furniture",):
        return None if volume.empty else situation.with_opening(arguments[0], rng.uniform(*volume.opening))
    yaw = rng.uniform(-math.pi, math.pi)
    if volume.yaws is not None:
        chosen = rng.choice(volume.yaws)
        yaw = chosen.centre + rng.uniform(-chosen.half, chosen.half)
    quaternion = yaw_quaternion(yaw)
    volume = predicate.volume(situation, arguments, quaternion).meet(ROOM)
    floor = volume.floor()
    at = None if floor is None else volume.sample(floor, rng.uniform)
    if at is None:
        return None
    assert volume.miss_distance(at) <= 1e-12
    if predicate.of_gripper:
        low, high = volume.width
        width = rng.uniform(low, high if math.isfinite(high) else 0.2)
        return _gripping(situation, Pose(at, situation.tool("panda").quaternion), width)
    return situation.with_pose(arguments[predicate.subject], Pose(at, quaternion))


def _pairs(name: str) -> list[tuple[str, ...]]:
    """Return the arguments of a predicate with every kind of subject and of the other bodies."""
    given = ARGUMENTS[name]
    roles = _scene().roles(name)
    if "furniture" in roles:
        return [("drawer",), ("cupboard",)]
    if "object" not in roles:
        return [given]
    bodies = ["cube", "brick", "can", "apple", "crate"]
    hollow = ["crate", "drawer", "cupboard"]
    places = {
        "inside": hollow,
        "located": [*hollow, "table"],
        "rotated": ["quarter", "straight"],
        "on_the_left": ["table"],
    }
    if roles[0] == "robot":
        return [("panda", body) for body in bodies]
    if len(given) == 1:
        return [(body,) for body in bodies]
    if len(given) == 3:
        return list(permutations(bodies, 3))
    others = places.get(name, [*bodies, "table"] if name == "on_top" else bodies)
    return [(one, two) for one in bodies for two in others if one != two]


@pytest.mark.parametrize(
    ("name", "frame"),
    [*((name, "robot") for name in NAMES), *((name, "viewer") for name in PREDICATES if PREDICATES[name].direction)],
)
@settings(max_examples=examples(20))
@given(seed=st.integers(0, 10**6))
def test_what_is_drawn_from_a_volume_always_passes_the_check(name, frame, seed):
    rng = random.Random(seed)
    situation = _situation(rng, frame)
    for arguments in _pairs(name):
        for _ in range(3):
            drawn = _drawn(name, arguments, situation, rng)
            if drawn is not None:
                assert ALL[name].holds(drawn, arguments)
                assert ALL[name].distance(drawn, arguments) == 0.0


@pytest.mark.parametrize("name", NAMES)
def test_volumes_are_seldom_empty(name, chance):
    rng = chance.generator(5)
    tries = chance.examples(100)
    drawn = [_drawn(name, ARGUMENTS[name], _situation(rng), rng) for _ in range(tries)]
    assert sum(made is not None for made in drawn) > 0.75 * tries


@settings(max_examples=examples(120))
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.02, 0.1, 0.5]))
def test_what_satisfies_a_predicate_lies_in_its_volume_up_to_the_margin(seed, spread):
    rng = random.Random(seed)
    situation = _situation(rng, spread=spread)
    for name, predicate in ALL.items():
        for arguments in _pairs(name):
            if name == "looks_at" or predicate.of_gripper or not predicate.holds(situation, arguments):
                continue
            if name == "touching" and "apple" in arguments:
                continue  # a ball is not drawn where it touches an edge
            pose = situation.pose(arguments[predicate.subject])
            volume = predicate.volume(situation, arguments, pose.quaternion)
            if not volume.empty:
                assert volume.miss_distance(pose.position) <= 0.011  # the height within which a body is inside


@settings(max_examples=examples(150))
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.02, 0.1, 0.5]))
def test_the_distance_is_never_negative_and_zero_exactly_where_the_check_holds(seed, spread):
    situation = _situation(random.Random(seed), spread=spread)
    for name, predicate in ALL.items():
        distance = predicate.distance(situation, ARGUMENTS[name])
        assert math.isfinite(distance) and distance >= 0.0
        assert predicate.holds(situation, ARGUMENTS[name]) == (distance == 0.0)
        signed = predicate.signed_distance(situation, ARGUMENTS[name])
        assert distance == max(0.0, signed)
        for value in (True, False):
            fact = Fact(predicate, ARGUMENTS[name], value)
            assert fact.is_satisfied(situation) == (fact.distance(situation) <= 0.0) == (fact.way(situation) <= 0.0)
            assert fact.way(situation) >= fact.distance(situation)


@settings(max_examples=examples(50))
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.1, 0.5]))
def test_a_small_move_changes_the_distance_by_no_more_than_that(seed, spread):
    rng = random.Random(seed)
    situation = _situation(rng, spread=spread)
    move = [rng.uniform(-0.01, 0.01) for _ in range(3)]
    for name, predicate in ALL.items():
        for arguments in _pairs(name):
            if name == "looks_at" or predicate.of_gripper:
                continue
            subject = arguments[predicate.subject]
            at, quaternion = situation.pose(subject)
            moved = situation.with_pose(subject, Pose(tuple(a + b for a, b in zip(at, move, strict=True)), quaternion))
            change = predicate.signed_distance(moved, arguments) - predicate.signed_distance(situation, arguments)
            assert abs(change) <= math.hypot(*move) + 1e-12


@settings(max_examples=examples(100))
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.02, 0.1, 0.5]))
def test_a_small_move_of_the_gripper_or_of_its_fingers_changes_the_distance_by_no_more_than_that(seed, spread):
    rng = random.Random(seed)
    situation = _situation(rng, spread=spread)
    move, width = [rng.uniform(-0.01, 0.01) for _ in range(3)], situation.arms["panda"].width
    at, quaternion = situation.tool("panda")
    there = Pose(tuple(a + b for a, b in zip(at, move, strict=True)), quaternion)
    for name in ("at", "holding", "over", "gripper_open"):
        before = ALL[name].signed_distance(situation, ARGUMENTS[name])
        moved = ALL[name].signed_distance(_gripping(situation, there, width), ARGUMENTS[name])
        # Between the pads, a turned cube near its corner narrows on both sides.
        slope = 3.0 if name == "holding" else 1.0
        assert abs(moved - before) <= slope * math.hypot(*move) + 1e-12
        opened = ALL[name].signed_distance(_gripping(situation, situation.tool("panda"), width + 0.01), ARGUMENTS[name])
        assert abs(opened - before) <= 0.01 + 1e-12


@settings(max_examples=examples(150))
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.02, 0.1, 0.5]))
def test_the_way_to_hold_something_does_not_leap(seed, spread):
    rng = random.Random(seed)
    situation = _situation(rng, spread=spread)
    move, width = [rng.uniform(-1e-4, 1e-4) for _ in range(3)], situation.arms["panda"].width
    at, quaternion = situation.tool("panda")
    there = Pose(tuple(a + b for a, b in zip(at, move, strict=True)), quaternion)

    def way(tool, opening):
        return ALL["holding"].signed_way(_gripping(situation, tool, opening), ARGUMENTS["holding"])

    before = way(situation.tool("panda"), width)
    assert abs(way(there, width) - before) <= 9 * math.hypot(*move) + 1e-12
    assert abs(way(situation.tool("panda"), width + 1e-4) - before) <= 1e-4 + 1e-12


def _way(tool, width):
    """How far it is to hold a cube of 5 cm in the middle of the table with the tool somewhere."""
    situation = Situation(_scene(), {"cube": Pose((0.5, 0.0, 0.025))})
    return ALL["holding"].signed_way(_gripping(situation, Pose(tool, DOWN), width), ("panda", "cube"))


def test_the_way_to_hold_something_is_open_above_it_down_and_then_closed():
    ways = [
        _way(tool, width)
        for tool, width in [
            ((0.6, 0.0, 0.025), 0.02), ((0.6, 0.0, 0.08), 0.02), ((0.6, 0.0, 0.08), 0.08), ((0.5, 0.0, 0.08), 0.08),
            ((0.5, 0.0, 0.06), 0.08), ((0.5, 0.0, 0.03), 0.08), ((0.5, 0.0, 0.03), 0.06), ((0.5, 0.0, 0.03), 0.05),
        ]
    ]  # fmt: skip
    assert ways == sorted(ways, reverse=True) and len(set(ways)) == len(ways)
    assert ways[-2] > 0.0 >= ways[-1]


def test_nothing_is_gained_by_closing_above_something_or_by_pushing_it():
    for height in (0.06, 0.07, 0.09, 0.2):
        assert _way((0.5, 0.0, height), 0.055) > _way((0.5, 0.0, height), 0.08)
    assert _way((0.56, 0.0, 0.03), 0.08) > _way((0.56, 0.0, 0.07), 0.08)


def test_what_just_holds_has_to_move_by_a_little_to_hold_no_longer():
    poses = {"cube": Pose((0.5, 0.0, 0.067)), "brick": Pose((0.5, 0.0, 0.02))}  # 2 mm above it: on the border
    situation = Situation(_scene(), poses)
    on_top = PREDICATES["on_top"].signed_distance(situation, ("cube", "brick"))
    assert on_top == pytest.approx(0.0, abs=1e-15)
    for at, expected in ((0.067, 0.0), (0.065, 0.002), (0.1, -0.033)):
        lifted = situation.with_pose("cube", Pose((0.5, 0.0, at)))
        fact = Fact(PREDICATES["on_top"], ("cube", "brick"), False)
        assert fact.distance(lifted) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("name", ["on_top", "inside", "located", "reachable", "near", "between", "wholly_in_corner"])
@settings(max_examples=examples(50))
@given(seed=st.integers(0, 10**6))
def test_the_distance_grows_as_a_body_moves_away(name, seed):
    rng = random.Random(seed)
    arguments = ARGUMENTS[name]
    drawn = _drawn(name, arguments, _situation(rng), rng)
    if drawn is None:
        return
    angle = rng.uniform(-math.pi, math.pi)
    subject = arguments[ALL[name].subject]
    (x, y, z), quaternion = drawn.pose(subject)
    distances = []
    for step in range(20):
        at = (x + step * 0.1 * math.cos(angle), y + step * 0.1 * math.sin(angle), z)
        distances.append(ALL[name].distance(drawn.with_pose(subject, Pose(at, quaternion)), arguments))
    assert distances[0] == 0.0 and distances[-1] > 0.2
    convex = name not in ("reachable", "wholly_in_corner")
    assert not convex or all(later >= earlier - 1e-12 for earlier, later in pairwise(distances))


@pytest.mark.parametrize("name", [name for name, predicate in PREDICATES.items() if predicate.inverse is not None])
@settings(max_examples=examples(50))
@given(seed=st.integers(0, 10**6))
def test_a_relation_holds_exactly_where_its_inverse_holds_of_the_swapped_bodies(name, seed):
    situation = _situation(random.Random(seed))
    inverse = PREDICATES[str(PREDICATES[name].inverse)]
    forward = PREDICATES[name].distance(situation, ("cube", "brick"))
    assert forward == pytest.approx(inverse.distance(situation, ("brick", "cube")))


@pytest.mark.parametrize(
    ("name", "inverse", "place"),
    [("left_of", "right_of", (0.5, 0.2, 0.025)), ("in_front_of", "behind", (0.3, 0.0, 0.025))],
)
def test_sides_are_those_of_the_robot_or_of_a_viewer_who_faces_it(name, inverse, place):
    poses = {"cube": Pose(place), "brick": Pose((0.5, 0.0, 0.02))}
    for frame, expected in (("robot", True), ("viewer", False)):
        situation = Situation(_scene(frame), poses)
        assert PREDICATES[name].holds(situation, ("cube", "brick")) == expected
        assert PREDICATES[inverse].holds(situation, ("cube", "brick")) != expected


@pytest.mark.parametrize(
    ("height", "expected"), [(0.065, 0.0), (0.068, 0.001), (0.165, 0.098)]
)  # the brick is 40 mm high, the half cube 25 mm, the tolerance 2 mm
def test_the_distance_to_on_top_is_the_gap(height, expected):
    poses = {"cube": Pose((0.5, 0.0, height)), "brick": Pose((0.5, 0.0, 0.02))}
    situation = Situation(_scene(), poses)
    assert PREDICATES["on_top"].distance(situation, ("cube", "brick")) == pytest.approx(expected, abs=1e-12)


def test_a_body_stacked_in_a_container_is_located_there_but_not_inside():
    poses = {"cube": Pose((0.5, 0.0, 0.071)), "crate": Pose((0.5, 0.0, 0.03))}
    situation = Situation(_scene(), poses)
    assert not PREDICATES["inside"].holds(situation, ("cube", "crate"))
    assert PREDICATES["located"].holds(situation, ("cube", "crate"))


def test_a_box_is_held_along_its_narrow_side_only():
    tool = Pose((0.5, 0.0, 0.02), DOWN)
    situation = _gripping(Situation(_scene(), {"brick": Pose((0.5, 0.0, 0.02))}), tool, 0.06)
    assert grip_width(situation, "brick", "panda") == pytest.approx(0.06)
    assert PREDICATES["holding"].holds(situation, ("panda", "brick"))
    turned = situation.with_pose("brick", Pose((0.5, 0.0, 0.02), yaw_quaternion(math.pi / 2)))
    assert PREDICATES["holding"].distance(turned, ("panda", "brick")) == pytest.approx(0.058)
    narrowest, widest = PREDICATES["holding"].volume(situation, ("panda", "brick"), IDENTITY).width
    assert narrowest < situation.arm("panda").width < widest


def test_every_predicate_has_a_sentence_in_plain_words():
    said = {name: ALL[name].sentence(ARGUMENTS[name]) for name in NAMES}
    assert set(PREDICATE_ROLES) < set(said)
    assert said["left_of"] == "can is to the left of brick"
    assert said["holding"] == "cube is held by the gripper"
    assert said["between"] == "cube is between brick and can"
    assert said["far"] == "can is far from cube"
    assert said["on_the_left"] == "brick is on the left"
    assert said["looks_at"] == "brick is looking at can"
    assert PREDICATES["inside"].sentence(("cube_1", "crate_1"), value=False) == "cube 1 is not inside crate 1"
    for name, sentence in said.items():
        denied = ALL[name].sentence(ARGUMENTS[name], value=False)
        assert denied == sentence.replace(" is ", " is not ") or " is " not in sentence
        assert " not " in denied and " not " not in sentence
    assert len(set(said.values())) == len(said)


def test_an_unknown_body_is_an_error_not_a_silent_no():
    situation = Situation(_scene(), {})
    with pytest.raises(SceneError, match="cube is not in this situation"):
        PREDICATES["on_top"].holds(situation, ("cube", "brick"))
    with pytest.raises(SceneError, match="ghost has no shape"):
        PREDICATES["inside"].holds(situation, ("ghost", "crate"))
    with pytest.raises(SceneError, match="tilted has no yaw"):
        PREDICATES["rotated"].holds(situation.with_pose("cube", Pose((0.5, 0.0, 0.025))), ("cube", "tilted"))


@settings(max_examples=examples(40))
@given(yaw=st.floats(-0.3, 0.3), off=st.floats(-0.08, 0.08))
def test_the_width_of_a_grip_on_a_long_box_is_what_is_between_the_pads(yaw, off):
    scene = replace(_scene(), shapes={**_scene().shapes, "brick": Shape("box", (0.24, 0.035, 0.035))})
    pose = Pose((0.5, 0.0, 0.02), yaw_quaternion(yaw))
    tool = compose(pose, Pose((off, 0.0, 0.0)))._replace(quaternion=DOWN)
    situation = _gripping(Situation(scene, {"brick": pose}), tool, 0.04)
    pad = robot_of(scene, "panda").finger_boxes[0].size[0]
    corners = [
        compose(pose, Pose((x * 0.12, y * 0.0175, 0.0))).position for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    edge = [np.linspace(a, b, 20_000) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    points = np.concatenate(edge)[:, :2] - np.array(tool.position[:2])
    between = points[np.abs(points[:, 0]) <= pad / 2]
    assert grip_width(situation, "brick", "panda") == pytest.approx(np.ptp(between[:, 1]), abs=2e-5)


@pytest.mark.parametrize(
    ("size", "lean", "height", "held"),
    [
        (0.1, 3.5, 0.0, False),  # as a whole 72 mm wide
        (0.1, 0.0, 0.0, True),
        (0.1, 3.5, 0.046, False),  # at its rim
    ],
)
def test_a_gripper_that_is_wider_than_the_part_between_its_pads_holds_nothing(size, lean, height, held):
    turned = math.radians(lean) / 2
    pose = Pose((0.5, 0.0, 0.06), (math.sin(turned), 0.0, 0.0, math.cos(turned)))
    situation = Situation(_scene(), {"can": pose})
    wide = 2 * situation.shape("can").half[0] * math.cos(2 * turned) + size * math.sin(2 * turned)
    tool = Pose((0.5, 0.0, 0.06 + height), DOWN)
    assert PREDICATES["holding"].holds(_gripping(situation, tool, wide), ("panda", "can")) is held
    between = grip_width(_gripping(situation, tool, wide), "can", "panda")
    assert PREDICATES["holding"].holds(_gripping(situation, tool, between), ("panda", "can"))


def test_pads_above_the_middle_of_a_ball_do_not_hold_it():
    situation = Situation(_scene(), {"apple": Pose((0.5, 0.0, 0.05))})
    for height, held in ((0.0, True), (situation.half("apple")[2] - 0.001, False)):
        tool = Pose((0.5, 0.0, 0.05 + height), DOWN)
        width = grip_width(_gripping(situation, tool, 0.0), "apple", "panda")
        assert width > 0.0
        assert PREDICATES["holding"].holds(_gripping(situation, tool, width), ("panda", "apple")) is held


def test_each_file_defines_just_what_the_vocabulary_says_of_it():
    registered = {
        file: {name for name, word in VOCABULARY.items() if word.file == file} for _, file in VOCABULARY.values()
    }
    for file, names in registered.items():
        defined = import_module(f"prag_asp.physics.predicates.{file}").PREDICATES
        assert set(defined) == names
        assert all(predicate.name == name and PREDICATES[name] is predicate for name, predicate in defined.items())
    assert list(PREDICATES) == list(VOCABULARY)


@pytest.mark.parametrize("name", sorted(PREDICATES))
def test_what_a_predicate_says_of_itself_fits_its_arguments(name):
    predicate, roles = PREDICATES[name], PREDICATE_ROLES[name]
    assert predicate.of_joint == (roles == ("furniture",)) == (predicate.otherwise is not None)
    assert (predicate.gripper is not None) == (roles[0] == "robot")
    assert predicate.subject < len(roles) and (
        predicate.inverse is None or PREDICATES[predicate.inverse].inverse == name
    )
    assert not predicate.supports or predicate.places
    if predicate.direction is not None:
        assert PREDICATES[str(predicate.inverse)].direction == predicate.direction.opposite


@settings(max_examples=examples(80))
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.1, 0.5, 1.5]))
def test_bodies_are_as_far_apart_as_their_relation_says(seed, spread):
    situation = _situation(random.Random(seed), spread=spread)
    for name, predicate in ALL.items():
        for arguments in _pairs(name):
            if predicate.apart != (0.0, math.inf) and predicate.holds(situation, arguments):
                one, two = map(situation.body, arguments)
                gaps = [max(0.0, a - d, c - b) for a, b, c, d in zip(one.low, one.high, two.low, two.high, strict=True)]
                assert predicate.apart[0] - 1e-12 <= math.hypot(*gaps[:2]) <= predicate.apart[1] + 1e-12


@pytest.mark.parametrize("name", ["is_open", "is_closed"])
@pytest.mark.parametrize("furniture", ["drawer", "cupboard"])
def test_what_is_drawn_from_the_other_volume_does_not_satisfy_a_predicate(name, furniture, chance):
    rng = chance.generator(2)
    situation, otherwise = _situation(rng), PREDICATES[name].otherwise
    assert otherwise is not None
    low, high = otherwise(situation, (furniture,), IDENTITY).opening
    for opening in (low, high, rng.uniform(low, high)):
        assert not PREDICATES[name].holds(situation.with_opening(furniture, opening), (furniture,))
