from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from itertools import islice

import pybullet
import pytest

from prag_asp.errors import QueryError, SceneError
from prag_asp.physics import CAUSES, Budget, Verdict, Witness, check_witness, open_validator, validate_task
from prag_asp.physics.robot.kinematics import inverse, tool_pose
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import Pose, compose, invert
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Shape
from tests.physics.random_tasks import random_tasks
from tests.physics.scenarios import carrying, stacking, state, task


def test_a_cube_can_be_stacked_on_a_brick_and_nothing_else_moves(tabletop, tabletop_validator):
    verdict = tabletop_validator.validate(stacking(), seed=1)
    assert verdict.feasible
    assert verdict.witness.moments[1].held == {"cube_1"}
    names = [[waypoint.name for waypoint in motion] for motion in verdict.witness.motions]
    assert names == [["approach", "at", "at", "lift"], ["approach", "at", "at", "retreat"]]
    assert check_witness(stacking(), verdict.witness, tabletop) == []
    first, second, third = (moment.poses for moment in verdict.witness.moments)
    assert first["brick_1"] == second["brick_1"] == third["brick_1"]
    assert first["cube_1"] != second["cube_1"] != third["cube_1"]
    assert {"tray_1", "bin_1"} <= first.keys() & second.keys() & third.keys()


def test_an_apple_can_be_carried_turned_and_dropped(prag, prag_validator):
    verdict = prag_validator.validate(carrying(), seed=1)
    assert verdict.feasible
    assert check_witness(carrying(), verdict.witness, prag) == []
    heights = [moment.poses["apple_1"].position[2] for moment in verdict.witness.moments]
    assert heights[2] == pytest.approx(0.034) and heights[3] > 0.1
    assert heights[5] == heights[6] == pytest.approx(0.04)


def test_a_held_object_at_the_start_is_in_the_gripper(prag, prag_validator):
    dropping = task(
        state("holding(panda,can_1)", "at(panda,can_1)", "-open(panda)"),
        ("drop(panda,can_1)", state("-holding(panda,can_1)", "open(panda)")),
    )
    verdict = prag_validator.validate(dropping, seed=1)
    assert verdict.feasible and verdict.witness.moments[0].held == {"can_1"}
    assert verdict.witness.moments[0].poses == verdict.witness.moments[1].poses
    assert check_witness(dropping, verdict.witness, prag) == []


def test_an_object_that_stands_on_nothing_at_the_start_is_held_in_the_air(tabletop, tabletop_validator):
    nowhere = state(
        *(f"-on_top(cube_1,{support})" for support in ("table_1", "cube_2", "brick_1", "brick_2")),
        *(f"-inside(cube_1,{container})" for container in ("tray_1", "bin_1")),
    )
    placing = task(
        {**state("holding(panda,cube_1)"), **nowhere},
        ("insert(panda,cube_1,tray_1)", state("-holding(panda,cube_1)", "inside(cube_1,tray_1)")),
    )
    verdict = tabletop_validator.validate(placing, seed=1)
    assert verdict.feasible and verdict.witness.moments[0].poses["cube_1"].position[2] > 0.1
    assert check_witness(placing, verdict.witness, tabletop) == []


def test_what_never_moves_is_an_obstacle_even_if_a_task_does_not_name_it(tabletop):
    crowded = replace(tabletop, fixed={**tabletop.fixed, "brick_2": (0.47, 0.0, 0.0)})
    crowded = replace(crowded, shapes={**tabletop.shapes, "brick_2": Shape("box", (0.60, 0.90, 0.30))})
    assert not validate_task(stacking(), crowded, seed=1, budget=Budget(2, 5)).feasible


