from __future__ import annotations

from dataclasses import replace
from itertools import islice, pairwise

import numpy as np
import pytest

from prag_asp.physics import Budget, check_demonstration, check_witness, demonstrate
from prag_asp.physics.motion.transit import plan_transit, with_transit
from prag_asp.physics.robot.kinematics import inverse
from prag_asp.physics.search.attempt import NO_PATH
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.witness import TRANSIT, Witness
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import PANDA
from tests.physics.random_tasks import random_tasks
from tests.physics.scenarios import carrying, stacking

LONGEST_STRIDE = 0.35
"""Radians: straight up and down a joint turns by at most 1.2 in four strides."""


@pytest.fixture(scope="module")
def travelled(tabletop_validator):
    return tabletop_validator.validate(stacking(), seed=1, budget=Budget(3, 10, "transit")).witness


def test_ways_are_added_and_nothing_else_of_a_witness_changes(tabletop_validator, tabletop, travelled):
    bare = tabletop_validator.validate(stacking(), seed=1).witness
    assert travelled.has_transit and not bare.has_transit
    assert travelled.moments == bare.moments
    own = tuple(tuple(each for each in motion if each.name != TRANSIT) for motion in travelled.motions)
    assert own == bare.motions
    assert plan_transit(stacking(), bare, tabletop) == travelled == plan_transit(stacking(), travelled, tabletop)
    assert Witness.from_json(travelled.to_json()) == travelled


@pytest.mark.parametrize("name", ["tabletop", "prag"])
def test_the_independent_check_accepts_ways_of_random_tasks_without_a_gap(request, name, chance):
    scene, validator = request.getfixturevalue(name), request.getfixturevalue(f"{name}_validator")
    for index, made in enumerate(islice(random_tasks(name, 4, chance.seed(5)), 4)):
        witness = validator.validate(made, seed=chance.seed(4), index=index, budget=Budget(10, 10, "transit")).witness
        assert check_witness(made, witness, scene) == []
        home = witness.moments[0].arms["panda"].joints
        joints = [home, *(each.joints for motion in witness.motions for each in motion)]
        assert max(np.abs(np.subtract(one, two)).max() for one, two in pairwise(joints)) < LONGEST_STRIDE


def test_the_independent_check_sees_a_way_through_an_object_and_one_with_its_load_through_another(tabletop, travelled):
    x, y, _ = travelled.moments[1].poses["brick_1"].position
    picking, (first, *rest) = travelled.motions
    assert first.name == TRANSIT and first.held == "cube_1"
    for height, found in ((0.02, "the arm collides with brick_1"), (0.058, "cube_1 collides with brick_1")):
        low = next(inverse(PANDA, Pose((x, y, height), (1.0, 0.0, 0.0, 0.0))))
        changed = replace(travelled, motions=(picking, (replace(first, joints=low), *rest)))
        problems = check_witness(stacking(), changed, tabletop)
        assert f"action 2, stack(panda,cube_1,brick_1): transit: {found}" in problems


def test_where_no_way_is_found_the_search_goes_on_and_says_so(tabletop, tabletop_validator, monkeypatch):
    from prag_asp.physics.motion import transit

    witness = tabletop_validator.validate(stacking(), seed=1).witness
    monkeypatch.setattr(transit, "checked_path", lambda *_: None)
    with open_simulator(tabletop) as simulator:
        assert with_transit(simulator, physical_task(stacking(), tabletop), witness) is None
    verdict = tabletop_validator.validate(stacking(), seed=1, budget=Budget(2, 10, "transit"))
    assert (verdict.status, verdict.reason, verdict.causes[NO_PATH]) == ("not_found", NO_PATH, 2)


def test_the_robot_moves_along_the_way_of_the_witness(prag, prag_validator):
    made = carrying("box_1")
    witness = prag_validator.validate(made, seed=1, budget=Budget(5, 10, "transit")).witness
    demonstration = demonstrate(made, witness, prag)
    assert demonstration.success, demonstration.detail
    assert check_demonstration(made, demonstration, prag) == []
    way = [each.joints for each in witness.motions[2] if each.name == TRANSIT]
    commands = demonstration.commands[demonstration.ends[2] : demonstration.ends[3] + 1, 0, :7]
    assert len(way) > 5
    assert max(np.abs(commands - joints).max(axis=1).min() for joints in way) < 0.08
