"""Express the motor commands and the states in recordings in a control convention."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.physics.control.control import CONVENTIONS, Control, Floats
from prag_asp.physics.control.names import RECORDED, STATES, ControlName
from prag_asp.physics.control.tool_poses import motion_between, vector_of_pose
from prag_asp.scene.geometry import matrix
from prag_asp.scene.robots import Robot, robot_of
from prag_asp.scene.scene import Scene

Numbers = NDArray[np.floating[Any]]

EXCESS = 1e-6
"""The share of its range by which an action may exceed the range because of rounding."""


def recorded_actions(control: Control, scene: Scene, commands: Numbers) -> Floats:
    """Return the actions, in a control convention, that lead from each motor command to the next, shape (N, M).

    `commands` (N + 1, R, 8) holds the joint angles and the opening of each robot; the first row is the command before
    the actions. Each of the N actions has M numbers.

    Raises:
        QueryError: the convention cannot express the commands.
    """
    if control.name not in RECORDED:
        raise QueryError(f"{control.name} cannot express recordings, in which tools tilt; choose ee_delta")
    robots = [robot_of(scene, name) for name in control.robots]
    parts = []
    for number, robot in enumerate(robots):
        rows = commands[:, number].astype(float)
        rows[:, 7] = rows[:, 7].clip(0.0, robot.opening)  # a target inside the held object only adds force
        parts.append(_values(control.name, robot, rows))
    actions = control.actions(np.concatenate(parts, axis=1))
    excess = (np.maximum(control.low - actions, actions - control.high) / (control.high - control.low)).max(initial=0.0)
    if excess > EXCESS:
        raise QueryError(
            f"a motion is faster than {control.name} allows, by {excess:.0%} of its range; choose another control"
        )
    result: Floats = np.clip(actions, control.low, control.high)
    return result


def recorded_states(name: ControlName, scene: Scene, arms: Numbers) -> Floats:
    """Return the states of the robots in an absolute convention, shape (N, M): M numbers for each of N states.

    `arms` (N, R, 8) holds the joint angles and the opening of each robot.
    """
    robots = [robot_of(scene, robot) for robot in scene.robots]
    return np.concatenate([_absolute(name, robot, arms[:, i].astype(float)) for i, robot in enumerate(robots)], axis=1)


def state_names(names: Iterable[ControlName], scene: Scene) -> list[str]:
    """Return the names of the numbers in states in several absolute conventions, in order, without duplicates."""
    numbers = (f"{robot}/{each}" for name in names for robot in scene.robots for each in CONVENTIONS[name].numbers)
    return list(dict.fromkeys(numbers))


def states_in(names: Iterable[ControlName], scene: Scene, arms: Numbers) -> Floats:
    """Return the states of the robots in several absolute conventions, in the order of `state_names`, shape (N, M).

    `arms` (N, R, 8) holds the joint angles and the opening of each robot.
    """
    names = list(names)
    columns: dict[str, Floats] = {}
    for name in names:
        values = recorded_states(name, scene, arms)
        columns = dict(zip(state_names([name], scene), values.T, strict=True)) | columns
    return np.column_stack([columns[name] for name in state_names(names, scene)])


def tool_poses(robot: Robot, joints: Floats) -> Floats:
    """Return the poses of a tool in the scene, shape (N, 4, 4), for joint angles (N, 7)."""
    base = matrix(robot.base)
    return np.array([base @ robot.solver.forward(row) for row in joints])


def _absolute(name: ControlName, robot: Robot, rows: Floats) -> Floats:
    """Return joint angles and openings (N, 8) in an absolute convention."""
    if name == "joint_position":
        return rows
    poses = [vector_of_pose(pose) for pose in tool_poses(robot, rows[:, :7])]
    return np.column_stack([np.array(poses).reshape(-1, 6), rows[:, 7]])


def _values(name: ControlName, robot: Robot, rows: Floats) -> Floats:
    """Return the numbers of one robot, in their units, that lead from each row (N + 1, 8) to the next."""
    if name in STATES:
        return _absolute(name, robot, rows)[1:]
    if name == "joint_delta":
        return np.column_stack([np.diff(rows[:, :7], axis=0), rows[1:, 7]])
    poses = tool_poses(robot, rows[:, :7])
    motions = [motion_between(one, two) for one, two in pairwise(poses)]
    return np.column_stack([np.array(motions).reshape(-1, 6), rows[1:, 7]])
