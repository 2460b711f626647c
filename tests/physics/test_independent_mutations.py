"""The independent check fails where a witness is broken: every one of many ways to break those of random tasks."""

from __future__ import annotations

import copy
import json
import random
from dataclasses import replace

import numpy as np
import pytest

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.domain.scene import Mount
from prag_asp.physics import Budget, open_validator
from tests.independent.check import problems
from tests.independent.frames import frame
from tests.independent.moments import arms_of
from tests.independent.world import world_of

HANDOVER = ("pick(left,bar_1,left_side)", "move(left,middle)", "move(right,middle)", "give(left,right,bar_1)")
HANDOVER += ("move(left,left_side)", "move(right,right_side)", "place(right,bar_1,right_side)")


def _records(name, plans, tier="kinematics", scene=None):
    """Return the world of a domain, and the records of witnesses of tasks: some drawn, or those of given plans."""
    domain = load_domain(name)
    scene = scene or load_scene(domain)
    if isinstance(plans, tuple):
        tasks = list(TaskSpace(domain, len(plans[0])).narrate(plans))
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
    return _records("kitchen", {3: 1, 5: 1, 7: 2})


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


def test_a_body_that_is_moved_into_another_or_into_the_table_is_found(any_records):
    world, records = any_records
    rng, tried = random.Random(1), 0
    for record in records:
        for k, moment in enumerate(record["witness"]["moments"]):
            for name in _loose(world, moment):
                changed, moments, _ = _changed(record)
                moments[k]["poses"][name][0][2] -= 0.02
                found = _found(world, changed)
                assert any(f"state {k}: {name}" in text or f" and {name} are in each" in text for text in found)
                other = rng.choice([each for each in moment["poses"] if each != name] or [name])
                if other != name:
                    changed, moments, _ = _changed(record)
                    _push(world, moments[k]["poses"], name, other)
                    pairs = {f"state {k}: {a} and {b} are in each other" for a, b in ((name, other), (other, name))}
                    assert pairs & set(_found(world, changed)), (name, other)
                    tried += 1
    assert tried > 5


def _push(world, poses, name, other):
    """Put a body beside a part of another, and then 2 cm into that."""
    part = max(world.parts[other], key=lambda each: float(np.prod(each.half)))
    place = frame(poses[other])
    middle = place.turn @ part.at + place.at
    height = float(np.abs(place.turn[2]) @ part.half) + world.halves[name].min()
    poses[name] = [[middle[0], middle[1], middle[2] + height - min(0.02, height)], [0.0, 0.0, 0.0, 1.0]]


def test_a_joint_beyond_its_limit_is_found_in_every_state_and_waypoint(any_records):
    world, records = any_records
    rng = random.Random(2)
    for record in records:
        for kind in ("moments", "motions"):
            for k in range(len(record["witness"][kind])):
                changed, *_ = _changed(record)
                each = changed["witness"][kind][k]
                arm = rng.choice(list(arms_of(each).values()) if kind == "moments" else each)
                limits = world.robots[world.robot(arm.get("robot", ""))].robot
                joint = rng.randrange(7)
                arm["joints"][joint] = rng.choice([limits.lower[joint] - 0.001, limits.upper[joint] + 0.001])
                assert any("beyond" in text for text in _found(world, changed))


def test_a_held_body_that_is_shifted_against_the_tool_is_found(any_records):
    world, records = any_records
    tried = 0
    for record in records:
        for k, moment in enumerate(record["witness"]["moments"]):
            for arm in arms_of(moment).values():
                if arm["held"] is not None:
                    for axis in range(3):
                        changed, moments, _ = _changed(record)
                        moments[k]["poses"][arm["held"]][0][axis] += 0.001
                        text = f"state {k}: {arm['held']} is not where the gripper holds it"
                        assert text in _found(world, changed)
                        tried += 1
    assert tried >= 6


def test_every_dropped_waypoint_is_found(any_records):
    world, records = any_records
    for record in records[1:3]:
        for k, motion in enumerate(record["witness"]["motions"]):
            for i in range(len(motion)):
                changed, _, motions = _changed(record)
                del motions[k][i]
                assert _found(world, changed), (record["actions"][k], motion[i]["name"], i)


def test_an_opening_that_is_not_as_it_is_told_is_found(kitchen):
    world, records = kitchen
    for record in records:
        for k, state in enumerate([record["initial"], *record["states"]]):
            for name, furniture in world.furniture.items():
                fluent = f"open({name})"
                changed, moments, _ = _changed(record)
                told = [changed["initial"], *changed["states"]][k]
                told[fluent] = not state[fluent]
                assert any(f"state {k}: {fluent} is not" in text for text in _found(world, changed))
                changed, moments, _ = _changed(record)
                moments[k]["openings"][name] = 0.0 if state[fluent] else furniture.limit
                assert any(f"state {k}: {fluent} is not" in text for text in _found(world, changed))
                changed, moments, _ = _changed(record)
                moments[k]["openings"][name] += 0.004 if state[fluent] is False else -0.004
                assert any(f"{name} is not open as it has been left" in text for text in _found(world, changed))
                changed, moments, _ = _changed(record)
                moments[k]["openings"][name] = furniture.limit + 0.01
                assert "furniture is open beyond its limit" in _found(world, changed)


