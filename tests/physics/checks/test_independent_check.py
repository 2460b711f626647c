"""The independent check accepts what validation accepts, and refuses witnesses that are broken in any way."""

from __future__ import annotations

import ast
import copy
import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.physics import Budget, open_validator
from prag_asp.scene.scene import Mount
from tests.independent.check import problems
from tests.independent.frames import frame
from tests.independent.tolerances import STRIDE
from tests.independent.world import world_of
from tests.physics.scenarios import HANDOVER, carrying, stacking

PLAIN = {"__future__", "collections.abc", "dataclasses", "functools", "itertools", "pathlib", "re", "typing"}
ALLOWED = PLAIN | {"numpy", "numpy.typing", "pybullet_data", "prag_asp.scene.scene", "prag_asp.scene.predicate_names"}
ALLOWED |= {"prag_asp.scene.read.mesh"}  # the convex parts, which are data of the scene

FETCH = ("open(panda,{0})", "approach(panda,{1},{0})", "grasp(panda,{1})", "move(panda,{1},{2})")
FETCH += ("drop(panda,{1})", "withdraw(panda,{1})", "close(panda,{0})")
FROM = (("drawer_1", "apple_1", "bowl_1"), ("cupboard_1", "cup_1", "table_1"))


def _records(name, plans, tier="kinematics", scene=None):
    """Return the world of a domain, and the records of witnesses of tasks: some drawn, or those of given plans."""
    domain = load_domain(name)
    scene = scene or load_scene(domain)
    if isinstance(plans, tuple):
        tasks = list(TaskSpace(domain, len(plans[0])).tasks_of_plans(plans))
    else:
        tasks = [task for length, count in plans.items() for task in TaskSpace(domain, length).sample(count, seed=6)]
    found = []
    with open_validator(scene) as validator:
        for index, task in enumerate(tasks):
            witness = validator.validate(task, seed=9, index=index, budget=Budget(10, 10, tier)).witness
            assert witness is not None
            found.append(_record(task, witness))
    return world_of(scene), found


def _record(task, witness):
    return json.loads(write_line(Record(task, None, witness.to_json())))


@pytest.fixture(scope="module")
def stacked(tabletop, tabletop_validator):
    return world_of(tabletop), [_record(stacking(), tabletop_validator.validate(stacking(), seed=1).witness)]


@pytest.fixture(scope="module")
def kitchen():
    return _records("kitchen", tuple(tuple(step.format(*each) for step in FETCH) for each in FROM))


@pytest.fixture(scope="module")
def two_arms():
    return _records(
        "two_arms", (HANDOVER, HANDOVER[:3] + HANDOVER[4:6] + ("move(left,middle)", "move(left,left_side)"))
    )


@pytest.fixture(scope="module", params=["stacked", "kitchen", "two_arms"])
def any_records(request):
    return request.getfixturevalue(request.param)


def _found(world, record, ways=None):
    return problems(record, record["witness"], world, ways)


def _changed(record):
    """Return a copy of a record, and its witness, states and motions."""
    changed = copy.deepcopy(record)
    return changed, changed["witness"]["moments"], changed["witness"]["motions"]


def _loose(world, moment):
    return [name for name in moment["poses"] if name not in world.places]


def _moments(records):
    return [(record, k, moment) for record in records for k, moment in enumerate(record["witness"]["moments"])]


def _waypoints(records):
    return [
        (record, k, i, waypoint)
        for record in records
        for k, motion in enumerate(record["witness"]["motions"])
        for i, waypoint in enumerate(motion)
    ]


def test_the_check_reads_nothing_of_the_librarys_physics():
    files = sorted((Path(__file__).parents[2] / "independent").glob("*.py"))
    assert len(files) > 5
    imported = set()
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom):
                imported.add(node.module)
            elif isinstance(node, ast.Import):
                imported |= {name.name for name in node.names}
    assert {name for name in imported if not name.startswith("tests.independent")} <= ALLOWED


@pytest.mark.parametrize(("name", "length"), [("tabletop", 3), ("tabletop", 6), ("prag", 6)])
def test_every_witness_that_validation_accepts_passes(name, length, request, chance):
    validator, world = request.getfixturevalue(f"{name}_validator"), world_of(request.getfixturevalue(name))
    checked, tries = 0, chance.examples(12)
    for index, task in enumerate(TaskSpace(load_domain(name), length).sample(tries, seed=chance.seed(11), weights={})):
        verdict = validator.validate(task, seed=chance.seed(11), index=index)
        if verdict.witness is not None:
            assert _found(world, _record(task, verdict.witness)) == [], task
            checked += 1
    assert checked >= 0.83 * tries


