"""The independent check fails where a witness is broken: every one of many ways to break those of random tasks."""

from __future__ import annotations

import copy
import json
from dataclasses import replace

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
from tests.physics.scenarios import HANDOVER

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
            found.append(json.loads(write_line(Record(task, None, witness.to_json()))))
    return world_of(scene), found


@pytest.fixture(scope="module")
def kitchen():
    return _records("kitchen", tuple(tuple(step.format(*each) for step in FETCH) for each in FROM))


@pytest.fixture(scope="module")
def two_arms():
    return _records(
        "two_arms", (HANDOVER, HANDOVER[:3] + HANDOVER[4:6] + ("move(left,middle)", "move(left,left_side)"))
    )


@pytest.fixture(scope="module", params=["kitchen", "two_arms"])
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


def test_honest_witnesses_pass(any_records):
    world, records = any_records
    for record in records:
        assert _found(world, record) == []


def _some(cases, count, chance):
    """Return some of many cases, at least one."""
    cases = list(cases)
    assert cases
    return chance.generator(1).sample(cases, min(count, len(cases)))


def test_a_body_that_is_moved_into_another_or_into_the_table_is_found(any_records, chance):
    world, records = any_records
    cases = [
        (record, k, name, other)
        for record in records
        for k, moment in enumerate(record["witness"]["moments"])
        for name in _loose(world, moment)
        for other in moment["poses"]
    ]
    for record, k, name, other in _some(cases, 10, chance):
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
    cases = [
        (record, k, arm["held"])
        for record in records
        for k, moment in enumerate(record["witness"]["moments"])
        for arm in moment["arms"].values()
        if arm["held"] is not None
    ]
    for axis, (record, k, held) in enumerate(_some(cases, 3, chance)):
        changed, moments, _ = _changed(record)
        moments[k]["poses"][held][0][axis] += 0.001
        assert f"state {k}: {held} is not where the gripper holds it" in _found(world, changed)


def test_every_dropped_waypoint_is_found(any_records, chance):
    world, records = any_records
    cases = [
        (record, k, i)
        for record in records
        for k, motion in enumerate(record["witness"]["motions"])
        for i in range(len(motion))
    ]
    for record, k, i in _some(cases, 15, chance):
        changed, _, motions = _changed(record)
        dropped = motions[k].pop(i)
        assert _found(world, changed), (record["actions"][k], dropped["name"], i)


def test_an_opening_that_is_not_as_it_is_told_is_found(kitchen, chance):
    world, records = kitchen
    cases = [
        (record, k, name) for record in records for k in range(len(record["states"]) + 1) for name in world.furniture
    ]
    for record, k, name in _some(cases, 4, chance):
        fluent, limit = f"open({name})", world.furniture[name].limit
        is_open = [record["initial"], *record["states"]][k][fluent]
        changed, moments, _ = _changed(record)
        [changed["initial"], *changed["states"]][k][fluent] = not is_open
        assert any(f"state {k}: {fluent} is not" in text for text in _found(world, changed))
        for opening, found in (
            (0.0 if is_open else limit, f"state {k}: {fluent} is not"),
            (
                record["witness"]["moments"][k]["openings"][name] - (0.004 if is_open else -0.004),
                f"{name} is not open as",
            ),
            (limit + 0.01, "furniture is open beyond its limit"),
        ):
            changed, moments, _ = _changed(record)
            moments[k]["openings"][name] = opening
            assert any(found in text or "leaps" in text for text in _found(world, changed)), found


def test_a_gripper_off_the_handle_and_what_is_left_behind_are_found(kitchen, chance):
    world, records = kitchen
    pulls = [
        (record, k, i)
        for record in records
        for k, motion in enumerate(record["witness"]["motions"])
        for i, waypoint in enumerate(motion)
        if waypoint["name"] == "pull"
    ]
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


def test_arms_that_are_swapped_and_one_that_moves_unasked_are_found(two_arms, chance):
    world, records = two_arms
    cases = [(record, k) for record in records for k in range(len(record["actions"]))]
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
    places = [
        (k, i)
        for k, motion in enumerate(motions)
        for i, each in enumerate(motion[:-2])
        if each["name"] == motion[i + 1]["name"] == "transit"
    ]
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
