"""The control conventions: the names, units and scales of the numbers in an action."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.physics.control.names import CONTROLS, RATES, USUAL_RATE, ControlName
from prag_asp.physics.world.time_step import STEPS_A_SECOND
from prag_asp.scene.robots import Robot, robot_of
from prag_asp.scene.scene import Scene
from prag_asp.wording import unknown

Floats = NDArray[np.float64]

TOOL_SPEED, TOOL_TURN = 2.0, 10.0
"""The greatest speed of the tool along and about an axis in `ee_delta`, in m/s and rad/s.

Recordings, whose joints move at up to nine tenths of their speed limits, stay below these speeds.
"""

STRIDE, TURN = 1.0, 5.0
"""The greatest speeds of the tool in `ee_delta_upright`, in m/s and rad/s; they are lower so that agents can learn."""

FINGERS = 0.2
"""The maximum speed of opening or closing a gripper, in metres per second."""

FARTHEST = 1.5
"""A distance in metres from the base, along an axis, that no robot's tool can exceed."""


class Convention(NamedTuple):
    """The numbers for one robot in an action, with their units.

    Actions in an `absolute` convention have these units; in other conventions, they are scaled to the range from -1 to
    1.
    """

    numbers: tuple[str, ...]
    units: tuple[str, ...]
    absolute: bool


_ARM = (*(f"joint_{i}" for i in range(1, 8)), "gripper"), (*("rad",) * 7, "m")
_TOOL = ("x", "y", "z", "rx", "ry", "rz", "gripper"), (*("m",) * 3, *("rad",) * 3, "m")
CONVENTIONS: dict[ControlName, Convention] = {
    "joint_position": Convention(*_ARM, absolute=True),
    "joint_delta": Convention(*_ARM, absolute=False),
    "ee_position": Convention(*_TOOL, absolute=True),
    "ee_delta": Convention(*_TOOL, absolute=False),
    "ee_delta_upright": Convention(("x", "y", "z", "yaw", "gripper"), ("m", "m", "m", "rad", "m"), absolute=False),
}


@dataclass(frozen=True, eq=False)
class Control:
    """A control convention for the robots of a scene: the meaning of the N numbers in an action.

    ``joint_position`` contains the target angle of each joint, ``ee_position`` the target pose of the tool: its
    position in the scene, and the rotation vector, along the axes of the scene, from the orientation in which the tool
    points straight down and its x axis is parallel to the x axis of the scene. ``joint_delta`` and ``ee_delta`` contain
    the changes to these targets in a step; the change of the pose consists of a translation and of a rotation vector
    applied after the current rotation, both along the axes of the scene. Changes are added to the targets, not to the
    measured state. All four conventions contain the target opening of the gripper. ``ee_delta_upright`` contains, for a
    tool that points down, a translation, a turn about the vertical, and the change of the opening.

    An action contains the numbers of each robot in turn; there are `rate` actions per second. `names` (N,) are names
    like ``panda/joint_1``, `units` (N,) are ``m`` or ``rad``. `lower` and `upper` (N,) are the smallest and largest
    values in these units; `low` and `high` (N,) are the corresponding values of an action: the same in absolute
    conventions, and -1 and 1 in the others.
    """

    name: ControlName
    robots: tuple[str, ...]
    rate: int
    lower: Floats
    upper: Floats

    @classmethod
    def of(cls, name: str, scene: Scene, rate: int = USUAL_RATE, *, scale: float = 1.0) -> Control:
        """Return the convention with a given name; `scale` multiplies its changes, except those to the gripper opening.

        Raises:
            QueryError: there is no such convention or rate, or absolute values are scaled.
        """
        if name not in CONTROLS:
            raise QueryError(unknown(name, CONTROLS, "control"))
        if isinstance(rate, bool) or rate not in RATES:
            raise QueryError(f"rate {rate!r:.80}: give a number of actions per second that divides {STEPS_A_SECOND}")
        bounds = [_bounds(name, robot_of(scene, robot), rate) for robot in scene.robots]
        lower, upper = (np.concatenate(side) for side in zip(*bounds, strict=True))
        if scale != 1.0:
            if CONVENTIONS[name].absolute:
                raise QueryError(f"{name} has absolute values, which have no scale; choose a relative control")
            count = len(CONVENTIONS[name].numbers)
            scales = np.tile([*[scale] * (count - 1), 1.0], len(scene.robots))
            lower, upper = lower * scales, upper * scales
        return cls(name, tuple(scene.robots), int(rate), lower, upper)

    @property
    def convention(self) -> Convention:
        """The convention for a single robot."""
        return CONVENTIONS[self.name]

    @property
    def names(self) -> tuple[str, ...]:
        """The name of each number."""
        return tuple(f"{robot}/{number}" for robot in self.robots for number in self.convention.numbers)

    @property
    def units(self) -> tuple[str, ...]:
        """The unit of each number."""
        return self.convention.units * len(self.robots)

    @cached_property
    def low(self) -> Floats:
        """The lower bounds of an action, shape (N,)."""
        return self.lower if self.convention.absolute else np.full(len(self.lower), -1.0)

    @cached_property
    def high(self) -> Floats:
        """The upper bounds of an action, shape (N,)."""
        return self.upper if self.convention.absolute else np.full(len(self.upper), 1.0)

    def values(self, action: Floats) -> Floats:
        """Return the numbers of actions in the units of the convention; the last axis has length N."""
        return action if self.convention.absolute else self.from_unit(action)

    def actions(self, values: Floats) -> Floats:
        """Return the actions for numbers in the units of the convention; the last axis has length N."""
        return values if self.convention.absolute else self.to_unit(values)

    def from_unit(self, shares: Floats) -> Floats:
        """Return numbers in their units, given numbers between -1 and 1, which stand for `lower` and `upper`."""
        return self._middle + self._half * shares

    def to_unit(self, values: Floats) -> Floats:
        """Return numbers between -1 and 1, which stand for `lower` and `upper`, given numbers in their units."""
        result: Floats = (values - self._middle) / self._half
        return result

    @cached_property
    def _middle(self) -> Floats:
        """The middle of the range of each number, in its unit."""
        return (self.lower + self.upper) / 2

    @cached_property
    def _half(self) -> Floats:
        """Half the range of each number, in its unit."""
        return (self.upper - self.lower) / 2


def _bounds(name: str, robot: Robot, rate: int) -> tuple[Floats, Floats]:
    """Return the lower and upper bounds of one robot's numbers, in their units."""
    at = robot.base.position
    lower: Sequence[float]
    upper: Sequence[float]
    match name:
        case "joint_position":
            lower, upper = robot.lower, robot.upper
        case "joint_delta":
            upper = [speed / rate for speed in robot.speeds]
            lower = [-step for step in upper]
        case "ee_position":
            lower = [*(each - FARTHEST for each in at), *(-pi,) * 3]
            upper = [*(each + FARTHEST for each in at), *(pi,) * 3]
        case "ee_delta":
            upper = [*(TOOL_SPEED / rate,) * 3, *(TOOL_TURN / rate,) * 3]
            lower = [-step for step in upper]
        case _:
            upper = [*(STRIDE / rate,) * 3, TURN / rate]
            lower = [-step for step in upper]
    fingers = (-FINGERS / rate, FINGERS / rate) if name == "ee_delta_upright" else (0.0, robot.opening)
    return np.array([*lower, fingers[0]]), np.array([*upper, fingers[1]])
