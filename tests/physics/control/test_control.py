"""Control conventions: scales, and conversions that PyBullet's own arithmetic confirms."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pybullet
import pytest

from prag_asp import load_domain
from prag_asp.dataset.scenes import scene_of
from prag_asp.errors import QueryError
from prag_asp.physics.control.arm_motors import ArmMotors
from prag_asp.physics.control.control import FARTHEST, Control
from prag_asp.physics.control.names import CONTROLS, RECORDED, ControlName
from prag_asp.physics.control.recorded_actions import recorded_actions, recorded_states, state_names
from prag_asp.physics.control.tool_poses import rotation, rotation_vector
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.dynamics import ArmCommand
from prag_asp.scene.robots import ROBOTS, robot_of
from prag_asp.scene.scene import Scene
from tests.chance import Chance


@pytest.fixture(scope="module")
def scenes() -> Mapping[str, Scene]:
    return {name: scene_of(load_domain(name)) for name in ("tabletop", "two_arms")}


def commands_of(scene: Scene, chance: Chance, count: int) -> np.ndarray:
    """Return slow random motions around the home of each robot, with openings, shape (count, R, 8)."""
    rng = np.random.default_rng(chance.seed(1))
    robots = [robot_of(scene, name) for name in scene.robots]
    start = np.array([[*robot.posture, robot.opening / 2] for robot in robots])
    steps = rng.uniform(-1.0, 1.0, (count, len(robots), 8)) * [*(0.03,) * 7, 0.002]
    return start + np.cumsum(steps, axis=0)


@pytest.mark.parametrize("name", ["tabletop", "two_arms"])
@pytest.mark.parametrize("control", RECORDED)
@pytest.mark.parametrize("rate", [5, 20])
def test_motors_that_follow_the_actions_of_commands_end_where_the_commands_do(
    name: str, control: ControlName, rate: int, chance: Chance, scenes: Mapping[str, Scene]
) -> None:
    scene = scenes[name]
    convention, commands = Control.of(control, scene, rate), commands_of(scene, chance, 12)
    actions = recorded_actions(convention, scene, commands)
    assert actions.shape == (11, len(convention.names))
    assert (actions >= convention.low).all() and (actions <= convention.high).all()
    for i, each in enumerate(scene.robots):
        robot = robot_of(scene, each)
        first = commands[0, i].tolist()
        motors = ArmMotors(robot, convention, ArmCommand(tuple(first[:7]), first[7]))
        for action, row in zip(actions.astype(np.float32), commands[1:, i], strict=True):
            own = convention.values(action.astype(float)).reshape(len(scene.robots), -1)[i]
            motors.follow(own, Arm(motors.command.joints, motors.command.opening))
            assert motors.command.opening == pytest.approx(row[7], abs=1e-6)
            if control.startswith("joint"):
                assert motors.command.joints == pytest.approx(row[:7].tolist(), abs=1e-6)
            reached, wanted = tool_pose(robot, motors.command.joints), tool_pose(robot, tuple(row[:7].tolist()))
            assert reached.position == pytest.approx(wanted.position, abs=1e-4)
            assert abs(np.dot(reached.quaternion, wanted.quaternion)) == pytest.approx(1.0, abs=1e-7)


def test_poses_and_motions_are_what_pybullet_says(chance: Chance, scenes: Mapping[str, Scene]) -> None:
    scene = scenes["two_arms"]
    commands = commands_of(scene, chance, 6)
    poses = recorded_actions(Control.of("ee_position", scene), scene, commands).reshape(5, 2, 7)
    control = Control.of("ee_delta", scene)
    motions = control.values(recorded_actions(control, scene, commands)).reshape(5, 2, 7)
    down = pybullet.getQuaternionFromEuler([math.pi, 0.0, 0.0])
    for i, name in enumerate(scene.robots):
        tools = [tool_pose(robot_of(scene, name), tuple(row[i, :7].tolist())) for row in commands]
        for before, tool, pose, motion in zip(tools, tools[1:], poses[:, i], motions[:, i], strict=False):
            assert pose[:3] == pytest.approx(tool.position)
            assert_same_turn(quaternion(pose[3:6]), down, tool.quaternion)
            assert motion[:3] == pytest.approx(np.subtract(tool.position, before.position), abs=1e-9)
            assert_same_turn(quaternion(motion[3:6]), before.quaternion, tool.quaternion)
    assert poses[:, 0, 6] == pytest.approx(commands[1:, 0, 7])


def test_a_gripper_target_inside_the_held_object_is_closed(chance: Chance, scenes: Mapping[str, Scene]) -> None:
    commands = commands_of(scenes["tabletop"], chance, 3)
    commands[1:, 0, 7] = -0.01
    control = Control.of("joint_position", scenes["tabletop"])
    assert control.values(recorded_actions(control, scenes["tabletop"], commands))[:, 7] == pytest.approx([0.0, 0.0])


def quaternion(vector: np.ndarray) -> tuple[float, ...]:
    """Return the quaternion of a rotation vector, by PyBullet."""
    angle = float(np.linalg.norm(vector))
    return tuple(pybullet.getQuaternionFromAxisAngle((vector / angle).tolist(), angle))


def assert_same_turn(after: tuple[float, ...], before: tuple[float, ...], expected: tuple[float, ...]) -> None:
    _, found = pybullet.multiplyTransforms((0, 0, 0), after, (0, 0, 0), before)
    assert abs(np.dot(found, expected)) == pytest.approx(1.0, abs=1e-7)


def test_a_rotation_vector_and_its_matrix_are_inverse_up_to_half_a_turn(chance: Chance) -> None:
    rng = np.random.default_rng(chance.seed(2))
    for length in (0.0, 1e-9, 1e-3, 1.0, 3.0, math.pi - 1e-7):
        axis = rng.normal(size=3)
        vector = length * axis / np.linalg.norm(axis)
        assert rotation_vector(rotation(vector)) == pytest.approx(vector, abs=1e-8)


def test_the_ends_of_a_range_are_one_and_the_middle_is_zero_and_no_tool_is_farther(
    chance: Chance, scenes: Mapping[str, Scene]
) -> None:
    for name in CONTROLS:
        control = Control.of(name, scenes["two_arms"], 10)
        assert len(control.names) == len(control.units) == len(control.lower)
        ends = np.array([control.lower, control.upper])
        assert np.allclose(control.to_unit(ends), [[-1.0], [1.0]])
        assert np.allclose(control.from_unit([[-1.0], [0.0], [1.0]]), [ends[0], ends.mean(axis=0), ends[1]])
        assert np.array_equal(control.actions(ends), [control.low, control.high])
        if not control.convention.absolute:
            arm = [i for i, each in enumerate(control.names) if not each.endswith("gripper")]
            assert control.upper[arm] == pytest.approx(2 * Control.of(name, scenes["two_arms"], 20).upper[arm])
    rng = np.random.default_rng(chance.seed(3))
    for robot in ROBOTS.values():
        for joints in rng.uniform(robot.lower, robot.upper, (200, 7)):
            assert np.abs(tool_pose(robot, tuple(joints.tolist())).position).max() < FARTHEST


def test_states_have_the_numbers_of_their_names_once(chance: Chance, scenes: Mapping[str, Scene]) -> None:
    scene = scenes["two_arms"]
    arms = commands_of(scene, chance, 3)
    names = state_names(["joint_position", "ee_position"], scene)
    assert len(names) == len({*names}) == 2 * (8 + 6) and names[7] == f"{next(iter(scene.robots))}/gripper"
    assert np.array_equal(recorded_states("joint_position", scene, arms), arms.reshape(3, 16))


def test_wrong_names_rates_and_motions_are_refused(chance: Chance, scenes: Mapping[str, Scene]) -> None:
    scene = scenes["tabletop"]
    with pytest.raises(QueryError, match="no control 'ee_detla'; did you mean ee_delta"):
        Control.of("ee_detla", scene)
    for rate in (0, 7, 240, 2.5, True):
        with pytest.raises(QueryError, match="a number of actions per second that divides 120"):
            Control.of("ee_delta", scene, rate)  # type: ignore[arg-type]
    commands = commands_of(scene, chance, 3)
    with pytest.raises(QueryError, match="ee_delta_upright cannot express recordings, in which tools tilt"):
        recorded_actions(Control.of("ee_delta_upright", scene), scene, commands)
    commands[1, 0, 0] += 0.5
    with pytest.raises(QueryError, match="a motion is faster than joint_delta allows"):
        recorded_actions(Control.of("joint_delta", scene), scene, commands)
