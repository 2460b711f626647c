"""What is proved impossible is so: no situation, however odd, satisfies facts that a proof excludes."""

from __future__ import annotations

import itertools
import math
import random
from dataclasses import replace

import pytest

from prag_asp.physics import PREDICATES
from prag_asp.physics.predicates.gaps import ORIGIN, Gap
from prag_asp.physics.predicates.grip_geometry import grip_width
from prag_asp.physics.proofs.prover import Impossibility, Prover
from prag_asp.physics.proofs.reasons import impossible_row, lowest, own_reasons
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact, physical_task
from prag_asp.physics.witness import Arm
from prag_asp.scene.geometry import Pose, multiply, yaw_quaternion
from prag_asp.scene.scene import Material, Mount, Scene, Shape
from tests.chance import Chance
from tests.physics.scenarios import state, task

SHAPES = {
    "panda": Shape("robot"),
    "table_1": Shape("table"),
    "cube_1": Shape("box", (0.05, 0.05, 0.05)),
    "brick_1": Shape("box", (0.12, 0.06, 0.04)),
    "can_1": Shape("cylinder", (0.066, 0.066, 0.1)),
    "ball_1": Shape("sphere", (0.06, 0.06, 0.06)),
    "crate_1": Shape("container", (0.3, 0.26, 0.06), 0.008),
    "tray_1": Shape("container", (0.2, 0.18, 0.05), 0.006),
    "shelf_1": Shape("box", (0.3, 0.2, 0.3)),
    "zone_1": Shape("zone", (0.6, 0.5, 0.0)),
    "zone_2": Shape("zone", (0.5, 0.7, 0.0)),
}
ZONES = {"zone_1": (0.3, -0.1, 0.5), "zone_2": (0.6, 0.2, 1.2)}
FIXED = {"tray_1": (0.5, 0.3, 0.6), "shelf_1": (0.7, -0.4, 2.0)}
ARMS = {"left": Mount("panda", 0.0, 0.4), "right": Mount("panda", 0.0, -0.4)}
OBJECTS = tuple(entity for entity, shape in SHAPES.items() if shape.traits.body)


def scene(frame: str = "robot", **changes: object) -> Scene:
    made = Scene(
        SHAPES, frame=frame, fixed={**FIXED, **ZONES}, rotations={"straight": 0.0, "turned": math.pi / 2, "askew": 0.3}
    )
    return replace(made, **changes)


def proof_of(made: Scene, *fluents: str, noise: tuple[str, ...] = ()) -> Impossibility | None:
    """Return a proof that fluents cannot hold together: after an action if there is noise before, else initially."""
    asked = task(state(*noise), ("x(panda)", state(*fluents))) if noise else task(state(*fluents))
    return Prover(made).impossibility(physical_task(asked, made))


def everything(made: Scene) -> list[tuple[str, tuple[str, ...]]]:
    """Return every spatial predicate with all arguments that it may have here."""
    pairs = list(itertools.permutations(OBJECTS, 2))
    supports = [*pairs, *((entity, surface) for surface in ("table_1", *ZONES) for entity in OBJECTS)]
    found = [("on_top", pair) for pair in supports]
    found += [(name, pair) for name in ("inside", "located") for pair in pairs if made.shapes[pair[1]].wall]
    found += [(name, pair) for name in ("left_of", "right_of", "in_front_of", "behind") for pair in pairs]
    found += [(name, ("panda", entity)) for name in ("at", "holding", "reachable") for entity in OBJECTS]
    found += [("rotated", (entity, rotation)) for entity in OBJECTS for rotation in made.rotations]
    return [*found, ("gripper_open", ("panda",))]


def any_turn(rng: random.Random) -> tuple[float, float, float, float]:
    """Return a yaw, or now and then any rotation at all."""
    yaw = yaw_quaternion(rng.choice([0.0, 0.3, math.pi / 2, rng.uniform(-math.pi, math.pi)]))
    if rng.random() < 0.8:
        return yaw
    half = rng.uniform(0.0, math.pi / 2)
    return multiply(yaw, (math.sin(half), 0.0, 0.0, math.cos(half)))


def gripping(situation: Situation, tool: Pose, width: float) -> Situation:
    """Return a situation with the tool and the opening of the gripper."""
    return replace(situation, arms={"panda": Arm((0.0,) * 7, width)}, tools={"panda": tool})


