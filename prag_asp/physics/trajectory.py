"""When the arm is where on a path: smooth in time, slow enough for its motors."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.robot import Joints

ACCELERATION, LOADED_ACCELERATION = 10.0, 6.0
"""The highest of a joint in radians a second squared, with an empty gripper and with what should not swing in it."""

SHORTEST = 0.2
ROUNDING = 0.12
"""Seconds over which the corners of a path are rounded."""

PEAK_SPEED, PEAK_ACCELERATION = 1.875, 5.774
"""Of a motion of minimal jerk over unit length in unit time."""


def timed(path: Sequence[Joints], time_step: float, acceleration: float, speed: float) -> NDArray[np.float64]:
    """Return the joint angles of every time step along a path, shape (steps, 7), the first one left out.

    `acceleration` and `speed` are the highest of a joint, in radians a second (squared).

    The motion begins and ends at rest; along the path it has minimal jerk (Flash and Hogan 1985).
    """
    points = np.array(path)
    lengths = np.abs(np.diff(points, axis=0)).max(axis=1)
    reached = np.concatenate([[0.0], np.cumsum(lengths)])
    length = float(reached[-1])
    seconds = max(SHORTEST, PEAK_SPEED * length / speed, math.sqrt(PEAK_ACCELERATION * length / acceleration))
    steps = int(np.ceil(seconds / time_step))
    share = np.arange(1, steps + 1) / steps
    at = length * share**3 * (10 - 15 * share + 6 * share**2)
    angles = np.column_stack([np.interp(at, reached, column) for column in points.T])
    return _rounded(angles, points, int(ROUNDING / time_step)) if len(path) > 2 else angles


def _rounded(angles: NDArray[np.float64], points: NDArray[np.float64], window: int) -> NDArray[np.float64]:
    """Return joint angles averaged over a window of steps; the motion takes as much longer."""
    before, after = np.repeat(points[:1], window, axis=0), np.repeat(points[-1:], window, axis=0)
    padded = np.concatenate([before, angles, after])
    sums = np.concatenate([np.zeros((1, padded.shape[1])), np.cumsum(padded, axis=0)])
    averaged: NDArray[np.float64] = (sums[window:] - sums[:-window]) / window
    averaged[-1] = points[-1]
    return averaged[1:]
