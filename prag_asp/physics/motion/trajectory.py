"""When the arm is where on a path: smooth in time, slow enough for its motors."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.robots import Joints

ACCELERATION, LOADED_ACCELERATION = 10.0, 6.0
"""The highest of a joint in radians a second squared, and with what should neither slip nor turn in the gripper.

Straight up and down nothing does. With 8 or 10 on other ways one task of `prag` in fifteen fails.
"""

ROUNDING = 0.1
"""Seconds over which the corners of a path are rounded, and over which speed is gathered gently."""


def timed(path: Sequence[Joints], time_step: float, acceleration: float, speed: float) -> NDArray[np.float64]:
    """Return the joint angles of every time step along a path, shape (steps, 7), the first one left out.

    `acceleration` and `speed` are the highest of a joint, in radians a second (squared). The motion begins and ends at
    rest: it gathers speed, cruises and brakes, averaged over `ROUNDING`.
    """
    points = np.array(path)
    lengths = np.abs(np.diff(points, axis=0)).max(axis=1)
    reached = np.concatenate([[0.0], np.cumsum(lengths)])
    length = float(reached[-1])
    speed = min(speed, math.sqrt(acceleration * length))
    ramp = speed / acceleration
    seconds = length / speed + ramp if length > 0.0 else 0.0
    steps = math.ceil(seconds / time_step)
    times = np.arange(1, steps + 1) * (seconds / steps) if steps else np.zeros(0)
    gathered = acceleration / 2 * np.minimum(times, ramp) ** 2
    braked = acceleration / 2 * np.maximum(times - (seconds - ramp), 0.0) ** 2
    at = gathered + speed * np.maximum(times - ramp, 0.0) - braked
    angles = np.column_stack([np.interp(at, reached, column) for column in points.T])
    return _rounded(angles, points, round(ROUNDING / time_step))


def blended(ways: Sequence[NDArray[np.float64]], time_step: float) -> NDArray[np.float64]:
    """Return the joint angles of every time step along ways that begin where the one before ends, shape (steps, 7).

    Each begins while the one before is in its last `ROUNDING`. So the accelerations of both do not exceed that of one:
    what the one loses at a constant rate the other gains.
    """
    whole = ways[0]
    for way in ways[1:]:
        both = min(round(ROUNDING / time_step), len(whole), len(way))
        joined = np.concatenate([whole, np.repeat(whole[-1:], len(way) - both, axis=0)])
        joined[len(whole) - both :] += way - whole[-1]
        whole = joined
    return whole


def _rounded(angles: NDArray[np.float64], points: NDArray[np.float64], window: int) -> NDArray[np.float64]:
    """Return joint angles averaged over a window of steps; the motion takes as much longer."""
    before, after = np.repeat(points[:1], window, axis=0), np.repeat(points[-1:], window, axis=0)
    padded = np.concatenate([before, angles, after])
    sums = np.concatenate([np.zeros((1, padded.shape[1])), np.cumsum(padded, axis=0)])
    averaged: NDArray[np.float64] = (sums[window:] - sums[:-window]) / window
    averaged[-1] = points[-1]
    return averaged[1:]