def any_situation(rng: random.Random, made: Scene) -> Situation:
    """Return bodies stacked, in containers, in rows and anywhere, without a thought of collisions."""
    poses = {e: Pose((x, y, made.shapes[e].half[2]), yaw_quaternion(yaw)) for e, (x, y, yaw) in FIXED.items()}
    situation = gripping(Situation(made, poses), Pose((0.5, 0.0, 0.4), (1.0, 0.0, 0.0, 0.0)), 0.08)
    for entity in rng.sample(OBJECTS, len(OBJECTS)):
        if entity in poses:
            continue
        turn = any_turn(rng)
        situation = situation.with_pose(entity, Pose((0.0, 0.0, 1.0), turn))
        half, other = situation.half(entity), rng.choice(sorted(situation.poses))
        (x, y, _), reach = situation.pose(other).position, situation.half(other)
        where, slack = rng.random(), rng.uniform(-0.003, 0.003)
        if where < 0.3 and other != entity:
            wall = made.shapes[other].wall
            height = situation.bottom(other) + wall if wall and rng.random() < 0.7 else situation.top(other)
            place = (x + rng.uniform(-1, 1) * reach[0], y + rng.uniform(-1, 1) * reach[1], height + half[2] + slack)
        elif where < 0.6 and other != entity:
            step = rng.choice([-1, 1]) * (reach[1] + half[1] + rng.uniform(0.004, 0.02))
            place = (x + rng.uniform(-0.02, 0.02), y + step, half[2] + slack)
        else:
            place = (rng.uniform(-0.3, 1.1), rng.uniform(-0.9, 0.9), half[2] + slack)
        situation = situation.with_pose(entity, Pose(place, turn))
    if rng.random() < 0.7:
        grasped = rng.choice(OBJECTS)
        x, y, z = situation.pose(grasped).position
        reach = rng.choice([0.01, situation.half(grasped)[0], situation.half(grasped)[1]])  # a long one at its end
        tool = Pose((x + rng.uniform(-reach, reach), y + rng.uniform(-reach, reach), z), (1.0, 0.0, 0.0, 0.0))
        situation = gripping(situation, tool, min(0.08, grip_width(gripping(situation, tool, 0.0), grasped, "panda")))
    return situation


def ruled_out(fact: Fact, made: Scene) -> bool:
    """Return whether a fact is excluded by a rule of every scene rather than by the definition of its predicate."""
    return fact.predicate.name == "on_top" and made.shapes[fact.arguments[1]].kind == "sphere"


@pytest.mark.parametrize("frame", ["robot", "viewer"])
def test_no_proof_excludes_facts_that_a_situation_satisfies(frame: str, chance: Chance) -> None:
    made = scene(frame)
    prover, rng, seen = Prover(made), chance.generator(1), set()
    for _ in range(chance.examples(120)):
        situation = any_situation(rng, made)
        facts = [
            Fact(PREDICATES[name], arguments, PREDICATES[name].holds(situation, arguments))
            for name, arguments in everything(made)
        ]
        true = [fact for fact in facts if fact.value]
        holding = [fact for fact in true if fact.predicate.name == "holding"]
        kept = [f for f in true if not ruled_out(f, made) and f not in holding[1:]]
        if holding:
            kept = [f for f in kept if f.predicate.name != "gripper_open"]
        assert prover.refutation([*kept, *(fact for fact in facts if not fact.value)]) is None
        seen |= {fact.predicate.name for fact in kept}
    assert seen >= {"on_top", "inside", "located", "left_of", "behind", "at", "holding", "reachable", "rotated"}