def test_good_witnesses_pass(any_records):
    world, records = any_records
    for record in records:
        assert _found(world, record) == []


def _some(cases, count, chance):
    """Return some of many cases, at least one."""
    cases = list(cases)
    assert cases
    return chance.generator(1).sample(cases, min(count, len(cases)))


def test_a_body_that_is_moved_into_another_or_into_the_table_is_found(any_records, chance):
    (world, records), rng = any_records, chance.generator(4)
    for record, k, moment in _some(_moments(records), 7, chance):
        name, other = rng.choice(_loose(world, moment)), rng.choice(list(moment["poses"]))
        changed, moments, _ = _changed(record)
        if other == name:
            moments[k]["poses"][name][0][2] = -0.02
            assert f"state {k}: {name} is in the table" in _found(world, changed)
        else:
            _push(world, moments[k]["poses"], name, other)
            pairs = {f"state {k}: {a} and {b} are in each other" for a, b in ((name, other), (other, name))}
            assert pairs & set(_found(world, changed)), (name, other)


def _push(world, poses, name, other):
    """Put a body beside a part of another, and then 2 cm into that."""
    part = max(world.parts[other], key=lambda each: float(np.prod(each.half)))
    place = frame(poses[other])
    middle = place.turn @ part.at + place.at
    height = float(np.abs(place.turn[2]) @ part.half) + world.halves[name].min()
    poses[name] = [[middle[0], middle[1], middle[2] + height - min(0.02, height)], [0.0, 0.0, 0.0, 1.0]]


def test_a_joint_beyond_its_limit_is_found_in_every_state_and_waypoint(any_records, chance):
    world, records = any_records
    rng = chance.generator(2)
    for record in records:
        for kind in ("moments", "motions"):
            for k in range(len(record["witness"][kind])):
                changed, *_ = _changed(record)
                each = changed["witness"][kind][k]
                arms = list(each["arms"].items()) if kind == "moments" else [(at["robot"], at) for at in each]
                name, arm = rng.choice(arms)
                limits, joint = world.robots[name].robot, rng.randrange(7)
                arm["joints"][joint] = rng.choice([limits.lower[joint] - 0.001, limits.upper[joint] + 0.001])
                assert any("beyond" in text for text in _found(world, changed))


def test_a_held_body_that_is_shifted_against_the_tool_is_found(any_records, chance):
    world, records = any_records
    arms = [(record, k, arm) for record, k, moment in _moments(records) for arm in moment["arms"].values()]
    cases = [(record, k, arm["held"]) for record, k, arm in arms if arm["held"] is not None]
    for axis, (record, k, held) in enumerate(_some(cases, 3, chance)):
        changed, moments, _ = _changed(record)
        moments[k]["poses"][held][0][axis] += 0.001
        assert f"state {k}: {held} is not where the gripper holds it" in _found(world, changed)


def test_every_dropped_waypoint_is_found(any_records, chance):
    world, records = any_records
    for record, k, i, waypoint in _some(_waypoints(records), 9, chance):
        changed, _, motions = _changed(record)
        del motions[k][i]
        assert _found(world, changed), (record["actions"][k], waypoint["name"], i)


def test_an_opening_that_contradicts_its_fluent_is_found(kitchen, chance):
    world, records = kitchen
    cases = [(record, k, name) for record, k, _ in _moments(records) for name in world.furniture]
    for record, k, name in _some(cases, 4, chance):
        fluent, limit = f"open({name})", world.furniture[name].limit
        is_open = [record["initial"], *record["states"]][k][fluent]
        changed, moments, _ = _changed(record)
        [changed["initial"], *changed["states"]][k][fluent] = not is_open
        assert any(f"state {k}: {fluent} is not" in text for text in _found(world, changed))
        nearly = moments[k]["openings"][name] - (0.004 if is_open else -0.004)
        for opening, found in (
            (0.0 if is_open else limit, f"state {k}: {fluent} is not"),
            (nearly, f"{name} is not open as"),
            (limit + 0.01, "furniture is open beyond its limit"),
        ):
            changed, moments, _ = _changed(record)
            moments[k]["openings"][name] = opening
            assert any(found in text or "leaps" in text for text in _found(world, changed)), found


