from __future__ import annotations

import ast
import copy
import itertools
import json
import math
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.dataset.jsonl import Record, write_line
from tests.independent.check import problems
from tests.independent.frames import frame
from tests.independent.world import world_of
from tests.physics.scenarios import carrying, stacking

ROOT = Path(__file__).parents[3]


def _record(validator, task, seed=1):
    return json.loads(write_line(Record(task, None, validator.validate(task, seed=seed).witness.to_json())))


@pytest.fixture(scope="module")
def stacked(tabletop, tabletop_validator):
    """A picked and stacked cube, and the world in which it was."""
    return _record(tabletop_validator, stacking()), world_of(tabletop)


@pytest.fixture(scope="module")
def carried(prag, prag_validator):
    return _record(prag_validator, carrying()), world_of(prag)


def _found(record, world):
    return "\n".join(problems(record, record["witness"], world))


def test_the_check_reads_nothing_of_the_librarys_physics():
    files = sorted((ROOT / "tests" / "independent").glob("*.py"))
    assert len(files) > 5
    imported = set()
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom):
                imported.add(node.module)
            elif isinstance(node, ast.Import):
                imported |= {name.name for name in node.names}
    own = {name for name in imported if name.startswith("tests.independent")}
    plain = {"__future__", "collections.abc", "dataclasses", "functools", "itertools", "pathlib", "re", "typing"}
    assert imported - own <= plain | {
        "numpy",
        "numpy.typing",
        "pybullet_data",
        "prag_asp.scene.scene",
        "prag_asp.scene.predicate_names",
    }


@pytest.mark.parametrize(("name", "length"), [("tabletop", 3), ("tabletop", 6), ("prag", 6)])
def test_every_witness_that_validation_accepts_passes(name, length, request, chance):
    validator, world = request.getfixturevalue(f"{name}_validator"), world_of(request.getfixturevalue(name))
    checked, tries = 0, chance.examples(25)
    for index, task in enumerate(TaskSpace(load_domain(name), length).sample(tries, seed=chance.seed(11), weights={})):
        verdict = validator.validate(task, seed=chance.seed(11), index=index)
        if verdict.witness is not None:
            record = json.loads(write_line(Record(task, None, verdict.witness.to_json())))
            assert problems(record, record["witness"], world) == [], task
            checked += 1
    assert checked >= 0.88 * tries


def test_an_honest_witness_passes(stacked, carried):
    assert _found(*stacked) == _found(*carried) == ""


@pytest.mark.parametrize(
    ("shift", "words"),
    [
        ((0.0, 0.0, -0.004), "brick_1 and cube_1 are in each other"),
        ((0.0, 0.0, 0.004), "on_top(cube_1,brick_1) is not true"),
        ((0.0, 0.0, 0.004), "cube_1 falls"),
        ((0.02, 0.0, 0.0), "cube_1 is not where it has been left"),
    ],
)
def test_a_body_that_is_moved_where_it_is_put_down_is_refused(stacked, shift, words):
    record, world = copy.deepcopy(stacked[0]), stacked[1]
    _shift(record["witness"]["moments"][2], "cube_1", shift)
    assert words in _found(record, world)


def _shift(moment, name, shift):
    moment["poses"][name][0] = [a + b for a, b in zip(moment["poses"][name][0], shift, strict=True)]


@pytest.mark.parametrize("k", [0, 1, 2])
def test_a_sunk_body_is_refused_in_every_state(stacked, k):
    record, world = copy.deepcopy(stacked[0]), stacked[1]
    _shift(record["witness"]["moments"][k], "brick_1", (0, 0, -0.003))
    assert f"state {k}: brick_1 is in the table" in _found(record, world)


def test_a_body_that_nothing_touches_but_moves_is_refused(stacked):
    record, world = copy.deepcopy(stacked[0]), stacked[1]
    _shift(record["witness"]["moments"][1], "brick_1", (0.0005, 0, 0))
    assert "action 1: brick_1 is not where it has been left" in _found(record, world)


def test_a_body_that_floats_is_refused(stacked):
    record, world = copy.deepcopy(stacked[0]), stacked[1]
    _shift(record["witness"]["moments"][0], "brick_1", (0, 0, 0.01))
    assert "state 0: brick_1 falls" in _found(record, world)