def test_a_gripper_off_the_handle_and_what_is_left_behind_are_found(kitchen):
    world, records = kitchen
    tried = 0
    for record in records:
        for k, motion in enumerate(record["witness"]["motions"]):
            pulls = [i for i, waypoint in enumerate(motion) if waypoint["name"] == "pull"]
            for i in pulls[:1]:
                for key, change, text in (
                    ("opening", 0.003, "does not hold the handle"),
                    ("width", 0.004, "does not hold the handle"),
                    ("joints", 0.005, "does not hold the handle"),
                ):
                    changed, _, motions = _changed(record)
                    waypoint = motions[k][i]
                    if key == "joints":
                        waypoint[key][1] += change
                    else:
                        waypoint[key] += change
                    assert any(text in each for each in _found(world, changed)), key
                name, before = motion[i]["held"], record["witness"]["moments"][k]
                after = record["witness"]["moments"][k + 1]
                for body in _loose(world, before):
                    if before["poses"][body] != after["poses"][body]:
                        assert name == "drawer_1"
                        changed, moments, _ = _changed(record)
                        moments[k + 1]["poses"][body] = before["poses"][body]
                        text = f"action {k + 1}: {body} is not where it has been left"
                        assert text in _found(world, changed)
                        tried += 1
    assert tried > 1


def test_arms_that_are_swapped_and_one_that_moves_unasked_are_found(two_arms):
    world, records = two_arms
    for record in records:
        for k in range(len(record["witness"]["moments"])):
            changed, moments, _ = _changed(record)
            acting = moments[k]["robot"]
            other = next(iter(moments[k]["others"]))
            moments[k]["robot"], moments[k]["others"] = other, {acting: moments[k]["others"][other]}
            assert _found(world, changed), k
            changed, moments, _ = _changed(record)
            moments[k]["others"][other]["joints"][0] += 0.01
            assert "does not end where the next state begins" in "".join(_found(world, changed))
        for k, motion in enumerate(record["witness"]["motions"]):
            changed, _, motions = _changed(record)
            for waypoint in motions[k]:
                waypoint["robot"] = {"left": "right", "right": "left"}[waypoint["robot"]]
            assert _found(world, changed), record["actions"][k]
            assert len(motion) > 0


def test_arms_and_what_they_hold_that_meet_are_found(two_arms):
    world, (record, _) = two_arms
    give = 3
    changed, moments, _ = _changed(record)
    moments[give]["others"]["left" if moments[give]["robot"] == "right" else "right"]["joints"] = _mirrored(
        moments[give]
    )
    found = "".join(_found(world, changed))
    assert "the arm is in that of" in found or "the arm is in bar_1" in found


def _mirrored(moment):
    """Return joints that bring the other arm to where this one is: turned by the angle between their bases."""
    joints = list(moment["joints"])
    joints[0] += 0.9 if moment["robot"] == "right" else -0.9
    return joints


@pytest.mark.parametrize(("name", "length"), [("kitchen", 5), ("two_arms", 3)])
def test_ways_pass_and_a_dropped_waypoint_or_a_body_in_the_way_is_found(name, length):
    world, (record,) = _records(name, {length: 1}, "transit")
    assert _found(world, record, True) == []
    rng, motions = random.Random(3), record["witness"]["motions"]
    places = [
        (k, i)
        for k, motion in enumerate(motions)
        for i, each in enumerate(motion[:-2])
        if each["name"] == motion[i + 1]["name"] == "transit"
    ]
    for k, i in rng.sample(places, 4):
        changed, _, copied = _changed(record)
        del copied[k][i]
        assert any("the way leaps" in text for text in _found(world, changed, True)), (k, i)
    k, i = next((k, i) for k, i in places[len(places) // 3 :] if motions[k][i]["held"] is None)
    changed, moments, _ = _changed(record)
    waypoint = motions[k][i]
    tool = world.robots[world.robot(waypoint.get("robot", ""))].tool(tuple(waypoint["joints"]))
    body = next(iter(_loose(world, moments[0])), None)
    if body is not None:
        for moment in moments:
            moment["poses"][body][0] = tool.at.tolist()
        assert any(f"transit: the arm is in {body}" in text for text in _found(world, changed, True))


def test_the_kuka_is_checked_as_well_and_beside_a_panda():
    domain = load_domain("two_arms")
    scene = load_scene(domain)
    mounts = {"left": Mount("panda", 0.0, 0.36, 0.0), "right": Mount("kuka", -0.1, -0.40, 0.0)}
    world, records = _records("two_arms", {3: 2, 4: 2}, scene=replace(scene, robots=mounts))
    for record in records:
        assert _found(world, record) == []
        for k, moment in enumerate(record["witness"]["moments"]):
            changed, moments, _ = _changed(record)
            arms_of(moments[k])["right"]["joints"][1] = 2.0
            assert any("is in" in text for text in _found(world, changed)), moment["robot"]