def test_a_gripper_off_the_handle_and_what_is_left_behind_are_found(kitchen, chance):
    world, records = kitchen
    pulls = [(record, k, i) for record, k, i, waypoint in _waypoints(records) if waypoint["name"] == "pull"]
    for key, (record, k, i) in zip(("opening", "width", "joints", "joints"), _some(pulls, 4, chance), strict=True):
        changed, _, motions = _changed(record)
        waypoint = motions[k][i]
        if key == "joints":
            waypoint[key][1] += 0.005
        else:
            waypoint[key] += 0.02
        assert any("does not hold the handle" in text for text in _found(world, changed)), key
    left = [
        (record, k, body)
        for record, k, i in pulls
        for body in _loose(world, record["witness"]["moments"][k])
        if _pose(record, k, body) != _pose(record, k + 1, body)
    ]
    for record, k, body in _some(left, 2, chance):
        changed, moments, _ = _changed(record)
        moments[k + 1]["poses"][body] = _pose(record, k, body)
        assert f"action {k + 1}: {body} is not where it has been left" in _found(world, changed)


def _pose(record, k, body):
    return record["witness"]["moments"][k]["poses"][body]


def test_arms_that_are_swapped_and_one_that_moves_unexpectedly_are_found(two_arms, chance):
    world, records = two_arms
    cases = [(record, k) for record, k, _ in _moments(records) if k < len(record["actions"])]
    for record, k in _some(cases, 4, chance):
        changed, moments, motions = _changed(record)
        arms = moments[k]["arms"]
        arms["left"], arms["right"] = arms["right"], arms["left"]
        assert _found(world, changed), k
        changed, moments, _ = _changed(record)
        still = next(name for name in ("left", "right") if name != motions[k][-1]["robot"])
        moments[k]["arms"][still]["joints"][0] += 0.01
        assert "does not end where the next state begins" in "".join(_found(world, changed)) or k == 0
        changed, _, motions = _changed(record)
        for waypoint in motions[k]:
            waypoint["robot"] = {"left": "right", "right": "left"}[waypoint["robot"]]
        assert _found(world, changed), record["actions"][k]


def test_an_arm_in_the_other_one_is_found(two_arms):
    world, records = two_arms
    changed, moments, _ = _changed(records[1])
    reaching = np.array(world.robots["left"].base.at) - world.robots["right"].base.at
    joints = [float(np.arctan2(reaching[1], reaching[0])), 0.6, 0.0, -1.5, 0.0, 2.1, 0.8]
    moments[0]["arms"]["right"]["joints"] = joints
    found = _found(world, changed)
    assert "state 0: the arm is in that of left" in found and "state 0: the arm is in that of right" in found


def _apart(before, after):
    """Tell whether two waypoints turn one way with a leap between them: some ways are shorter than a stride."""
    turned = np.abs(np.subtract(after["joints"], before["joints"])).max()
    return before["name"] == after["name"] == "transit" and turned > 1.3 * STRIDE