def test_a_body_out_of_the_hand_is_refused(stacked, carried):
    for (record, world), name, k in ((stacked, "cube_1", 1), (carried, "apple_1", 3)):
        changed = copy.deepcopy(record)
        _shift(changed["witness"]["moments"][k], name, (0.0005, 0, 0))
        assert f"state {k}: {name} is not where the gripper holds it" in _found(changed, world)


def test_a_body_that_slips_in_the_hand_is_refused(carried):
    record, world = copy.deepcopy(carried[0]), carried[1]
    moment = record["witness"]["moments"][3]
    arm = moment["arms"]["panda"]
    arm["grasp"][0][2] += 0.005
    held = world.robots["panda"].tool(tuple(arm["joints"])) @ frame(arm["grasp"])
    moment["poses"]["apple_1"][0] = held.at.tolist()
    assert "action 3: apple_1 slips in the gripper" in _found(record, world)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused_wherever_they_stand(stacked, value):
    record, world = stacked
    places = [("moments", 1, "poses", "cube_1", 0, 2), ("moments", 1, "poses", "brick_1", 1, 3)]
    arm = ("arms", "panda")
    places += [("moments", 2, *arm, "joints", 4), ("moments", 0, *arm, "width"), ("moments", 1, *arm, "grasp", 0, 0)]
    places += [("motions", 0, 0, "joints", 3), ("motions", 1, 1, "width")]
    for place in places:
        changed = copy.deepcopy(record)
        data = changed["witness"]
        for key in place[:-1]:
            data = data[key]
        data[place[-1]] = value
        assert _found(changed, world), place


def test_swapped_joints_are_refused(stacked):
    record, world = stacked
    for one, two in itertools.combinations(range(7), 2):
        changed = copy.deepcopy(record)
        joints = changed["witness"]["moments"][1]["arms"]["panda"]["joints"]
        joints[one], joints[two] = joints[two], joints[one]
        if abs(joints[one] - joints[two]) > 0.01:
            assert _found(changed, world), (one, two)


def test_a_joint_beyond_its_limits_and_a_gripper_that_opens_too_far_are_refused(stacked):
    for key, value in (("joints", [0, 0, 0, -2, 0, 3.8, 0]), ("width", 0.0801)):
        record, world = copy.deepcopy(stacked[0]), stacked[1]
        record["witness"]["moments"][0]["arms"]["panda"][key] = value
        assert "beyond its limits" in _found(record, world)


def test_other_states_of_the_task_are_refused(stacked):
    record, world = copy.deepcopy(stacked[0]), stacked[1]
    record["states"][0]["holding(panda,cube_1)"] = False
    record["states"][1]["on_top(cube_1,table_1)"] = True
    found = _found(record, world)
    assert "state 1: holding(panda,cube_1) is not false" in found
    assert "state 2: on_top(cube_1,table_1) is not true" in found


def test_missing_bodies_states_and_waypoints_are_refused(stacked):
    for spoil in (
        lambda witness: witness["moments"].pop(),
        lambda witness: witness["motions"].pop(),
        lambda witness: witness["motions"][0].clear(),
        lambda witness: witness["motions"][0].pop(),
        lambda witness: witness["moments"][1]["poses"].pop("brick_1"),
        lambda witness: witness["moments"][1]["arms"].clear(),
        lambda witness: witness["moments"][1]["arms"]["panda"].update(held=None),
        lambda witness: witness["moments"][1]["arms"]["panda"].update(held=None, grasp=None),
    ):
        record, world = copy.deepcopy(stacked[0]), stacked[1]
        spoil(record["witness"])
        assert _found(record, world)


def test_an_arm_in_a_body_is_refused(stacked):
    record, world = copy.deepcopy(stacked[0]), stacked[1]
    moments = record["witness"]["moments"]
    low = record["witness"]["motions"][0][1]
    assert low["name"] == "at"
    moments[0]["arms"]["panda"].update(joints=low["joints"], width=0.02)
    moments[0]["poses"]["brick_1"][0][:2] = moments[0]["poses"]["cube_1"][0][:2]
    assert "state 0: the arm is in " in _found(record, world)
