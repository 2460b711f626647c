"""Limit the acceleration of a held object so that the friction of the pads bears the load.

The pads hold an object of mass m by friction: they bear at most 2 mu F, where F is the force of a finger and mu is the
coefficient of friction (Coulomb). Against gravity and with an acceleration a of the tool, the object needs at most m (g
+ |a|).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.motion.trajectory import JointLimits, time_path
from prag_asp.physics.predicates.grip_friction import GRAVITY, bearable
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.scene.robots import Joints, Robot
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import weight

FRICTION_SHARE = 0.95
"""The share of the pads' friction that is used, because the motors have tracking errors."""

LEAST, MOST = 0.5, 40.0
"""Accelerations in m/s²: with less than the first, an arm hardly moves; with more than the second, no arm moves its
tool."""

SHARE = 0.98
"""The share of the allowed acceleration to which a motion is slowed down, because the rounding of corners depends on
speed."""

SLOWDOWNS = 20
"""The maximum number of times that a motion is slowed down; once or twice is usual."""


def bearable_acceleration(scene: Scene, entity: str, robot: str) -> float:
    """Return the largest acceleration of the tool at which a held object does not slip, in m/s², but at least `LEAST`.

    For furniture, of which a robot moves only a part, the result is `MOST`.
    """
    if scene.shapes[entity].traits.furniture:
        return MOST
    return max(LEAST, FRICTION_SHARE * GRAVITY * bearable(scene, entity, robot) / weight(scene, entity) - GRAVITY)


def time_carried(
    robot: Robot, path: Sequence[Joints], time_step: float, limits: JointLimits, most: float
) -> NDArray[np.float64]:
    """Return the result of `time_path`, slowed down until the acceleration of the tool is at most `most` m/s²."""
    angles = time_path(path, time_step, limits)
    for _ in range(SLOWDOWNS if most < MOST else 0):
        peak = peak_acceleration(robot, path[0], angles, time_step)
        if peak <= most:
            break
        share = SHARE * most / peak
        limits = JointLimits(limits.speeds * math.sqrt(share), limits.accelerations * share)
        angles = time_path(path, time_step, limits)
    return angles


def peak_acceleration(robot: Robot, start: Joints, angles: NDArray[np.float64], time_step: float) -> float:
    """Return the largest acceleration of the tool, in m/s², in a motion from rest to rest along `angles` (steps, 7)."""
    rows = [start, start, *map(tuple, angles.tolist()), tuple(angles[-1].tolist())]
    positions = np.array([tool_pose(robot, row).position for row in rows])
    accelerations = np.diff(positions, 2, axis=0) / time_step**2
    return float(np.sqrt((accelerations**2).sum(axis=1)).max())
