"""Find paths of the arm that are free of collisions, with what it holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.motion.trajectory import ACCELERATION, LOADED_ACCELERATION, timed
from prag_asp.physics.robot.kinematics import adjusted, inverse, tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.collisions import arm_collision, colliding
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import riders
from prag_asp.scene.furniture import part_pose
from prag_asp.scene.geometry import Pose, compose, invert, raised, turn_between
from prag_asp.scene.robots import Joints, Robot

HEIGHTS = (0.08, 0.16, 0.24)
STRIDE, LOOK = 0.06, 0.02
"""Radians between the waypoints of a way, and between the places where it is looked at: in 0.06 a hand moves by 5 cm,
and through another hand by 1 cm unseen."""

RUNGS = 4
SWERVE = 0.1
"""How far a joint may be from where it would be if all turned evenly on a straight way, in radians."""

PULL_RUNGS = 6
STRAIGHT = 1e-3


@dataclass(frozen=True)
class Grip:
    """What a gripper holds and how: the pose of the object in the frame of the tool."""

    entity: str
    pose: Pose


@dataclass(frozen=True)
class Load:
    """What moves with the gripper: its opening in metres, and what it holds."""

    width: float
    grip: Grip | None = None

    @property
    def held(self) -> str | None:
        """The object that the gripper holds, None where it is empty."""
        return None if self.grip is None else self.grip.entity

    @property
    def acceleration(self) -> float:
        """How fast the arm may gather speed on its way, in radians a second squared."""
        return ACCELERATION if self.grip is None else LOADED_ACCELERATION


def grip_of(held: str | None, *arms: Arm) -> Grip | None:
    """Return how the first of some states of an arm that hold an object do so, None where none does."""
    for arm in arms:
        if arm.held is not None and arm.held == held and arm.grasp is not None:
            return Grip(arm.held, arm.grasp)
    return None


def vertical(robot: Robot, one: Joints, two: Joints) -> bool:
    """Tell whether the tool is straight above or below where it is with other joint angles, turned the same way."""
    (x, y, _), turn = tool_pose(robot, one)
    (other_x, other_y, _), other_turn = tool_pose(robot, two)
    return max(abs(x - other_x), abs(y - other_y)) < STRAIGHT and turn_between(turn, other_turn) < STRAIGHT


def straight(robot: Robot, start: Joints, goal: Joints) -> list[Joints] | None:
    """Return a path on which the tool moves straight from one pose to another that is turned the same way.

    None where the joints of the arm do not let it follow the line.
    """
    first, last = tool_pose(robot, start), tool_pose(robot, goal)
    path = [start]
    for share in np.linspace(0.0, 1.0, RUNGS + 1)[1:-1].tolist():
        x, y, z = (a + share * (b - a) for a, b in zip(first.position, last.position, strict=True))
        tool = Pose((x, y, z), last.quaternion)
        near = tuple(a + share * (b - a) for a, b in zip(start, goal, strict=True))
        joints = adjusted(robot, tool, near) or next(inverse(robot, tool, near), None)
        if joints is None or max(abs(a - b) for a, b in zip(joints, near, strict=True)) > SWERVE:
            return None
        path.append(joints)
    return [*path, goal]


def pulled(robot: Robot, situation: Situation, furniture: str, grip: Pose, goal: float, start: Joints) -> list[Joints]:
    """Return a path on which the tool follows the handle of furniture from how far it is open to a goal.

    `grip` is the pose of the tool in the frame of the moving part; `goal` is in metres or radians. A pose that the arm
    does not reach is passed over.
    """
    shape, pose, begun = situation.shape(furniture), situation.pose(furniture), situation.opening(furniture)
    path = [start]
    for share in np.linspace(0.0, 1.0, PULL_RUNGS + 1)[1:].tolist():
        part = part_pose(shape, pose, begun + share * (goal - begun))
        joints = adjusted(robot, compose(part, grip), path[-1])
        if joints is not None:
            path.append(joints)
    return path


def free_path(
    simulator: Simulator, situation: Situation, load: Load, start: Joints, goal: Joints, time_step: float
) -> NDArray[np.float64] | None:
    """Return the joint angles of every time step on a free way, shape (steps, 7); None where none is found."""
    for path in _ways(simulator, start, goal):
        angles = timed(path, time_step, load.acceleration, simulator.robot.speed)
        if _free(simulator, situation, load, start, angles):
            return angles
    return None


def checked_path(
    simulator: Simulator, situation: Situation, load: Load, start: Joints, goal: Joints, time_step: float
) -> tuple[Joints, ...] | None:
    """Return joint angles on a free way, each a stride after the last; None where none is found.

    The ends are left out. Straight up and down there is one way only.
    """
    if vertical(simulator.robot, start, goal):
        path = straight(simulator.robot, start, goal)
        if path is None:
            return None
        rungs, carried = tuple(path[1:-1]), _carried(situation, load)
        return rungs if all(_free_at(simulator, situation, load, carried, joints) for joints in rungs) else None
    angles = free_path(simulator, situation, load, start, goal, time_step)
    return None if angles is None else tuple(_strides(start, angles, STRIDE))


def _ways(simulator: Simulator, start: Joints, goal: Joints) -> Iterator[Sequence[Joints]]:
    """Yield paths to try, the shortest first: direct, then over what stands around."""
    yield start, goal
    for height in HEIGHTS:
        over_start, over_goal = _above(simulator, start, height), _above(simulator, goal, height)
        if over_start is not None and over_goal is not None:
            yield start, over_start, over_goal, goal
        if over_start is not None:
            yield start, over_start, goal
        if over_goal is not None:
            yield start, over_goal, goal
    folded = simulator.robot.home[1:]
    yield start, (start[0], *folded), (goal[0], *folded), goal


def _above(simulator: Simulator, joints: Joints, height: float) -> Joints | None:
    """Return joint angles near to others with the tool higher, None where there are none."""
    return next(inverse(simulator.robot, raised(tool_pose(simulator.robot, joints), height), near=joints), None)


def _free(simulator: Simulator, situation: Situation, load: Load, start: Joints, angles: NDArray[np.float64]) -> bool:
    """Tell whether the arm and what it holds meet nothing on the way; both ends are taken to be free."""
    carried = _carried(situation, load)
    return all(_free_at(simulator, situation, load, carried, joints) for joints in _strides(start, angles, LOOK))


def _strides(start: Joints, angles: NDArray[np.float64], stride: float) -> Iterator[Joints]:
    """Yield joint angles of a way, a stride in radians apart, without its ends."""
    before, last = np.array(start), angles[-1]
    for row in angles:
        if np.abs(row - before).max() >= stride:
            if np.abs(row - last).max() < stride / 2:
                return
            before = row
            yield tuple(row.tolist())


def _carried(situation: Situation, load: Load) -> list[str]:
    """Return what moves with the gripper: what it holds, and what rests on that."""
    if load.grip is None:
        return []
    held = load.grip.entity
    return [held, *riders(situation, held, [other for other in situation.poses if other != held])]


def _free_at(simulator: Simulator, situation: Situation, load: Load, carried: Sequence[str], joints: Joints) -> bool:
    """Tell whether the arm and what it carries meet nothing at joint angles."""
    tool = tool_pose(simulator.robot, joints)
    if load.grip is not None:
        delta = compose(compose(tool, load.grip.pose), invert(situation.poses[load.grip.entity]))
        moved = {entity: compose(delta, situation.poses[entity]) for entity in carried}
        situation = situation.with_poses({**situation.poses, **moved})
        if colliding(simulator, situation, carried, list(situation.poses)) is not None:
            return False
    return arm_collision(simulator, situation, joints, load.width, load.held) is None
