"""Time parameterization of paths: smooth, with every joint within its speed and acceleration limits.

The speed along a piecewise linear path is the highest that the joints allow: the slowest joint limits it at every
point, and the weakest joint limits its change (a forward and a backward pass over the squared speed, as in Bobrow,
Dubowsky and Gibson, "Time-optimal control of robotic manipulators along specified paths", 1985). The motion is then
averaged over `ROUNDING`, which preserves both limits and bounds the jerk: within this time, the acceleration changes by
at most twice its limit. The averaged motion cuts corners, slowly enough for the joints.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import count
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.robots import Joints, Robot

Angles = NDArray[np.float64]

SPEED_SHARE, ACCELERATION_SHARE = 0.9, 0.85
"""The shares of a joint's limits that are used, because its motor has tracking errors of up to a tenth of the
acceleration."""

LOADED_ACCELERATION = 6.0
"""The largest acceleration of a joint, in rad/s², while the gripper holds an object, which should not slip or rotate.

On straight vertical paths, it does neither. At 8 or 10 rad/s² on other paths, one in fifteen tasks of `prag` fails.
"""

ROUNDING = 0.1
"""The time in seconds over which a motion is averaged."""

GRAIN = 0.02
"""The distance in radians between the points at which the speed along a path is computed."""

STILL = 1e-12
"""The length in radians below which a piece of a path counts as standing still, because of rounding."""

SLOWDOWNS = 30
"""The number of times that parts of a path are slowed down before the whole path is."""

TOLERANCE = 1e-6
"""The share by which a joint may exceed its limits, because of rounding."""


class JointLimits(NamedTuple):
    """The speed and acceleration limits of the joints, shape (7,), in rad/s and rad/s²."""

    speeds: Angles
    accelerations: Angles

    def excess(self, angles: Angles, start: Angles, time_step: float) -> Angles:
        """Return the largest ratio of a joint's speed or acceleration to its limit at each step, shape (steps + 1,).

        The motion goes from rest at joint angles `start` through `angles`, shape (steps, 7), to rest.
        """
        still = np.zeros((1, angles.shape[1]))
        speeds = np.diff(np.concatenate([start[None], angles]), axis=0) / time_step
        accelerations = np.diff(np.concatenate([still, speeds, still]), axis=0) / time_step
        ratios: Angles = np.abs(accelerations / self.accelerations).max(axis=1)
        fast = np.abs(speeds / self.speeds).max(axis=1)
        ratios[:-1] = np.maximum(ratios[:-1], fast)
        return ratios


def joint_limits(robot: Robot, loaded: bool = False) -> JointLimits:
    """Return the limits to use for the joints of a robot, which are lower if the gripper is `loaded`."""
    accelerations = ACCELERATION_SHARE * np.array(robot.accelerations)
    if loaded:
        accelerations = np.minimum(accelerations, LOADED_ACCELERATION)
    return JointLimits(SPEED_SHARE * np.array(robot.speeds), accelerations)


def time_path(path: Sequence[Joints], time_step: float, limits: JointLimits) -> Angles:
    """Return the joint angles at every time step along a path, shape (steps, 7), without the first point.

    The motion begins and ends at rest, and no joint exceeds its limits from one step to the next.
    """
    points = np.array(path)
    cells = _cells(points, limits)
    window = round(ROUNDING / time_step)
    if cells is None:
        return np.repeat(points[-1:], window, axis=0)
    for slowdown in count(1):
        reached, places = _passed(cells, time_step)
        angles = np.column_stack([np.interp(places, cells.corners, column) for column in points.T])
        # Averaging over the window lengthens the motion.
        padded = np.concatenate([np.repeat(points[:1], window, axis=0), angles, np.repeat(points[-1:], window, axis=0)])
        sums = np.concatenate([np.zeros((1, padded.shape[1])), np.cumsum(padded, axis=0)])
        angles = ((sums[window:] - sums[:-window]) / window)[1:]
        angles[-1] = points[-1]
        excess = limits.excess(angles, points[0], time_step)
        if excess.max() <= 1.0 + TOLERANCE:
            break
        caps = cells.caps.copy()
        # Slow down in the averaging windows in which a joint exceeds its limits, and finally on the whole path.
        for step in np.flatnonzero(excess > 1.0).tolist() if slowdown <= SLOWDOWNS else ():
            first, last = np.searchsorted(reached, (step - window - 1, step + 1))
            part = slice(max(0, int(first) - 1), int(last) + 1)
            caps[part] = np.minimum(caps[part], cells.caps[part] / excess[step])
        cells = cells._replace(caps=caps if slowdown < SLOWDOWNS else caps / excess.max())
    return angles


class _Cells(NamedTuple):
    """A path cut into straight cells: the path lengths at their ends (n + 1,) and at the corners of the path.

    `rates` (n,) are the largest accelerations along the path in each cell, and `caps` (n + 1,) are the highest speeds
    at the ends of the cells. Lengths are in radians of the joint that moves most.
    """

    lengths: Angles
    corners: Angles
    rates: Angles
    caps: Angles


def _cells(points: Angles, limits: JointLimits) -> _Cells | None:
    """Return the cells of a path, or None if the path does not move."""
    pieces = np.diff(points, axis=0)
    lengths = np.abs(pieces).max(axis=1)
    moving = lengths > STILL
    if not moving.any():
        return None
    corners = np.concatenate([[0.0], np.cumsum(lengths)])
    directions = pieces[moving] / lengths[moving, None]
    with np.errstate(divide="ignore", over="ignore"):
        speeds = (limits.speeds / np.abs(directions)).min(axis=1)
        rates = (limits.accelerations / np.abs(directions)).min(axis=1)
        turns = np.abs(np.diff(directions, axis=0))
        passing = (limits.accelerations * ROUNDING / turns).min(axis=1)
    counts = np.maximum(np.ceil(lengths[moving] / GRAIN).astype(int), 2)  # a single cell would be at rest at both ends
    steps = np.repeat(lengths[moving] / counts, counts)
    cell_speeds = np.repeat(speeds, counts)
    caps = np.minimum(np.append(cell_speeds, np.inf), np.append(np.inf, cell_speeds))
    between = np.cumsum(counts)[:-1]
    caps[between] = np.minimum(caps[between], passing)
    caps[[0, -1]] = 0.0
    return _Cells(np.concatenate([[0.0], np.cumsum(steps)]), corners, np.repeat(rates, counts), caps)


def _passed(cells: _Cells, time_step: float) -> tuple[Angles, Angles]:
    """Return the times at the ends of the cells, shape (n + 1,), in time steps, and the path length at each step."""
    gained = np.concatenate([[0.0], np.cumsum(2.0 * cells.rates * np.diff(cells.lengths))])
    squared = cells.caps**2
    squared = np.minimum.accumulate(squared - gained) + gained
    squared = np.minimum.accumulate((squared + gained)[::-1])[::-1] - gained
    speeds = np.sqrt(np.maximum(squared, 0.0))
    seconds = 2.0 * np.diff(cells.lengths) / (speeds[:-1] + speeds[1:])
    reached = np.concatenate([[0.0], np.cumsum(seconds)])
    steps = max(1, math.ceil(reached[-1] / time_step))
    slower = steps * time_step / reached[-1]
    times = np.arange(1, steps + 1) * (time_step / slower)
    i = np.minimum(np.searchsorted(reached, times, side="right") - 1, len(seconds) - 1)
    share = np.minimum((times - reached[i]) / seconds[i], 1.0)
    places = cells.lengths[i] + seconds[i] * share * (speeds[i] + share / 2.0 * (speeds[i + 1] - speeds[i]))
    return reached * slower / time_step, places


def blend_paths(ways: Sequence[Angles], start: Joints, time_step: float, limits: JointLimits) -> Angles:
    """Return the joint angles at every time step along consecutive paths, shape (steps, 7).

    As far as the joint limits allow, each path begins during the last `ROUNDING` seconds of the previous path: while
    one path decelerates at a constant rate and the other accelerates, their sum does not exceed the limit for a single
    path.
    """
    whole, origin = ways[0], np.array(start)
    for way in ways[1:]:
        most = min(round(ROUNDING / time_step), len(whole), len(way))
        for both in (most, most // 2, 0):
            joined = np.concatenate([whole, np.repeat(whole[-1:], len(way) - both, axis=0)])
            joined[len(whole) - both :] += way - whole[-1]
            if limits.excess(joined, origin, time_step).max() <= 1.0 + TOLERANCE:
                break
        whole = joined
    return whole
