"""A scripted agent, the oracle, which follows the waypoints of the witness and knows the exact poses of all bodies.

It shows which subgoals an upright tool can reach, and serves as a baseline for learned agents.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.physics.control.names import UPRIGHT
from prag_asp.physics.demonstration.acting import SQUEEZE
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import TRANSIT, Moment, Waypoint
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import compose, wrap, yaw_of

if TYPE_CHECKING:
    from prag_asp.rl.environment import TaskEnv
    from prag_asp.rl.goal_env import Observation

CLOSE, CLOSE_TURN = 0.004, 0.03
"""The distance and the angle within which a waypoint counts as reached, in metres and radians."""

HEIGHT, APART = 0.3, 0.06
"""The travel height of the tool, and the horizontal distance above which the tool travels at this height, in metres."""

GENTLE = 0.01
"""The largest motion of furniture in a step, in metres, so that its contents do not roll."""

PATIENCE, SETTLING = 60, 4
"""The step limit for a waypoint, and the number of steps to wait after the fingers close or open."""

Action = NDArray[np.float32]


class OraclePolicy:
    """The oracle as a policy for a subgoal: it gives up after the last waypoint, and starts again at each `begin`.

    Raises:
        QueryError: the actions of the environment are not displacements of the tool.
    """

    def __init__(self, env: TaskEnv):
        _require_tool(env)
        self._env = env
        self.begin()

    def begin(self) -> None:
        """Take over from the current state."""
        self._actions: Iterator[Action] | None = None

    def __call__(self, observation: Observation) -> Action | None:
        """Return the next action for the current subgoal, or None after the last action."""
        if self._actions is None:
            self._actions = _pursued(self._env, self._env.stage)
        return next(self._actions, None)


def oracle(env: TaskEnv) -> Iterator[Action]:
    """Yield actions for the subgoals of an episode that has begun, each computed from the current state.

    Raises:
        QueryError: the actions of the environment are not displacements of the tool.
    """
    _require_tool(env)
    return (action for stage in range(env.stage, len(env.witness.motions)) for action in _pursued(env, stage))


def _require_tool(env: TaskEnv) -> None:
    """Check that an environment takes displacements of the tool.

    Raises:
        QueryError: the environment takes other actions.
    """
    if env.control.name != UPRIGHT:
        raise QueryError(f'the oracle moves an upright tool; make the environment with control="{UPRIGHT}"')


def _pursued(env: TaskEnv, stage: int) -> Iterator[Action]:
    """Yield the actions for each waypoint of a stage in turn."""
    before, motion = env.witness.moments[stage], env.witness.motions[stage]
    held = {name: arm.held for name, arm in before.arms.items()}
    for i, waypoint in enumerate(motion):
        if waypoint.name == TRANSIT:
            continue
        robot = waypoint.robot
        if held[robot] is None and waypoint.held is None:
            yield from _fingers(env, robot, waypoint.width)
        if waypoint.held == held[robot]:
            ahead = (each.held for each in motion[i:] if each.robot == robot)
            yield from _moved(env, waypoint, before, next(filter(None, ahead), None))
        else:
            squeeze = SQUEEZE if waypoint.held is not None else 0.0
            yield from _fingers(env, robot, waypoint.width - squeeze)
            for _ in range(SETTLING):
                yield _action(env, robot)
            held[robot] = waypoint.held


def _fingers(env: TaskEnv, robot: str, opening: float) -> Iterator[Action]:
    """Yield actions that bring a gripper to an opening in metres."""
    farthest = float(env.control.upper[-1])
    while abs(off := opening - env.commanded_openings[robot]) > farthest / 100:
        yield _action(env, robot, fingers=off)


def _moved(env: TaskEnv, waypoint: Waypoint, before: Moment, target: str | None) -> Iterator[Action]:
    """Yield actions that move the tool to a waypoint, at the travel height while the tool is far from the waypoint."""
    free = waypoint.opening is None
    for _ in range(PATIENCE):
        (x, y, z), off = _off(env.situation, waypoint, before, target)
        aside = float(np.hypot(x, y))
        if max(aside, abs(z)) < CLOSE and abs(off) < CLOSE_TURN:
            return
        height = env.situation.tool(waypoint.robot).position[2]
        if free and aside > APART:
            x, y = (x, y) if height > HEIGHT - APART else (0.0, 0.0)
            z = HEIGHT - height
        if not free:
            slow = min(1.0, GENTLE / max(aside, abs(z)))
            x, y, z = slow * x, slow * y, slow * z
        yield _action(env, waypoint.robot, (x, y, z), off)


def _off(situation: Situation, waypoint: Waypoint, before: Moment, target: str | None) -> tuple[Vector, float]:
    """Return the displacement of the tool to a waypoint in metres, and its turn in radians.

    A held body is moved to its pose in the witness, whatever its pose in the hand; a body to be grasped is approached
    at its current position.
    """
    robot = waypoint.robot
    planned, now = tool_pose(situation.robot(robot), waypoint.joints), situation.tool(robot)
    x, y, z = (a - b for a, b in zip(planned.position, now.position, strict=True))
    turn = wrap(yaw_of(planned.quaternion) - yaw_of(now.quaternion))
    arm = before.arms[robot]
    if waypoint.opening is None and waypoint.held is not None and arm.grasp is not None and arm.held == waypoint.held:
        planned_body, lies = compose(planned, arm.grasp), situation.pose(waypoint.held)
        x, y, z = (a - b for a, b in zip(planned_body.position, lies.position, strict=True))
        turn = wrap(yaw_of(planned_body.quaternion) - yaw_of(lies.quaternion))
    elif waypoint.held is None and target is not None and target in before.poses:
        there, here = before.poses[target].position, situation.poses[target].position
        if not situation.shape(target).traits.furniture:
            x, y = x + here[0] - there[0], y + here[1] - there[1]
    return (x, y, z), _way_round(situation, robot, turn)


def _way_round(situation: Situation, robot: str, turn: float) -> float:
    """Return a turn in radians, or the equivalent opposite turn if the last joint cannot turn that far.

    The tool points down, so a positive turn of that joint is a negative turn about the vertical.
    """
    arm, last = situation.robot(robot), situation.arm(robot).joints[-1]
    if arm.lower[-1] <= last - turn <= arm.upper[-1]:
        return turn
    return turn - math.copysign(2 * math.pi, turn)


def _action(
    env: TaskEnv, robot: str, move: Vector = (0.0, 0.0, 0.0), turn: float = 0.0, fingers: float = 0.0
) -> Action:
    """Return the action that moves one arm and its fingers, in metres and radians."""
    numbers = np.zeros((len(env.control.robots), len(env.control.convention.numbers)), dtype=np.float32)
    stride, _, _, most, opening = env.control.upper[: numbers.shape[1]].tolist()
    farthest = max(1.0, *(abs(part) / stride for part in move))
    own = [*(part / stride / farthest for part in move), turn / most, fingers / opening]
    numbers[env.control.robots.index(robot)] = np.clip(own, -1.0, 1.0)
    return numbers.ravel()