@pytest.mark.parametrize(("name", "length"), [("kitchen", 2), ("two_arms", 3)])
def test_ways_pass_and_a_dropped_waypoint_or_a_body_in_the_way_is_found(name, length, chance):
    world, (record,) = _records(name, {length: 1}, "transit")
    assert _found(world, record, True) == []
    rng, motions = chance.generator(3), record["witness"]["motions"]
    names = [[waypoint["name"] for waypoint in motion] for motion in motions]
    places = [(k, i) for k, row in enumerate(names) for i in range(len(row) - 2) if row[i : i + 2] == ["transit"] * 2]
    long = [(k, i) for k, i in places if i and _apart(motions[k][i - 1], motions[k][i + 1])]
    for k, i in rng.sample(long, 2):
        changed, _, copied = _changed(record)
        del copied[k][i]
        assert any("the way leaps" in text for text in _found(world, changed, True)), (k, i)
    k, i = next((k, i) for k, i in places[len(places) // 3 :] if motions[k][i]["held"] is None)
    changed, moments, _ = _changed(record)
    waypoint = motions[k][i]
    tool = world.robots[waypoint["robot"]].tool(tuple(waypoint["joints"]))
    body = next(iter(_loose(world, moments[0])), None)
    if body is not None:
        for moment in moments:
            moment["poses"][body][0] = (tool.at - 0.08 * tool.turn[:, 2]).tolist()  # in the palm
        assert any(f"transit: the arm is in {body}" in text for text in _found(world, changed, True))


def test_the_kuka_is_checked_as_well_and_beside_a_panda():
    domain = load_domain("two_arms")
    scene = load_scene(domain)
    mounts = {"left": Mount("panda", 0.0, 0.36, 0.0), "right": Mount("kuka", -0.1, -0.40, 0.0)}
    world, records = _records("two_arms", {3: 2, 4: 2}, scene=replace(scene, robots=mounts))
    for record in records:
        assert _found(world, record) == []
        for k in (0, 2):
            changed, moments, _ = _changed(record)
            moments[k]["arms"]["right"]["joints"][1] = 2.0
            assert any("is in" in text for text in _found(world, changed)), k


@pytest.mark.parametrize(
    ("k", "name", "shift", "words"),
    [
        (2, "cube_1", (0.0, 0.0, -0.004), "brick_1 and cube_1 are in each other"),
        (2, "cube_1", (0.0, 0.0, 0.004), "on_top(cube_1,brick_1) is not true"),
        (2, "cube_1", (0.0, 0.0, 0.004), "cube_1 falls"),
        (2, "cube_1", (0.02, 0.0, 0.0), "cube_1 is not where it has been left"),
        (1, "brick_1", (0.0005, 0.0, 0.0), "action 1: brick_1 is not where it has been left"),
        (0, "brick_1", (0.0, 0.0, 0.01), "state 0: brick_1 falls"),
    ],
)
def test_a_moved_body_is_found(stacked, k, name, shift, words):
    world, (record,) = stacked
    changed, moments, _ = _changed(record)
    moments[k]["poses"][name][0] = [a + b for a, b in zip(_pose(record, k, name)[0], shift, strict=True)]
    assert words in "\n".join(_found(world, changed))


def test_a_body_that_slips_in_the_hand_is_found(prag, prag_validator):
    record, world = _record(carrying(), prag_validator.validate(carrying(), seed=1).witness), world_of(prag)
    assert _found(world, record) == []
    moment = record["witness"]["moments"][3]
    arm = moment["arms"]["panda"]
    arm["grasp"][0][2] += 0.005
    held = world.robots["panda"].tool(tuple(arm["joints"])) @ frame(arm["grasp"])
    moment["poses"]["apple_1"][0] = held.at.tolist()
    assert any("action 3: apple_1 slips in the gripper" in text for text in _found(world, record))


def test_numbers_that_are_not_finite_and_swapped_joints_are_found(stacked):
    world, (record,) = stacked
    arm, values = ("arms", "panda"), itertools.cycle((math.nan, math.inf, -math.inf))
    places = [("moments", 1, "poses", "cube_1", 0, 2), ("moments", 1, "poses", "brick_1", 1, 3)]
    places += [("moments", 2, *arm, "joints", 4), ("moments", 0, *arm, "width"), ("moments", 1, *arm, "grasp", 0, 0)]
    places += [("motions", 0, 0, "joints", 3), ("motions", 1, 1, "width")]
    for place in places:
        data = changed = copy.deepcopy(record)
        data = data["witness"]
        for key in place[:-1]:
            data = data[key]
        data[place[-1]] = next(values)
        assert _found(world, changed), place
    for one, two in itertools.pairwise(range(7)):
        changed, moments, _ = _changed(record)
        joints = moments[1]["arms"]["panda"]["joints"]
        joints[one], joints[two] = joints[two], joints[one]
        assert abs(joints[one] - joints[two]) <= 0.01 or _found(world, changed), (one, two)


def _set_arm(record, k, **changes):
    record["witness"]["moments"][k]["arms"]["panda"].update(changes)


def _set_states(record):
    record["states"][0]["holding(panda,cube_1)"] = False
    record["states"][1]["on_top(cube_1,table_1)"] = True


def _put_arm_into_body(record):
    moments, low = record["witness"]["moments"], record["witness"]["motions"][0][1]
    assert low["name"] == "at"
    _set_arm(record, 0, joints=low["joints"], width=0.02)
    moments[0]["poses"]["brick_1"][0][:2] = moments[0]["poses"]["cube_1"][0][:2]


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda record: _set_arm(record, 0, width=0.0801), ["beyond its limits"]),
        (_set_states, ["state 1: holding(panda,cube_1) is not false", "state 2: on_top(cube_1,table_1) is not true"]),
        (_put_arm_into_body, ["state 0: the arm is in "]),
        (lambda record: record["witness"]["moments"].pop(), []),
        (lambda record: record["witness"]["motions"].pop(), []),
        (lambda record: record["witness"]["motions"][0].clear(), []),
        (lambda record: record["witness"]["moments"][1]["poses"].pop("brick_1"), []),
        (lambda record: record["witness"]["moments"][1]["arms"].clear(), []),
        (lambda record: _set_arm(record, 1, held=None), []),
        (lambda record: _set_arm(record, 1, held=None, grasp=None), []),
    ],
)
def test_what_is_spoiled_or_missing_is_found(stacked, spoil, words):
    world, (record,) = stacked
    changed = copy.deepcopy(record)
    spoil(changed)
    found = "\n".join(_found(world, changed))
    assert found and all(text in found for text in words)