def test_what_stands_on_a_carried_object_is_carried_along(tabletop, tabletop_validator):
    lifting = task(
        state("on_top(cube_1,brick_1)", "on_top(brick_1,table_1)"),
        ("pick(panda,brick_1,table_1)", state("holding(panda,brick_1)", "-on_top(brick_1,table_1)")),
    )
    verdict = tabletop_validator.validate(lifting, seed=0, budget=Budget(50, 10))
    assert verdict.feasible and check_witness(lifting, verdict.witness, tabletop) == []
    # The palm has room between the fingers for a cube at an end of the brick only.
    assert verdict.causes["the arm collides"] > 0
    first, second = verdict.witness.moments
    before, after = (compose(invert(moment.poses["brick_1"]), moment.poses["cube_1"]) for moment in (first, second))
    assert before.position == pytest.approx(after.position, abs=1e-6)
    assert second.poses["cube_1"].position[2] > first.poses["cube_1"].position[2] + 0.09


LARGE = {"brick_1": Shape("box", (0.3, 0.3, 0.3))}
IN_BIN = ["inside(brick_1,bin_1)", "inside(brick_2,bin_1)", "inside(cube_1,bin_1)", "inside(cube_2,bin_1)"]


@pytest.mark.parametrize(
    ("shapes", "initial", "result", "reason"),
    [
        ({"cube_1": Shape("box", (0.09,) * 3)}, ["-holding(panda,cube_1)"], ["holding(panda,cube_1)"],
         "cube 1 is 90 mm wide, but the gripper opens only to 80 mm"),
        ({"brick_1": Shape("box", (0.4, 0.07, 0.3))}, [], ["inside(brick_1,bin_1)"], None),
        ({"brick_1": Shape("box", (0.4, 0.3, 0.3))}, [], ["inside(brick_1,bin_1)"],
         "brick 1 is larger than the cavity of bin 1"),
        ({}, [], ["inside(cube_1,brick_1)"], "brick 1 is not a container"),
        ({}, ["left_of(cube_1,cube_2)", "left_of(cube_2,can_1)"], ["right_of(cube_1,can_1)"],
         "the relations along y form a cycle"),
        ({}, ["behind(cube_1,cube_2)"], ["in_front_of(cube_1,cube_2)"], "along x form a cycle"),
        ({}, ["on_top(cube_1,cube_2)"], ["on_top(cube_2,cube_1)"], "along z form a cycle"),
        ({"cube_2": Shape("sphere", (0.05,) * 3)}, [], ["on_top(cube_1,cube_2)"], "which is a ball"),
        ({}, ["holding(panda,cube_1)"], ["holding(panda,cube_2)"], "the gripper cannot hold cube 1 and cube 2 at once"),
        ({}, [], ["left_of(tray_1,bin_1)"], "because none of these bodies can move"),
        ({}, ["left_of(can_1,bin_1)", "right_of(can_1,tray_1)"], ["on_top(cube_1,table_1)"],
         "there is no room along y for the row tray 1, can 1, bin 1"),
        (LARGE, ["right_of(brick_1,tray_1)"], ["right_of(can_1,brick_1)", "reachable(panda,can_1)"],
         "there is no room along y for the row tray 1, brick 1, can 1"),
        (LARGE, ["right_of(brick_1,tray_1)"], ["right_of(can_1,brick_1)", "on_top(can_1,table_1)"], None),
    ],
)  # fmt: skip
def test_impossible_tasks_are_proved_infeasible_and_others_never(tabletop, shapes, initial, result, reason):
    scene = replace(tabletop, shapes={**tabletop.shapes, **shapes})
    made = task(state(*initial), ("x(panda)", state(*result)))
    verdict = validate_task(made, scene, seed=0, budget=Budget(2, 2))
    if reason is None:
        assert verdict.status == "not_found"
    else:
        assert (verdict.status, verdict.witness) == ("infeasible", None)
        assert reason in verdict.reason


