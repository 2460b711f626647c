"""Two arms in one scene: how they stand, hand things over, and keep out of each other's way."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.domain.load import load_domain
from prag_asp.errors import SceneError
from prag_asp.physics import (
    Budget,
    Validator,
    Verdict,
    Witness,
    check_witness,
    open_validator,
    settle,
    validate_task,
)
from prag_asp.physics.bullet import pybullet, pybullet_data
from prag_asp.physics.checks.states import tool_in
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.robot.kinematics import adjust_joints, inverse, tool_pose
from prag_asp.physics.search.attempt import Snapshot
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.simulator import open_client, open_simulator
from prag_asp.scene.geometry import Pose, compose, multiply, turn_between, yaw_quaternion
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Mount, Scene, Shape
from prag_asp.scene.scene_loader import parse_scene
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task
from tests.chance import examples
from tests.physics.random_tasks import shipped_scene
from tests.physics.scenarios import GIVE, HANDOVER

DOWN = (1.0, 0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return shipped_scene("two_arms")


@pytest.fixture(scope="module")
def validator(scene: Scene) -> Iterator[Validator]:
    with open_validator(scene) as opened:
        yield opened


@pytest.fixture(scope="module")
def handover() -> Task:
    [task] = TaskSpace(load_domain("two_arms"), len(HANDOVER)).tasks_of_plans([HANDOVER])
    return task


@pytest.fixture(scope="module")
def witness(validator: Validator, handover: Task) -> Witness:
    found = validator.validate(handover, seed=1).witness
    assert found is not None
    return found


def _near(one: Pose, two: Pose, tolerance: float = 1e-5) -> bool:
    near = math.dist(one.position, two.position) < tolerance
    return near and turn_between(one.quaternion, two.quaternion) < 10 * tolerance


mounts = st.builds(Mount, st.sampled_from(["panda", "kuka"]), *[st.floats(-1, 1)] * 2, st.floats(-3, 3))


@settings(max_examples=examples(30))
@given(mount=mounts, heading=st.floats(-1.5, 1.5), yaw=st.floats(-3, 3))
def test_a_robot_reaches_the_same_from_wherever_it_stands(mount, heading, yaw):
    here = robot_of(Scene({}, robots={"arm": mount}), "arm")
    origin = robot_of(Scene({}, robots={"arm": Mount(mount.kind)}), "arm")
    tool = Pose((0.55 * math.cos(heading), 0.55 * math.sin(heading), 0.1), multiply(yaw_quaternion(yaw), DOWN))
    base = Pose((mount.x, mount.y, 0.0), yaw_quaternion(mount.yaw))
    joints = next(inverse(here, compose(base, tool)))
    assert _near(tool_pose(origin, joints), tool)
    assert _near(tool_pose(here, joints), compose(base, tool))
    beside = compose(base, Pose((tool.position[0], tool.position[1] + 0.003, 0.1), tool.quaternion))
    found = adjust_joints(here, beside, joints)
    assert found is not None and _near(tool_pose(here, found), beside, 2e-5)


def test_the_simulator_has_each_robot_where_the_scene_says(scene):
    with open_simulator(scene) as simulator:
        for name, arm in simulator.arms.items():
            arm.pose(arm.robot.home, 0.02)
            simulator.turn_to(name)
            assert _near(tool_in(simulator), tool_pose(arm.robot, arm.robot.home))
            assert arm.robot.base.position == (*scene.robots[name][1:3], 0.0)


def test_an_object_changes_hands_in_the_air(scene, handover, witness):
    before, after = witness.moments[GIVE : GIVE + 2]
    assert [before.arms[name].held for name in ("left", "right")] == ["bar_1", None]
    assert [after.arms[name].held for name in ("left", "right")] == [None, "bar_1"]
    assert before.poses["bar_1"] == after.poses["bar_1"] and before.poses["bar_1"].position[2] > 0.1
    [taking] = [waypoint for waypoint in witness.motions[GIVE] if waypoint.held == "bar_1"]
    assert taking.robot == "right"
    giver, taker = (
        tool_pose(robot_of(scene, robot), joints).position[:2]
        for robot, joints in (("left", before.arms["left"].joints), ("right", taking.joints))
    )
    assert 0.12 < math.dist(giver, taker) < scene.shapes["bar_1"].size[0]
    opened = [waypoint.width for waypoint in witness.motions[GIVE] if waypoint.robot == "left"]
    assert set(opened) == {robot_of(scene, "left").opening}


def test_a_witness_of_two_arms_passes_the_check_settles_and_comes_back_from_json(scene, validator, handover, witness):
    assert check_witness(handover, witness, scene) == []
    assert settle(handover, witness, scene) is None
    verdict = validator.validate(handover, seed=1)
    assert Verdict.from_json(verdict.to_json()) == verdict and verdict.witness == witness
    assert Witness.from_json(witness.to_json()) == witness


def _two_pandas(scene: Scene, client: int) -> dict[str, Callable[[Arm], int]]:
    """Load two arms without the simulator of the validator; each function puts one somewhere and returns its body."""
    path = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"

    def placed(body: int, arm: Arm) -> int:
        for joint, angle in zip((*range(7), 9, 10), (*arm.joints, arm.width / 2, arm.width / 2), strict=True):
            pybullet.resetJointState(body, joint, angle, physicsClientId=client)
        return body

    found = {}
    for name, (_, x, y, yaw) in scene.robots.items():
        at = pybullet.getQuaternionFromEuler((0.0, 0.0, yaw))
        body = pybullet.loadURDF(str(path), (x, y, 0.0), at, useFixedBase=True, physicsClientId=client)
        found[name] = partial(placed, body)
    return found


def test_the_arms_keep_a_centimetre_apart_in_every_state_and_at_every_waypoint(scene, validator, chance):
    tasks = TaskSpace(load_domain("two_arms"), 7).sample(5, seed=chance.seed(2), weights={"give": 50})
    assert any("give" in task.skeleton for task in tasks)
    with open_client() as client:
        place = _two_pandas(scene, client)
        for index, task in enumerate(tasks):
            witness = validator.validate(task, seed=chance.seed(8), index=index).witness
            assert witness is not None
            arms = dict(witness.moments[0].arms)
            for moment, motion in zip(witness.moments[1:], witness.motions, strict=True):
                for waypoint in motion:
                    arms[waypoint.robot] = Arm(waypoint.joints, waypoint.width)
                    one, two = (place[name](arm) for name, arm in arms.items())
                    assert not pybullet.getClosestPoints(one, two, 0.0099, physicsClientId=client)
                assert all(
                    (arms[name].joints, arms[name].width) == (a.joints, a.width) for name, a in moment.arms.items()
                )


def test_random_tasks_of_two_arms_are_feasible(scene, validator, chance):
    for length in (2, 8):
        tasks = TaskSpace(load_domain("two_arms"), length).sample(3, seed=chance.seed(length))
        for index, task in enumerate(tasks):
            verdict = validator.validate(task, seed=chance.seed(3), index=index, budget=Budget(tier="settling"))
            assert verdict.witness is not None, verdict.causes
            assert check_witness(task, verdict.witness, scene) == []


def test_arms_that_meet_move_unseen_or_are_missing_are_reported(scene, handover, witness):
    def found(k: int, **arms: Arm) -> str:
        moments = list(witness.moments)
        moments[k] = replace(moments[k], arms=arms)
        return "\n".join(check_witness(handover, replace(witness, moments=tuple(moments)), scene))

    # The right arm reaches for the tool of the left one.
    left = witness.moments[2].arms["left"]
    there = next(inverse(robot_of(scene, "right"), tool_pose(robot_of(scene, "left"), left.joints)))
    meeting = found(2, left=left, right=Arm(there, 0.08))
    assert "state 2: the arm collides with" in meeting
    assert "its last waypoint differs from the arm in the next state" in meeting
    left, right = witness.moments[0].arms.values()
    assert found(0, left=left, right=replace(right, joints=(right.joints[0] + 0.1, *right.joints[1:])))
    assert "state 0: it has the arms of left; the scene has those of left, right" in found(0, left=left)
    stranger = tuple(replace(waypoint, robot="middle_arm") for waypoint in witness.motions[0])
    motions = (stranger, *witness.motions[1:])
    problems = check_witness(handover, replace(witness, motions=motions), scene)
    assert any("there is no robot middle_arm" in text for text in problems)


def test_a_cube_is_too_short_for_two_hands(scene, handover):
    shapes = {**scene.shapes, "bar_1": Shape("box", (0.05, 0.05, 0.05))}
    assert validate_task(handover, replace(scene, shapes=shapes), seed=1, budget=Budget(2, 6)).status == "not_found"


def test_which_arm_an_action_moves_is_read_off_its_facts(scene, handover):
    seen = physical_task(handover, scene)
    assert [effect.robot for effect in seen.effects] == ["left", "left", "right", "right", "left", "right", "right"]
    assert [effect.giver for effect in seen.effects] == [None, None, None, "left", None, None, None]
    assert [effect.over for effect in seen.effects if effect.over] == ["middle", "middle", "left_side", "right_side"]
    assert seen.effects[GIVE].grasps == "bar_1" and seen.effects[-1].releases == "bar_1"


def test_turning_to_the_other_arm_and_back_changes_nothing(scene):
    robot, other = robot_of(scene, "left"), robot_of(scene, "right")
    arms = {"left": Arm(robot.home, 0.08), "right": Arm(other.home, 0.03, "bar_1", Pose((0.0, 0.0, 0.1)))}
    snapshot = Snapshot(Situation(scene, {}, arms), "left").with_arm(Arm(robot.posture, 0.08), robot.home)
    turned = snapshot.turned_to("right")
    assert (turned.arm, turned.tool, turned.above) == (arms["right"], tool_pose(other, other.home), None)
    assert turned.situation.tool("left") == tool_pose(robot, robot.posture)
    assert turned.turned_to("left") == snapshot == snapshot.turned_to(None) == snapshot.turned_to("left")
    assert turned.with_arm(Arm(other.posture, 0.0), other.home).turned_to("left").above == robot.home
    assert snapshot.with_arm(Arm(robot.home, 0.08)).above is None


@pytest.mark.parametrize(
    ("x", "y", "z", "expected"),
    [
        (0.48, 0.42, 0.2, 0.0),
        (0.64, 0.59, 0.01, 0.0),
        (0.67, 0.42, 0.2, 0.02),
        (0.48, 0.20, 0.2, 0.04),
        (0.48, 0.42, -0.03, 0.03),
    ],
)
def test_a_gripper_is_over_a_zone_where_its_tool_is(scene, x, y, z, expected):
    situation = Situation(scene, {}, tools={"left": Pose((x, y, z), DOWN)})
    assert PREDICATES["over"].distance(situation, ("left", "left_side")) == pytest.approx(expected, abs=1e-9)


ENTITIES = {"left": "arm", "right": "arm", "cube_1": "cube", "shelf": "zone"}
CUBE = {"kind": "box", "size": [0.05, 0.05, 0.05]}
ROBOTS = {"left": {"base": [0.0, 0.4, 0]}, "right": {"kind": "kuka", "base": [0.0, -0.4, 90]}}
TABLE = {
    "shapes": {"arm": {"kind": "robot"}, "cube": CUBE, "zone": {"kind": "zone", "size": [0.2, 0.3]}},
    "robots": ROBOTS,
    "fixed": {"shelf": [0.5, 0.0]},
}
CLASSES = {"arm": (), "cube": (), "zone": ()}


def test_robots_and_zones_are_read():
    read = parse_scene(TABLE, CLASSES, ENTITIES)
    assert read.robots == {"left": Mount("panda", 0.0, 0.4, 0.0), "right": Mount("kuka", 0.0, -0.4, math.pi / 2)}
    assert read.shapes["shelf"] == Shape("zone", (0.2, 0.3, 0.0)) and read.fixed["shelf"] == (0.5, 0.0, 0.0)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("robots", {}, "scene.robots.left: missing; write { base = [x, y, yaw] }, in metres and degrees"),
        ("robots", {"left": ROBOTS["left"]}, "scene.robots.right: missing"),
        ("robots", {**ROBOTS, "cube_1": {}}, "scene.robots.cube_1: is not an entity with the shape of a robot"),
        ("robots", {**ROBOTS, "left": 3}, "scene.robots.left: needs a table like"),
        ("robots", {**ROBOTS, "left": {"bass": []}}, "scene.robots.left.bass: unknown key; did you mean base?"),
        ("robots", {**ROBOTS, "left": {"kind": "robby"}}, "scene.robots.left.kind: needs one of panda, kuka"),
        ("robots", {**ROBOTS, "left": {"base": [0, 1]}}, "scene.robots.left.base: needs x and y in metres and a yaw"),
        ("robots", {**ROBOTS, "left": {"base": [0, 9, 0]}}, "scene.robots.left.base: is more than 2 m"),
        ("robots", {**ROBOTS, "left": {"base": [0, -0.3, 0]}}, "scene.robots.right.base: is 0.1 m from that of left"),
        ("fixed", {}, "scene.fixed.shelf: missing; write x and y in metres"),
    ],
)
def test_a_malformed_table_of_robots_is_refused_with_its_key(key, value, message):
    with pytest.raises(SceneError) as caught:
        parse_scene({**TABLE, key: value}, CLASSES, ENTITIES)
    assert str(caught.value).startswith(message)
