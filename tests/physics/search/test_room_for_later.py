"""Room for objects that are placed later, beside others or between them."""

from __future__ import annotations

import random
from itertools import permutations

import numpy as np
import pytest

from prag_asp.physics import Budget
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.beside import GAP, MARGIN, SIDES
from prag_asp.physics.search.attempt import Failure, Search
from prag_asp.physics.search.foresight import foresee
from prag_asp.physics.search.initial_state import sample_initial_state
from prag_asp.physics.search.spacing_chains import spacing_chains, spacing_volume
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact, physical_task
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import IDENTITY, Pose
from prag_asp.scene.scene import Scene, Shape
from tests.physics.scenarios import state, task

NAMES = ("cube_1", "brick_1", "can_1", "cube_2", "brick_2")
SHAPES = {
    "panda": Shape("robot"),
    "table_1": Shape("table"),
    "cube_1": Shape("box", (0.05, 0.05, 0.05)),
    "cube_2": Shape("box", (0.05, 0.05, 0.05)),
    "brick_1": Shape("box", (0.06, 0.12, 0.04)),
    "brick_2": Shape("box", (0.06, 0.12, 0.04)),
    "can_1": Shape("cylinder", (0.066, 0.066, 0.10)),
}


ROW = task(
    state("inside(can_1,tray_1)", "inside(cube_2,tray_1)"),
    ("pick(panda,can_1,tray_1)", state("holding(panda,can_1)", "-inside(can_1,tray_1)")),
    (
        "place(panda,can_1,behind,tray_1)",
        state("-holding(panda,can_1)", "on_top(can_1,table_1)", "behind(can_1,tray_1)"),
    ),
    ("pick(panda,cube_2,tray_1)", state("holding(panda,cube_2)", "-inside(cube_2,tray_1)")),
    (
        "place(panda,cube_2,behind,can_1)",
        state("-holding(panda,cube_2)", "on_top(cube_2,table_1)", "behind(cube_2,can_1)"),
    ),
    forget=("on_top(can_1,table_1)",),
)


def _situation(rng: random.Random, frame: str) -> Situation:
    scene = Scene(shapes=SHAPES, frame=frame)
    poses = {}
    for name in NAMES:
        x, y = rng.uniform(0.2, 0.9), rng.uniform(-0.5, 0.5)
        poses[name] = Pose((x, y, scene.shapes[name].half[2]), IDENTITY)
    return Situation(scene, poses)


def _clear(situation: Situation, name: str, one: str, two: str) -> bool:
    """Tell whether a relation holds with the room to spare that placement leaves."""
    if not PREDICATES[name].holds(situation, (one, two)):
        return False
    axis, sign = SIDES[name].in_frame(situation.scene.frame)
    along = sign * (situation.pose(one).position[axis] - situation.pose(two).position[axis])
    across = abs(situation.pose(one).position[1 - axis] - situation.pose(two).position[1 - axis])
    sides = situation.half(one)[axis] + situation.half(two)[axis]
    return along >= sides + GAP + 2 * MARGIN and across <= 2 * (along - 3 * MARGIN)


@pytest.mark.parametrize("frame", ["robot", "viewer"])
def test_no_arrangement_in_which_the_relations_hold_is_left_out(frame, chance):
    rng, chained = chance.generator(4), 0
    for _ in range(chance.examples(400)):
        situation = _situation(rng, frame)
        true = [
            Fact(PREDICATES[name], pair, True)
            for pair in permutations(NAMES, 2)
            for name in SIDES
            if _clear(situation, name, *pair)
        ]
        facts = rng.sample(true, min(len(true), 6))
        entity, *others = rng.sample(NAMES, 3)
        placed = situation.with_poses({name: situation.poses[name] for name in others})
        found = spacing_chains(placed, entity, facts)
        if found:
            _, narrow = found
            chained += bool(narrow)
            volume = spacing_volume(placed, entity, IDENTITY, narrow)
            assert volume.miss_distance(situation.pose(entity).position) < 1e-9
    assert chained > 20


def test_the_room_for_a_chain_is_what_stands_in_it(chance):
    situation = _situation(chance.generator(0), "robot").with_poses({"cube_1": Pose((0.5, 0.3, 0.025))})
    facts = [Fact(PREDICATES["right_of"], ("can_1", "cube_1"), True)]
    facts.append(Fact(PREDICATES["left_of"], ("can_1", "brick_1"), True))
    wide, narrow = spacing_chains(situation, "brick_1", facts)
    assert [(chain.end, chain.side) for chain in narrow] == [("cube_1", SIDES["right_of"])]
    assert narrow[0].between == wide[0].between == pytest.approx(0.066 + GAP + 2 * MARGIN)
    volume = spacing_volume(situation, "brick_1", IDENTITY, narrow)
    assert volume.high[1] == pytest.approx(0.3 - 0.025 - 0.06 - 0.066 - 2 * GAP - 3 * MARGIN)
    assert spacing_chains(situation, "can_1", facts) == ([], [])
    assert spacing_chains(situation, "brick_1", facts[:0]) == ()


def test_what_stands_in_a_circle_of_relations_ends(chance):
    situation = _situation(chance.generator(0), "robot").with_poses({"cube_1": Pose((0.5, 0.3, 0.025))})
    pairs = (("can_1", "brick_1"), ("brick_1", "can_1"), ("brick_1", "cube_1"), ("cube_2", "can_1"))
    facts = [Fact(PREDICATES["left_of"], pair, True) for pair in pairs]
    assert {chain.end for chain in spacing_chains(situation, "cube_2", facts)[1]} == {"cube_1"}


def test_an_object_between_two_large_ones_always_finds_room(chance):
    # The bricks get their places first, the cube last.
    between = state("left_of(brick_1,cube_1)", "left_of(cube_1,brick_2)")
    row = state("in_front_of(brick_1,cube_1)", "in_front_of(cube_1,cube_2)", "in_front_of(cube_2,brick_2)")
    scene = Scene(shapes=SHAPES, frame="viewer", workspace=(0.32, 0.62, -0.35, 0.35))
    with open_simulator(scene) as simulator:
        for initial in (between, row):
            wanted = physical_task(task(initial), scene)
            spawned = 0
            for seed in range(60):
                rng = np.random.default_rng(chance.seed(seed))
                search = Search(simulator, wanted.objects, rng, foresee(wanted, scene))
                for _ in range(50):
                    try:
                        situation = sample_initial_state(search, wanted).situation
                    except Failure:
                        continue
                    assert all(fact.is_satisfied(situation) for fact in wanted.initial)
                    spawned += 1
                    break
            assert spawned == 60


def test_an_object_leaves_room_for_what_is_put_beside_it_later(tabletop):
    ample, enough = foresee(physical_task(ROW, tabletop), tabletop)[2, "can_1"]
    low = tabletop.workspace[0]
    assert ample.low[0] > enough.low[0] > low + 0.025  # behind is nearer to the robot for a viewer
    assert enough.high == (float("inf"),) * 3
    # What nothing is put beside is free.
    assert (4, "cube_2") not in foresee(physical_task(ROW, tabletop), tabletop)


def test_a_row_that_just_fits_is_found_at_once(tabletop_validator):
    verdicts = [tabletop_validator.validate(ROW, seed=seed, budget=Budget(3, 10)) for seed in range(10)]
    assert sum(verdict.feasible for verdict in verdicts) >= 9
