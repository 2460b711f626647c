from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.domain.load import load_domain
from prag_asp.physics import check_witness, open_validator
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.checks.states import tool_in
from prag_asp.physics.robot.kinematics import adjust_joints, inverse, tool_pose
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.geometry import Pose, compose, multiply, turn_between, yaw_quaternion
from prag_asp.scene.robots import ROBOTS, Joints, Robot
from prag_asp.scene.scene import Mount
from prag_asp.space.task_space import TaskSpace
from tests.chance import examples
from tests.physics.random_tasks import shipped_scene

DOWN = (1.0, 0.0, 0.0, 0.0)
NAMES = sorted(ROBOTS)

robots = pytest.mark.parametrize("name", NAMES)


@pytest.fixture(scope="module")
def simulators() -> Iterator[dict[str, Simulator]]:
    scene = shipped_scene("tabletop")
    kuka_scene = replace(scene, robots={"panda": Mount("kuka")})
    with open_simulator(scene) as panda, open_simulator(kuka_scene) as kuka:
        yield {"panda": panda, "kuka": kuka}


def _random_joints(robot: Robot, shares: tuple[float, ...]) -> Joints:
    """Return joint angles at shares of their ranges."""
    return tuple(low + share * (high - low) for low, share, high in zip(robot.lower, shares, robot.upper, strict=True))


def _near(one: Pose, two: Pose, tolerance: float) -> bool:
    apart = math.dist(one.position, two.position)
    return apart < tolerance and turn_between(one.quaternion, two.quaternion) < 10 * tolerance


def _from_above(radius: float, heading: float, height: float, yaw: float) -> Pose:
    """Return a tool pose that points down, at a distance and a heading from the base."""
    at = (radius * math.cos(heading), radius * math.sin(heading), height)
    return Pose(at, multiply(yaw_quaternion(yaw), DOWN))


shares = st.tuples(*[st.floats(0.01, 0.99)] * 7)


@robots
@settings(max_examples=examples(50))
@given(shares=shares)
def test_forward_kinematics_is_that_of_the_simulator(simulators, name, shares):
    simulator, robot = simulators[name], ROBOTS[name]
    joints = _random_joints(robot, shares)
    simulator.pose_arm(joints, 0.04)
    assert _near(tool_in(simulator), tool_pose(robot, joints), 2e-6)


@robots
@settings(max_examples=examples(60))
@given(shares=shares)
def test_inverse_kinematics_finds_a_pose_that_the_arm_can_take(name, shares):
    robot = ROBOTS[name]
    wanted = tool_pose(robot, _random_joints(robot, shares))
    found = list(inverse(robot, wanted, near=_random_joints(robot, shares)))
    assert found
    for joints in found:
        assert robot.within_limits(joints)
        assert _near(tool_pose(robot, joints), wanted, 1e-5)


@robots
@settings(max_examples=examples(60))
@given(
    share=st.floats(0.0, 1.0),
    heading=st.floats(-math.pi / 2, math.pi / 2),
    height=st.floats(0.0, 0.2),
    yaw=st.floats(-math.pi, math.pi),
)
def test_the_gripper_gets_everywhere_in_the_ring_of_reach_however_it_is_turned(name, share, heading, height, yaw):
    robot = ROBOTS[name]
    radius = robot.reach[0] + share * (robot.reach[1] - robot.reach[0])
    tool = _from_above(radius, heading, height, yaw)
    joints = next(inverse(robot, tool), None)
    assert joints is not None and _near(tool_pose(robot, joints), tool, 1e-5)


@robots
@pytest.mark.parametrize("radius", [0.05, 0.95])
def test_nothing_is_found_where_the_arm_cannot_reach(name, radius):
    for yaw in np.linspace(-3.0, 3.0, 7).tolist():
        assert list(inverse(ROBOTS[name], _from_above(radius, 0.3, 0.02, yaw))) == []


@robots
def test_a_pose_next_to_another_is_found_next_to_its_joints(name):
    robot = ROBOTS[name]
    start = next(inverse(robot, _from_above(0.5, 0.2, 0.1, 0.7)))
    wanted = compose(tool_pose(robot, start), Pose((0.004, -0.003, 0.002), yaw_quaternion(0.05)))
    found = adjust_joints(robot, wanted, start)
    assert found is not None and _near(tool_pose(robot, found), wanted, 2e-5)
    assert max(abs(a - b) for a, b in zip(found, start, strict=True)) < 0.2


@robots
def test_the_fingers_move_apart_along_the_tools_y_axis_as_the_opening_says(simulators, name):
    simulator, robot = simulators[name], ROBOTS[name]
    gaps = []
    for width in (0.0, 0.03, robot.opening):
        boxes = dict(zip(robot.links, simulator.arm.link_boxes(robot.home, width), strict=True))
        left, right = sorted((boxes[link] for link in robot.finger_links), key=lambda box: -box[0][1])
        assert left[0][1] + right[1][1] == pytest.approx(0.0, abs=1e-4)
        gaps.append(left[0][1] - right[1][1])
    assert gaps[1] - gaps[0] == pytest.approx(0.03, abs=1e-4)
    assert gaps[2] - gaps[0] == pytest.approx(robot.opening, abs=1e-4)


@robots
def test_the_bounding_boxes_of_the_fingers_are_known_at_every_opening(simulators, name, chance):
    simulator, robot = simulators[name], ROBOTS[name]
    rng = np.random.default_rng(chance.seed(1))
    for row in rng.uniform(robot.lower, robot.upper, size=(chance.examples(20), 7)).tolist():
        for width in (0.02, robot.opening, 0.0):
            known = simulator.arm.link_boxes(tuple(row), width)
            simulator.pose_arm(robot.home, 0.0)
            simulator.pose_arm(tuple(row), width)
            read = [pybullet.getAABB(simulator.arm.body, link, simulator.client) for link in robot.links]
            assert np.array(known) == pytest.approx(np.array(read), abs=1e-9)


@robots
def test_the_arm_meets_neither_itself_nor_the_table_where_it_waits(simulators, name):
    simulator, robot = simulators[name], ROBOTS[name]
    assert robot.within_limits(robot.home) and robot.within_limits(robot.posture)
    simulator.pose_arm(robot.home, robot.opening)
    assert simulator.arm.self_overlap(robot.home, robot.opening) == 0.0
    assert {link for link, _ in simulator.arm.contacts(simulator.table, robot.links)} <= {-1}
    assert turn_between(tool_pose(robot, robot.home).quaternion, DOWN) < 1e-6


def test_the_limits_of_the_kukas_joints_are_those_of_its_file(simulators):
    simulator, robot = simulators["kuka"], ROBOTS["kuka"]
    for link, low, high in zip(robot.arm_links, robot.lower, robot.upper, strict=True):
        info = pybullet.getJointInfo(simulator.arm.body, link, physicsClientId=simulator.client)
        assert (info[8], info[9]) == pytest.approx((low, high), abs=1e-6)


def test_the_kuka_does_tasks_of_shipped_domains_and_its_witnesses_pass():
    scene = replace(shipped_scene("tabletop"), robots={"panda": Mount("kuka")})
    tasks = TaskSpace(load_domain("tabletop"), 3).sample(4, seed=5)
    with open_validator(scene) as validator:
        verdicts = [validator.validate(task, seed=1, index=i) for i, task in enumerate(tasks)]
        assert sum(verdict.feasible for verdict in verdicts) >= 3
        for task, verdict in zip(tasks, verdicts, strict=True):
            if verdict.witness is not None:
                assert check_witness(task, verdict.witness, scene) == []
