"""touching: the gap between bodies as it is, drawn beside and on top, in proofs, and in tasks of a small domain."""

from __future__ import annotations

import json
import math
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.atom import parse_atom
from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.domain.load import load_scene
from prag_asp.physics import PREDICATES, open_validator
from prag_asp.physics.predicates import Volume
from prag_asp.physics.predicates.touching import TOLERANCE, gap
from prag_asp.physics.proofs.prover import Prover
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact, facts
from prag_asp.scene.geometry import Pose, multiply, yaw_quaternion
from prag_asp.scene.scene import Scene, Shape
from tests.chance import Chance
from tests.independent.check import problems
from tests.independent.convex import Part, depth
from tests.independent.frames import frame
from tests.independent.world import world_of
from tests.physics.proofs.test_proofs import OBJECTS, any_situation
from tests.physics.proofs.test_proofs import scene as proof_scene

TOUCHING = PREDICATES["touching"]
SHAPES = {
    "panda": Shape("robot"),
    "table": Shape("table"),
    "cube": Shape("box", (0.05, 0.05, 0.05)),
    "brick": Shape("box", (0.12, 0.06, 0.04)),
    "can": Shape("cylinder", (0.06, 0.06, 0.1)),
    "pin": Shape("cylinder", (0.02, 0.02, 0.14)),
    "ball": Shape("sphere", (0.06, 0.06, 0.06)),
    "pea": Shape("sphere", (0.02, 0.02, 0.02)),
    "crate": Shape("container", (0.2, 0.16, 0.06), 0.006),
}
SCENE = Scene(shapes=SHAPES)
BODIES = ("cube", "brick", "can", "pin", "ball", "pea")
Place = tuple[float, float, float, float]


def at(**places: Place) -> Situation:
    """Return bodies at x, y and the height of their bottom in metres, turned by degrees."""
    poses = {
        name: Pose((x, y, z + SHAPES[name].half[2]), yaw_quaternion(math.radians(yaw)))
        for name, (x, y, z, yaw) in places.items()
    }
    return Situation(SCENE, poses, Pose((0.0, 0.0, 1.0)), 0.0)


CORNER = 0.025 * math.sqrt(2)
BRICK = (0.5, 0.0, 0.0, 0)


@pytest.mark.parametrize(
    ("name", "place", "other", "there", "expected"),
    [
        ("cube", (0.585, 0.0, 0.0, 0), "brick", BRICK, 0.0),  # half of the cube is 25 mm, of the brick 60 mm and 30 mm
        ("cube", (0.588, 0.0, 0.0, 0), "brick", BRICK, 0.003),
        ("cube", (0.5, 0.06, 0.0, 0), "brick", BRICK, 0.005),
        ("cube", (0.585 + 0.003, 0.055 + 0.004, 0.0, 0), "brick", BRICK, 0.005),
        ("cube", (0.56 + CORNER + 0.002, 0.01, 0.0, 45), "brick", BRICK, 0.002),
        ("cube", (0.5, 0.0, 0.04, 30), "brick", BRICK, 0.0),  # on top
        ("cube", (0.5, 0.0, 0.044, 30), "brick", BRICK, 0.004),
        ("cube", (0.585 + 0.003, 0.0, 0.04 + 0.004, 0), "brick", BRICK, 0.005),
        ("cube", (0.58, 0.0, 0.0, 0), "brick", BRICK, -0.005),
        ("cube", (0.5, 0.0, 0.037, 0), "brick", BRICK, -0.003),
        ("can", (0.5, 0.061, 0.0, 77), "brick", BRICK, 0.001),  # the can has a radius of 30 mm
        ("can", (0.56 + 0.03 * 0.8, 0.03 + 0.03 * 0.6, 0.0, 0), "brick", BRICK, 0.0),
        ("can", (0.56 + 0.04 * 0.8, 0.03 + 0.04 * 0.6, 0.0, 0), "brick", BRICK, 0.01),
        ("can", (0.5, 0.0, 0.0, 0), "pin", (0.5, 0.041, 0.0, 0), 0.001),
        ("ball", (0.5, 0.0, 0.0, 0), "can", (0.561, 0.0, 0.0, 0), 0.001),
        ("ball", (0.5, 0.0, 0.0, 0), "cube", (0.555, 0.0, 0.0, 0), 0.0),
        ("ball", (0.5, 0.0, 0.0, 0), "cube", (0.55, 0.0, 0.0, 0), -0.005),
        ("ball", (0.5, 0.0, 0.05, 0), "cube", (0.5, 0.01, 0.0, 0), 0.0),
        ("ball", (0.5, 0.0, 0.0, 0), "pea", (0.5 + 2 * math.sqrt(0.03 * 0.01), 0.0, 0.0, 0), 0.0),
        ("ball", (0.585 + 0.025, 0.0, 0.04 - 0.03 + 0.04, 0), "brick", (0.52, 0.0, 0.0, 0), 0.02),  # an edge: 3-4-5
        ("cube", (0.63, 0.0, 0.0, 0), "crate", (0.5, 0.0, 0.0, 0), 0.005),
        ("cube", (0.5, 0.0, 0.006, 0), "crate", (0.5, 0.0, 0.0, 0), -0.054),
        ("cube", (0.5, 0.3, 0.001, 20), "table", (0.0, 0.0, 0.0, 0), 0.001),
    ],
)
def test_the_gap_is_the_distance_of_the_bodies_in_space(
    name: str, place: Place, other: str, there: Place, expected: float
) -> None:
    situation = at(**{name: place}) if other == "table" else at(**{name: place, other: there})
    for pair in ((name, other), (other, name)):
        assert gap(situation, pair) == pytest.approx(expected, abs=1e-12)
        assert TOUCHING.distance(situation, pair) == pytest.approx(max(0.0, abs(expected) - 0.002), abs=1e-12)


