"""When the arm is where on a path: smooth in time, every joint within its own speed and acceleration.

The speed along a path of straight pieces is the highest that the joints allow: at every point the slowest joint
decides, and from there speed is gathered and lost at the rate of the weakest (a forward and a backward pass over the
squared speed, as in Bobrow, Dubowsky and Gibson, "Time-optimal control of robotic manipulators along specified paths",
1985). The motion is then averaged over `ROUNDING`, which keeps both limits and makes jerks finite: they are at most
twice the acceleration in this time. Around corners the average turns; there the path is passed as slowly as the joints
need.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.robots import Joints, Robot

Angles = NDArray[np.float64]

SPEED_SHARE, ACCELERATION_SHARE = 0.9, 0.85
"""What share of its limits a joint is asked for: its motor follows with small errors, by up to a tenth of the
acceleration."""

LOADED_ACCELERATION = 6.0
"""The highest of a joint with what should neither slip nor turn in the gripper, in radians a second squared.

Straight up and down nothing does. With 8 or 10 on other ways one task of `prag` in fifteen fails.
"""

ROUNDING = 0.1
"""Seconds over which the corners of a path are rounded, and over which speed is gathered gently."""

GRAIN = 0.02
"""Radians between the places where the speed along a path is chosen."""

STILL = 1e-12
"""Radians up to which a piece of a path does not move: sums of angles are not more exact."""

SLOWDOWNS = 30
TOLERANCE = 1e-6


class Limits(NamedTuple):
    """How fast each joint may turn and gather speed, shape (7,), in radians a second and a second squared."""

    speeds: Angles
    accelerations: Angles

    def excess(self, angles: Angles, begun: Angles, time_step: float) -> Angles:
        """Return how many times its limit the joint that is nearest to it reaches, shape (steps + 1,).

        The motion goes from rest at joint angles `begun` through `angles`, shape (steps, 7), to rest.
        """
        still = np.zeros((1, angles.shape[1]))
        speeds = np.diff(np.concatenate([begun[None], angles]), axis=0) / time_step
        accelerations = np.diff(np.concatenate([still, speeds, still]), axis=0) / time_step
        found: Angles = np.abs(accelerations / self.accelerations).max(axis=1)
        fast = np.abs(speeds / self.speeds).max(axis=1)
        found[:-1] = np.maximum(found[:-1], fast)
        return found


def limits_of(robot: Robot, loaded: bool = False) -> Limits:
    """Return what the joints of a robot are asked for, less where the gripper is `loaded`."""
    accelerations = ACCELERATION_SHARE * np.array(robot.accelerations)
    if loaded:
        accelerations = np.minimum(accelerations, LOADED_ACCELERATION)
    return Limits(SPEED_SHARE * np.array(robot.speeds), accelerations)


def timed(path: Sequence[Joints], time_step: float, limits: Limits) -> Angles:
    """Return the joint angles of every time step along a path, shape (steps, 7), the first one left out.

    The motion begins and ends at rest, and no joint exceeds its limits from one step to the next.
    """
    points = np.array(path)
    cells = _cells(points, limits)
    if cells is None:
        return np.repeat(points[-1:], round(ROUNDING / time_step), axis=0)
    window = round(ROUNDING / time_step)
    for _ in range(SLOWDOWNS):
        reached, places = _passed(cells, time_step)
        angles = _rounded(_at(points, cells, places), points, window)
        excess = limits.excess(angles, points[0], time_step)
        if excess.max() <= 1.0 + TOLERANCE:
            return angles
        cells = _slower(cells, reached, excess, window)
    while excess.max() > 1.0 + TOLERANCE:
        cells = cells._replace(caps=cells.caps / excess.max())
        _, places = _passed(cells, time_step)
        angles = _rounded(_at(points, cells, places), points, window)
        excess = limits.excess(angles, points[0], time_step)
    return angles


class _Cells(NamedTuple):
    """A path cut into cells that are straight: the lengths along it at their ends (n + 1,) and at its points.

    `rates` (n,) are how fast speed may be gathered in each, `caps` (n + 1,) the highest speeds at their ends. Lengths
    are radians of the joint that turns most.
    """

    lengths: Angles
    corners: Angles
    rates: Angles
    caps: Angles


def _cells(points: Angles, limits: Limits) -> _Cells | None:
    """Return the cells of a path, None where it does not move."""
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
    counts = np.maximum(np.ceil(lengths[moving] / GRAIN).astype(int), 2)  # with one, both ends at rest, nothing moves
    steps = np.repeat(lengths[moving] / counts, counts)
    cell_speeds = np.repeat(speeds, counts)
    caps = np.minimum(np.append(cell_speeds, np.inf), np.append(np.inf, cell_speeds))
    between = np.cumsum(counts)[:-1]
    caps[between] = np.minimum(caps[between], passing)
    caps[[0, -1]] = 0.0
    return _Cells(np.concatenate([[0.0], np.cumsum(steps)]), corners, np.repeat(rates, counts), caps)


def _passed(cells: _Cells, time_step: float) -> tuple[Angles, Angles]:
    """Return when the ends of cells are reached, shape (n + 1,), in time steps, and how far one is at each step."""
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


def _slower(cells: _Cells, reached: Angles, excess: Angles, window: int) -> _Cells:
    """Return cells with lower speeds where a joint exceeds its limits: all that is averaged there is passed slower."""
    caps = cells.caps.copy()
    for step in np.flatnonzero(excess > 1.0).tolist():
        first, last = np.searchsorted(reached, (step - window - 1, step + 1))
        part = slice(max(0, int(first) - 1), int(last) + 1)
        caps[part] = np.minimum(caps[part], cells.caps[part] / excess[step])
    return cells._replace(caps=caps)


def _at(points: Angles, cells: _Cells, places: Angles) -> Angles:
    """Return the joint angles at lengths along a path, shape (steps, 7)."""
    return np.column_stack([np.interp(places, cells.corners, column) for column in points.T])


def blended(ways: Sequence[Angles], begun: Joints, time_step: float, limits: Limits) -> Angles:
    """Return the joint angles of every time step along ways that begin where the one before ends, shape (steps, 7).

    Each begins while the one before is in its last `ROUNDING`, as far as the joints allow: where the one loses speed at
    a constant rate and the other gathers it, the accelerations of both do not exceed that of one.
    """
    whole, start = ways[0], np.array(begun)
    for way in ways[1:]:
        most = min(round(ROUNDING / time_step), len(whole), len(way))
        for both in (most, most // 2, 0):
            joined = np.concatenate([whole, np.repeat(whole[-1:], len(way) - both, axis=0)])
            joined[len(whole) - both :] += way - whole[-1]
            if limits.excess(joined, start, time_step).max() <= 1.0 + TOLERANCE:
                break
        whole = joined
    return whole


def _rounded(angles: Angles, points: Angles, window: int) -> Angles:
    """Return joint angles averaged over a window of steps; the motion takes as much longer."""
    before, after = np.repeat(points[:1], window, axis=0), np.repeat(points[-1:], window, axis=0)
    padded = np.concatenate([before, angles, after])
    sums = np.concatenate([np.zeros((1, padded.shape[1])), np.cumsum(padded, axis=0)])
    averaged: Angles = (sums[window:] - sums[:-window]) / window
    averaged[-1] = points[-1]
    return averaged[1:]