@pytest.mark.parametrize(
    ("initial", "result", "cause"),
    [
        ([], "holding(panda,cube_1)", "no arm configuration at the object"),
        (["behind(brick_1,bin_1)", "behind(brick_2,brick_1)", "behind(can_1,brick_2)"], "on_top(cube_1,table_1)",
         "no room where the relations require the object"),
        (IN_BIN, "inside(can_1,bin_1)", "objects collide"),
    ],
)  # fmt: skip
def test_what_is_not_found_says_why(tabletop, initial, result, cause):
    scene = replace(
        tabletop,
        frame="robot",
        shapes={**tabletop.shapes, "bin_1": Shape("container", (0.17, 0.17, 0.06), 0.006)},
        fixed={**tabletop.fixed, "cube_1": (0.9, 0.3, 0.0)} if not initial else tabletop.fixed,
    )
    made = task(state(*initial), ("x(panda)", state(result)))
    verdict = validate_task(made, scene, seed=0, budget=Budget(3, 5))
    assert verdict.status == "not_found"
    assert verdict.reason == cause and verdict.causes[cause] > 0
    assert set(verdict.causes) <= set(CAUSES)


def test_a_relation_that_does_not_hold_is_named_with_its_entities(tabletop, tabletop_validator):
    apart = task(state("on_top(cube_1,brick_1)", "-near(cube_1,brick_1)"))
    verdict = tabletop_validator.validate(apart, seed=0, budget=Budget(3, 5))
    assert (verdict.status, verdict.reason) == ("not_found", "a relation of the state does not hold")
    (detail,) = [each for each in verdict.details if each.cause == verdict.reason]
    assert (detail.fact, detail.value, detail.entities) == ("near(cube_1,brick_1)", False, ("cube_1", "brick_1"))
    assert verdict.detail == detail.text == "cube 1 is not near brick 1"
    assert detail.attempts == verdict.causes[verdict.reason] == 15


def test_details_of_failed_attempts_name_bodies_and_robots_of_the_scene(tabletop, tabletop_validator, chance):
    seen: Counter[str] = Counter()
    for index, made in enumerate(islice(random_tasks("tabletop", 5, chance.seed(12)), chance.examples(12))):
        verdict = tabletop_validator.validate(made, seed=chance.seed(4), index=index, budget=Budget(2, 2))
        attempts: Counter[str] = Counter()
        for detail in verdict.details:
            assert detail.cause in verdict.causes and str(detail)
            assert {*detail.entities} <= {*tabletop.shapes}
            assert (detail.value is None) == (detail.fact == "")
            attempts[detail.cause] += detail.attempts
        assert all(number <= verdict.causes[cause] for cause, number in attempts.items())
        assert len(verdict.details) <= 8
        seen.update(attempts)
    assert len(seen) >= 2


@pytest.mark.parametrize("name", ["tabletop", "prag"])
def test_random_tasks_of_the_shipped_domains_have_witnesses_that_pass(request, name, chance):
    scene, validator = request.getfixturevalue(name), request.getfixturevalue(f"{name}_validator")
    outcomes: Counter[str] = Counter()
    for length in (3, 6):
        for index, made in enumerate(islice(random_tasks(name, length, chance.seed(11)), chance.examples(10))):
            verdict = validator.validate(made, seed=chance.seed(4), index=index)
            outcomes[verdict.status] += 1
            assert verdict.status != "infeasible"
            if verdict.feasible:
                assert check_witness(made, verdict.witness, scene) == []
    assert outcomes["feasible"] >= 0.9 * outcomes.total()


def test_a_verdict_depends_on_the_seed_and_the_index_alone(tabletop, tabletop_validator):
    made = stacking()
    first = tabletop_validator.validate(made, seed=5, index=3)
    tabletop_validator.validate(made, seed=6, index=3)
    assert tabletop_validator.validate(made, seed=5, index=3) == first
    assert validate_task(made, tabletop, seed=5, index=3) == first
    assert tabletop_validator.validate(made, seed=5, index=4).witness != first.witness


def test_a_verdict_with_and_without_details_comes_back_from_json(tabletop_validator):
    apart = task(state("on_top(cube_1,brick_1)", "-near(cube_1,brick_1)"))
    failed = tabletop_validator.validate(apart, seed=0, budget=Budget(1, 2))
    for verdict in (tabletop_validator.validate(stacking(), seed=1), failed):
        assert Verdict.from_json(json.loads(json.dumps(verdict.to_json()))) == verdict
    data = failed.to_json()
    assert [{*each} for each in data["details"]] == [{"cause", "text", "fact", "value", "entities", "attempts"}]
    before = {name: value for name, value in data.items() if name != "details"}
    read = Verdict.from_json(before)
    assert read.details == () and read.detail == "" and read.to_json() == before