CASES = {
    "on a shelf beyond reach": (["on_top(can_1,shelf_1)", "reachable(panda,can_1)"], {"shelf_1": (0.92, 0.0, 0.0)}),
    "in a tray too near": (["inside(cube_1,tray_1)", "reachable(panda,cube_1)"], {"tray_1": (0.05, 0.0, 0.0)}),
    "in two containers": (["inside(cube_1,tray_1)", "inside(cube_1,crate_1)"], {"tray_1": (0.3, 0.3, 0.0),
                                                                               "crate_1": (0.3, -0.3, 0.0)}),
    "in one, above another": (["inside(can_1,tray_1)", "located(can_1,crate_1)"], {"tray_1": (0.3, 0.3, 0.0),
                                                                                  "crate_1": (0.3, -0.3, 0.0)}),
    "in and on": (["inside(tray_1,crate_1)", "on_top(crate_1,tray_1)"], {}),
    "one in the other": (["inside(tray_1,crate_1)", "inside(crate_1,tray_1)"], {}),
    "at two places": (["at(panda,tray_1)", "at(panda,shelf_1)"], FIXED),
    "turned in two ways": (["rotated(cube_1,straight)", "rotated(cube_1,turned)"], {}),
    "beyond the table": (["on_top(can_1,table_1)", "left_of(can_1,shelf_1)"], {"shelf_1": (0.5, 0.7, 0.0)}),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_two_facts_that_exclude_each_other_are_proved_and_both_are_needed(name: str) -> None:
    fluents, fixed = CASES[name]
    made = scene(fixed=fixed)
    noise = ("-holding(panda,ball_1)", "behind(cube_1,ball_1)", "on_top(brick_1,table_1)", "-reachable(panda,brick_1)")
    proof = proof_of(made, *fluents, noise=noise)
    assert proof is not None and proof.state == 1 and str(proof.after) == "x(panda)"
    assert sorted(f"{f.predicate.name}({','.join(f.arguments)})" for f in proof.facts) == sorted(fluents)
    assert str(proof).startswith("the state after x(panda): ")
    prover = Prover(made)
    assert prover.refutation(proof.facts) == proof.reason
    assert all(prover.refutation([fact]) is None for fact in proof.facts)


def test_a_circle_is_proved_by_its_relations_alone() -> None:
    circle = ["left_of(cube_1,can_1)", "right_of(ball_1,can_1)", "left_of(ball_1,cube_1)"]
    found = proof_of(scene(fixed={}), "behind(cube_1,can_1)", *circle)
    assert found is not None and {str(f.arguments) for f in found.facts} == {
        str(arguments) for arguments in (("cube_1", "can_1"), ("ball_1", "can_1"), ("ball_1", "cube_1"))
    }
    assert str(found).startswith("the initial state: the relations along y form a cycle: ")


def test_a_row_names_every_fact_that_it_needs_and_fits_where_it_is_a_little_shorter() -> None:
    row = ["left_of(can_1,tray_1)", "left_of(brick_1,can_1)", "left_of(shelf_1,brick_1)"]
    # From the tray's edge to the shelf's: the can is at least 66 mm, the brick 40 mm, and there are three gaps of 5 mm.
    needed = 0.066 + 0.04 + 3 * 0.005
    for slack, proved in ((-0.0001, True), (0.0001, False)):
        edge = 0.0 + 0.09
        made = scene(fixed={"tray_1": (0.5, 0.0, 0.0), "shelf_1": (0.5, edge + needed + 0.1 + slack, 0.0)})
        found = proof_of(made, *row)
        assert (found is not None) == proved
        if found is not None:
            assert len(found.facts) == 3
            assert "no room along y for the row tray 1, can 1, brick 1, shelf 1" in found.reason


def test_arms_of_two_robots_hold_one_object_each_and_the_workspace_is_no_limit_of_where_objects_can_be() -> None:
    made = scene(shapes={**SHAPES, "left": Shape("robot"), "right": Shape("robot")}, robots=ARMS)
    assert proof_of(made, "holding(left,cube_1)", "holding(right,can_1)") is None
    made = scene(fixed={}, workspace=(0.4, 0.41, -0.01, 0.01))
    on_table = [f"on_top({entity},table_1)" for entity in ("cube_1", "brick_1", "can_1")]
    assert proof_of(made, "left_of(cube_1,brick_1)", "left_of(brick_1,can_1)", *on_table) is None


def test_differences_agree_with_all_orders_of_small_graphs(chance: Chance) -> None:
    rng = chance.generator(3)
    nodes = [ORIGIN, *((name, "centre") for name in "abc")]
    for _ in range(chance.examples(300)):
        edges = rng.sample(list(itertools.permutations(nodes, 2)), rng.randint(1, 7))
        gaps = [Gap(low, high, rng.choice([-3, -2, -1, 1, 2])) for low, high in edges]
        table = {gap[:2]: gap.least for gap in gaps}
        closed = [
            [*itertools.pairwise((*walk, walk[0]))]
            for size in (2, 3, 4)
            for walk in itertools.permutations(nodes, size)
        ]
        row = impossible_row(gaps)
        assert bool(row) == any(sum(table[pair] for pair in walk) > 0 for walk in closed if set(walk) <= table.keys())
        if row:
            assert sum(table[pair] for pair in itertools.pairwise((*row, row[0]))) > 0
            continue
        walks = [
            [*itertools.pairwise((ORIGIN, *walk))]
            for size in (1, 2, 3)
            for walk in itertools.permutations(nodes[1:], size)
        ]
        for node, height in lowest(gaps, ORIGIN).items():
            lengths = [
                sum(table[p] for p in walk) for walk in walks if walk[-1][1] == node and set(walk) <= table.keys()
            ]
            assert height == (max(lengths) if node != ORIGIN else 0)


def test_what_is_heavier_than_an_arm_carries_cannot_be_held() -> None:
    held = [Fact(PREDICATES["holding"], ("panda", "cube_1"), True)]
    cube = 0.05**3
    for robot, limit in (("panda", 3.0), ("kuka", 14.0)):
        for kilograms, heavy in ((limit - 0.1, False), (limit + 0.1, True)):
            made = scene(robots={"panda": Mount(robot)}, materials={"cube_1": Material(kilograms / cube)})
            found = next(own_reasons(held[0], made), None)
            expected = f"cube 1 weighs {kilograms:.3g} kg, but the gripper carries at most {limit:g} kg"
            assert found == (expected if heavy else None)