def test_a_body_that_leans_counts_as_the_box_around_it() -> None:
    lying = multiply(yaw_quaternion(0.3), (math.sin(math.pi / 4), 0.0, 0.0, math.cos(math.pi / 4)))
    situation = at(cube=(0.5, 0.0, 0.0, 0), can=(0.5, 0.2, 0.0, 0)).with_pose("can", Pose((0.5, 0.2, 0.03), lying))
    half = situation.half("can")
    beside = situation.with_pose("cube", Pose((0.5, 0.2 - half[1] - 0.025, 0.025)))
    assert gap(beside, ("cube", "can")) == pytest.approx(0.0, abs=1e-12)


def nearest(name: str, pose: Pose, point: np.ndarray) -> np.ndarray:
    """Return the point of an upright body that is nearest to one."""
    yaw, half = 2 * math.atan2(*pose.quaternion[2:]), np.array(SHAPES[name].half)
    turn = np.array([[math.cos(yaw), -math.sin(yaw), 0.0], [math.sin(yaw), math.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    local = turn.T @ (point - pose.position)
    if SHAPES[name].kind == "sphere":
        local = local * min(1.0, half[0] / max(float(np.linalg.norm(local)), 1e-12))
    elif SHAPES[name].kind == "cylinder":
        local = local * ([min(1.0, half[0] / max(math.hypot(*local[:2]), 1e-12))] * 2 + [1.0])
    if SHAPES[name].kind != "sphere":
        local = np.clip(local, -half, half)
    return turn @ local + pose.position


@pytest.mark.parametrize("pair", [(one, two) for i, one in enumerate(BODIES) for two in BODIES[i + 1 :]])
def test_the_gap_is_what_going_to_and_fro_between_nearest_points_comes_to(
    pair: tuple[str, str], chance: Chance
) -> None:
    rng, close = chance.generator(11), 0
    for _ in range(16):
        x, y, z = (rng.uniform(-0.08, 0.08) for _ in range(3))
        poses = {
            pair[0]: Pose((0.5 + x, y, 0.3 + z), yaw_quaternion(rng.uniform(-3, 3))),
            pair[1]: Pose((0.5, 0.0, 0.3), yaw_quaternion(rng.uniform(-3, 3))),
        }
        found = gap(Situation(SCENE, poses, Pose((0.0, 0.0, 1.0)), 0.0), pair)
        point = np.array(poses[pair[0]].position)
        for _ in range(250):  # von Neumann's alternating projections onto two convex sets
            other = nearest(pair[1], poses[pair[1]], point)
            point = nearest(pair[0], poses[pair[0]], other)
        measured = float(np.linalg.norm(point - other))
        assert measured >= found - 1e-12
        assert max(0.0, found) == pytest.approx(measured, abs=1e-4)
        close += found < 0.01
    assert close > 0


def test_how_deep_bodies_are_in_each_other_is_the_shortest_way_apart(chance: Chance) -> None:
    rng = chance.generator(2)
    for pair in ((one, two) for one in BODIES for two in BODIES if one != two):
        for _ in range(10):
            x, y, z = (rng.uniform(-0.02, 0.02) for _ in range(3))
            poses = {
                pair[0]: Pose((x, y, z), yaw_quaternion(rng.uniform(-3, 3))),
                pair[1]: Pose((0.0, 0.0, 0.0), yaw_quaternion(rng.uniform(-3, 3))),
            }
            found = gap(Situation(SCENE, poses, Pose((0.0, 0.0, 1.0)), 0.0), pair)
            parts = (Part(SHAPES[name].kind, np.array(SHAPES[name].half), np.zeros(3)) for name in pair)
            (one, there), (two, here) = zip(parts, map(frame, poses.values()), strict=True)
            assert found == pytest.approx(-depth(one, there, two, here, -math.inf), abs=1e-4)


@pytest.mark.parametrize("subject", BODIES)
@pytest.mark.parametrize("other", BODIES)
def test_it_is_drawn_all_around_the_other_body_on_its_floor_and_on_top(
    subject: str, other: str, chance: Chance
) -> None:
    if subject == other:
        return
    rng = chance.generator(3)
    situation = at(**{other: (0.5, 0.0, 0.0, 33)})
    quaternion = yaw_quaternion(rng.uniform(-3, 3))
    for level, quarters in ((0.0, 4), (SHAPES[other].size[2], 1)):
        height = level + SHAPES[subject].half[2]
        room = Volume((0.2, -0.3, height), (0.8, 0.3, height))
        floor = room.meet(TOUCHING.volume(situation, (subject, other), quaternion)).floor()
        assert floor is not None
        drawn = Counter[int]()
        for _ in range(60):
            point = Volume.sample(floor, rng.uniform)
            assert point is not None
            placed = situation.with_pose(subject, Pose(point, quaternion))
            assert abs(gap(placed, (subject, other))) <= TOLERANCE - 1e-4
            drawn[int(math.atan2(point[1], point[0] - 0.5) // (math.pi / 2))] += 1
        assert len(drawn) >= quarters


def test_its_sentence_says_whether_bodies_touch() -> None:
    assert TOUCHING.sentence(("cube_1", "can_1")) == "cube 1 touches can 1"
    assert TOUCHING.sentence(("cube_1", "can_1"), value=False) == "cube 1 does not touch can 1"


def known(scene: Scene, *fluents: str) -> tuple[Fact, ...]:
    return facts(scene, dict.fromkeys(map(parse_atom, fluents), True))


FIXED = {"shelf_1": (1.0, 0.0, 0.0), "tray_1": (0.5, 0.3, 0.0)}


@pytest.mark.parametrize(
    ("fluents", "reason"),
    [
        (["touching(cube_1,can_1)", "far(can_1,cube_1)"], "can 1 and cube 1 cannot be touching and far at once"),
        (
            ["aligned(cube_1,can_1)", "touching(cube_1,can_1)"],
            "cube 1 and can 1 cannot be touching and aligned at once",
        ),
        (
            ["left_of(cube_1,can_1)", "touching(can_1,cube_1)"],
            "can 1 touches cube 1 and cube 1 is to the left of can 1, but these facts cannot hold together",
        ),
        (
            ["touching(cube_1,cube_1)"],
            "it is impossible that cube 1 touches cube 1, because nothing is in a relation to itself",
        ),
        (
            ["touching(shelf_1,tray_1)"],
            "it is impossible that shelf 1 touches tray 1, because none of these bodies can move",
        ),
        (
            ["reachable(panda,cube_1)", "touching(cube_1,shelf_1)"],
            "cube 1 is within reach and cube 1 touches shelf 1, but these facts cannot hold together",
        ),
        (
            ["touching(cube_1,shelf_1)", "touching(cube_1,tray_1)"],
            "cube 1 touches shelf 1 and cube 1 touches tray 1, but these facts cannot hold together",
        ),
        (
            ["on_top(cube_1,brick_1)", "on_top(brick_1,shelf_1)", "touching(cube_1,tray_1)"],
            "brick 1 is on shelf 1, cube 1 is on brick 1 and cube 1 touches tray 1, "
            "but these facts cannot hold together",
        ),
    ],
)
def test_what_cannot_be_with_it_is_proved(fluents: list[str], reason: str) -> None:
    made = proof_scene(fixed=FIXED)
    prover = Prover(made)
    assert prover.refutation(known(made, *fluents)) == reason
    assert len(prover.fewest(known(made, *fluents))) == len(fluents)


def test_no_proof_excludes_it_where_a_situation_satisfies_it(chance: Chance) -> None:
    made = proof_scene()
    prover, rng, held = Prover(made), chance.generator(5), 0
    others = ("left_of", "right_of", "in_front_of", "behind", "near", "far", "aligned", "on_top", "inside", "touching")
    pairs = [(one, two) for one in OBJECTS for two in OBJECTS if one != two]
    pairs_of = {name: [p for p in pairs if name != "inside" or made.shapes[p[1]].wall] for name in others}
    for _ in range(120):
        situation = any_situation(rng, made)
        # Some are pushed against others, along an axis until the boxes around them meet.
        for entity in rng.sample([e for e in OBJECTS if e not in made.fixed], 2):
            other = rng.choice([e for e in OBJECTS if e != entity])
            axis, sign = rng.choice([0, 1]), rng.choice([-1, 1])
            place = list(situation.pose(other).position)
            apart = situation.half(entity)[axis] + situation.half(other)[axis]
            place[axis] += sign * (apart + rng.uniform(-0.002, 0.002))
            situation = situation.with_pose(entity, Pose(tuple(place), situation.pose(entity).quaternion))
        true = [
            Fact(PREDICATES[name], pair, True)
            for name in others
            for pair in pairs_of[name]
            if PREDICATES[name].holds(situation, pair)
            and not (name == "on_top" and not made.shapes[pair[1]].traits.flat)
        ]
        held += sum(fact.predicate is TOUCHING for fact in true)
        assert prover.refutation(true) is None
    assert held > 140


DOMAIN = """
class(robot).   class(table).
class(thing).   class(cube, thing).   class(brick, thing).   class(can, thing).   class(ball, thing).

entity(panda, robot).   entity(table_1, table).
entity((cube_1; cube_2), cube).   entity(brick_1, brick).   entity(can_1, can).   entity(ball_1, ball).

fluent(holding(R,O))  :- is_a(R,robot), is_a(O,thing).
fluent(on_top(O,T))   :- is_a(O,thing), is_a(T,table).
fluent(touching(O,P)) :- is_a(O,thing), is_a(P,thing), O != P.

implies(touching(O,P), touching(P,O)) :- fluent(touching(O,P)).
exclusive(on_top(O,T), holding(R,O))  :- fluent(on_top(O,T)), fluent(holding(R,O)).
exclusive(holding(R,O), holding(R,P)) :- fluent(holding(R,O)), fluent(holding(R,P)), O < P.

initially(holding(R,O), false)  :- fluent(holding(R,O)).
initially(on_top(O,T), true)    :- fluent(on_top(O,T)).
initially(touching(O,P), false) :- fluent(touching(O,P)).

action(pick(R,O))                               :- fluent(holding(R,O)).
precondition(pick(R,O), holding(R,P), false)    :- action(pick(R,O)), fluent(holding(R,P)).
postcondition(pick(R,O), holding(R,O), true)    :- action(pick(R,O)).
postcondition(pick(R,O), on_top(O,T), false)    :- action(pick(R,O)), fluent(on_top(O,T)).
postcondition(pick(R,O), touching(O,P), false)  :- action(pick(R,O)), fluent(touching(O,P)).
postcondition(pick(R,O), touching(P,O), false)  :- action(pick(R,O)), fluent(touching(O,P)).

action(lean(R,O,P))                             :- is_a(R,robot), fluent(touching(O,P)).
precondition(lean(R,O,P), holding(R,O), true)   :- action(lean(R,O,P)).
postcondition(lean(R,O,P), holding(R,O), false) :- action(lean(R,O,P)).
postcondition(lean(R,O,P), on_top(O,T), true)   :- action(lean(R,O,P)), fluent(on_top(O,T)).
postcondition(lean(R,O,P), touching(O,P), true) :- action(lean(R,O,P)).
postcondition(lean(R,O,P), touching(P,O), true) :- action(lean(R,O,P)).
postcondition(lean(R,O,P), touching(O,Q), unknown) :- action(lean(R,O,P)), fluent(touching(O,Q)), Q != P.
postcondition(lean(R,O,P), touching(Q,O), unknown) :- action(lean(R,O,P)), fluent(touching(O,Q)), Q != P.
"""
SETTINGS = """
[scene.shapes]
robot = { kind = "robot" }
table = { kind = "table" }
cube = { kind = "box", size = [0.05, 0.05, 0.05] }
brick = { kind = "box", size = [0.11, 0.05, 0.04] }
can = { kind = "cylinder", radius = 0.033, height = 0.08 }
ball = { kind = "sphere", radius = 0.03 }
"""


@pytest.fixture(scope="module")
def side_by_side(tmp_path_factory: pytest.TempPathFactory) -> Domain:
    """A domain in which a panda puts things against each other on a table."""
    folder: Path = tmp_path_factory.mktemp("side_by_side")
    (folder / "domain.lp").write_text(DOMAIN)
    (folder / "domain.toml").write_text(SETTINGS)
    return load_domain(folder)


def test_tasks_that_put_things_against_each_other_are_found_and_their_witnesses_pass(side_by_side: Domain) -> None:
    scene = load_scene(side_by_side)
    world, tasks = world_of(scene), TaskSpace(side_by_side, 4).sample(14, seed=4)
    made = Counter[frozenset[str]]()
    with open_validator(scene) as validator:
        verdicts = [validator.validate(task, seed=4, index=i) for i, task in enumerate(tasks)]
    assert sum(verdict.feasible for verdict in verdicts) >= 13
    for task, verdict in zip(tasks, verdicts, strict=True):
        if verdict.witness is None:
            continue
        record = json.loads(write_line(Record(task, None, verdict.witness.to_json())))
        assert problems(record, record["witness"], world) == []
        for action, moment in zip(task.actions, verdict.witness.moments[1:], strict=True):
            if action.name == "lean":
                _, one, two = action.arguments
                heights = [moment.poses[entity].position[2] - scene.shapes[entity].half[2] for entity in (one, two)]
                assert heights == pytest.approx([0.0, 0.0], abs=1e-9)
                made[frozenset(entity.split("_")[0] for entity in (one, two))] += 1
    assert len(made) >= 5


def test_the_independent_check_finds_what_is_moved_off(side_by_side: Domain) -> None:
    scene = load_scene(side_by_side)
    world, (task, *_) = world_of(scene), TaskSpace(side_by_side, 2).sample(1, seed=2)
    with open_validator(scene) as validator:
        verdict = validator.validate(task, seed=2)
    assert verdict.witness is not None
    record = json.loads(write_line(Record(task, None, verdict.witness.to_json())))
    _, one, two = task.actions[1].arguments
    poses = record["witness"]["moments"][2]["poses"]
    key = "position" if isinstance(poses[one], dict) else 0
    place, other = (np.array(poses[entity][key]) for entity in (one, two))
    poses[one][key] = (place + 0.005 * (place - other) / np.linalg.norm(place - other)).tolist()
    assert f"touching({one},{two}) is not true" in "\n".join(problems(record, record["witness"], world))