def test_broken_json_of_a_verdict_is_refused(tabletop_validator):
    data = tabletop_validator.validate(stacking(), seed=1).to_json()
    for broken, message in (
        ({**data, "status": "maybe"}, "status: needs one of feasible, not_found, infeasible; got 'maybe'"),
        ({**data, "status": 3}, "status: needs a string; got 3"),
        ({**data, "seed": -1}, "seed: needs a whole number from 0; got -1"),
        ({**data, "index": True}, "index: needs a whole number from 0; got true"),
        ({**data, "causes": {"a": 1, "b": 0.5}}, "causes.b: needs a whole number from 0; got 0.5"),
        ({**data, "witness": {**data["witness"], "moments": 3}}, "witness.moments: needs a list; got 3"),
        ({**data, "budget": {}}, "budget.restarts: is missing"),
        (
            {**data, "budget": {**data["budget"], "tier": "dreams"}},
            "budget.tier: needs one of kinematics, settling, transit, demonstration; got 'dreams'",
        ),
        ({**data, "details": [{"cause": "a"}]}, "details[0].text: is missing"),
        ({}, "status: is missing"),
    ):
        with pytest.raises(QueryError) as caught:
            Verdict.from_json(broken)
        assert str(caught.value) == f"verdict.{message}"
    pose = {"version": 2, "moments": [{"poses": {"a": [[1, 2], [3]]}, "arms": {}}], "motions": []}
    with pytest.raises(QueryError, match=r"^witness\.moments\[0\]\.poses\.a\[0\]: needs a list of 3; got \[1, 2\]$"):
        Witness.from_json(pose)


def test_a_budget_of_nothing_is_refused():
    with pytest.raises(QueryError, match="at least 1 restart"):
        Budget(0, 3)


def test_a_task_about_a_body_without_a_shape_is_an_error(tabletop):
    unknown = task(state("on_top(apple_1,table_1)"), ("x(panda)", state("-on_top(apple_1,table_1)")))
    with (
        open_validator(tabletop) as validator,
        pytest.raises(SceneError, match=r"apple_1, which has no entry under \[scene.shapes\]"),
    ):
        validator.validate(unknown, seed=0)


def test_inverse_kinematics_is_exact_and_within_limits_or_empty():
    down = (1.0, 0.0, 0.0, 0.0)
    solutions = list(inverse(PANDA, Pose((0.5, 0.2, 0.1), down)))
    assert solutions
    for joints in solutions:
        assert PANDA.within_limits(joints)
        assert tool_pose(PANDA, joints).position == pytest.approx((0.5, 0.2, 0.1), abs=1e-5)
    assert list(inverse(PANDA, Pose((0.95, 0.0, 0.1), down))) == []


def test_poses_that_are_not_finite_never_reach_the_simulator(simulator):
    nan = float("nan")
    for pose in (
        Pose((nan, 0.0, 0.0)),
        Pose((0.5, 0.0, 0.0), (0.0, 0.0, 0.0, nan)),
        Pose((0.5, 0, 0), (0, 0, 0, 2.0)),
    ):
        with pytest.raises(SceneError, match="not a finite position"):
            simulator.place({"cube_1": pose})
    with pytest.raises(SceneError, match="cannot take the joint angles"):
        simulator.pose_arm((nan,) * 7, 0.04)
    with pytest.raises(SceneError, match="ghost has no body"):
        simulator.place({"ghost": Pose((0.5, 0.0, 0.0))})


def test_simulators_are_closed(tabletop):
    with open_simulator(tabletop) as opened:
        assert pybullet.isConnected(opened.client)
    assert not pybullet.isConnected(opened.client)
