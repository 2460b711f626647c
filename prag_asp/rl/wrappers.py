"""An environment wrapper for learning: actions are relative to a scripted reach."""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.physics.control.names import UPRIGHT
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.situation import Situation
from prag_asp.rl.environment import TaskEnv
from prag_asp.rl.observations import named_bodies
from prag_asp.scene.geometry import rotate

HOLDING = PREDICATES["holding"]

ABOVE, ASIDE = 0.06, 0.02
"""The height in metres above a body at which the tool travels, and the horizontal distance within which it descends."""


class ScriptedReach(gymnasium.ActionWrapper[Any, NDArray[np.float32], NDArray[np.float32]]):
    """A wrapper that adds a scripted reach, towards the first body in the current action, to each action.

    The reach moves the tool of the acting arm over the body and then down to its centre, turned so that the fingers can
    close on the narrow sides of a box. Each motion is at most the largest displacement in an action. The reach does not
    move the fingers; when the arm holds the body, it lifts the body. An agent thus learns a residual (Johannink and
    others, "Residual reinforcement learning for robot control", 2019), scaled by `share`.

    Raises:
        QueryError: the environment is not a `TaskEnv`, its actions are not displacements of the tool, or the share is
            not above 0 and at most 1.
    """

    def __init__(self, env: gymnasium.Env[Any, NDArray[np.float32]], share: float = 0.3):
        super().__init__(env)
        if not isinstance(env.unwrapped, TaskEnv) or env.unwrapped.control.name != UPRIGHT:
            raise QueryError(f'a reach moves an upright tool; give a TaskEnv with control="{UPRIGHT}"')
        if not 0.0 < share <= 1.0:
            raise QueryError(f"a share is above 0 and at most 1; got {share!r:.80}")
        self._task_env, self._share = env.unwrapped, share

    def action(self, action: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the action of the environment, clipped to -1 and 1."""
        env = self._task_env
        scale = np.tile(np.array([*[self._share] * 4, 1.0], dtype=np.float32), len(env.layout.robots))
        moves: NDArray[np.float32] = np.clip(scale * action + self._reach(), -1.0, 1.0, dtype=np.float32)
        return moves

    def _reach(self) -> NDArray[np.float32]:
        """Return the motion of the reach as an action."""
        env, robots = self._task_env, self._task_env.layout.robots
        moves = np.zeros((len(robots), len(env.control.convention.numbers)), dtype=np.float32)
        acting = next((name for name in env.action.arguments if name in robots), robots[0])
        bodies = named_bodies(env.action, env.scene)
        if bodies and HOLDING.holds(env.situation, (acting, bodies[0])):
            moves[robots.index(acting), 2] = 1.0
        elif bodies:
            body, tool = env.situation.body(bodies[0]), env.situation.tool(acting).position
            x, y, z = (at - here for at, here in zip(body.centre, tool, strict=True))
            if math.hypot(x, y) > ASIDE:
                over = body.high[2] + ABOVE - tool[2]
                x, y, z = (x, y, over) if over < ABOVE / 2 else (0.0, 0.0, over)
            stride, _, _, most, *_ = env.control.upper.tolist()
            step = max(stride, abs(x), abs(y), abs(z))
            turn = _turn(env.situation, acting, bodies[0]) / most
            moves[robots.index(acting), :4] = x / step, y / step, z / step, min(max(turn, -1.0), 1.0)
        return moves.ravel()


def _turn(situation: Situation, robot: str, entity: str) -> float:
    """Return the smallest turn, in radians, after which the fingers close on the narrow sides of a box; otherwise 0."""
    shape = situation.shape(entity)
    if shape.kind != "box":
        return 0.0
    across = (1.0, 0.0, 0.0) if shape.half[0] < shape.half[1] else (0.0, 1.0, 0.0)
    x, y, _ = rotate(situation.body(entity).pose.quaternion, across)
    # The fingers move along the y axis of the tool.
    along_x, along_y, _ = rotate(situation.tool(robot).quaternion, (0.0, 1.0, 0.0))
    turn = math.atan2(y, x) - math.atan2(along_y, along_x)
    return (turn + math.pi / 2) % math.pi - math.pi / 2
