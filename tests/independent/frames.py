"""Rotations with positions; metres and radians, z up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Frame(NamedTuple):
    """A rotation, shape (3, 3), and a position, shape (3,)."""

    turn: Array
    at: Array

    def __matmul__(self, inner: Frame) -> Frame:
        return Frame(self.turn @ inner.turn, self.turn @ inner.at + self.at)

    def inverse(self) -> Frame:
        return Frame(self.turn.T, -self.turn.T @ self.at)

    def offset(self, other: Frame) -> tuple[float, float]:
        """Return how far and by what angle another frame is off this one."""
        # The norm of the difference of two rotations by an angle a is 2 sqrt(2) sin(a / 2).
        chord = float(np.linalg.norm(self.turn - other.turn)) / (2 * np.sqrt(2))
        return float(np.linalg.norm(self.at - other.at)), 2 * float(np.arcsin(min(1.0, chord)))

    def raised(self, height: float) -> Frame:
        """Return this frame moved straight up."""
        return Frame(self.turn, self.at + np.array([0.0, 0.0, height]))


def turned(angle: float, axis: str) -> Array:
    """Return a rotation about x or z."""
    cosine, sine = np.cos(angle), np.sin(angle)
    if axis == "x":
        return np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    return np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])


def moved(x: float, y: float, z: float) -> Frame:
    """Return a frame that is not turned."""
    return Frame(np.eye(3), np.array([x, y, z]))


def standing(x: float, y: float, z: float, yaw: float) -> Frame:
    """Return a frame that is turned about z."""
    return Frame(turned(yaw, "z"), np.array([x, y, z]))


def frame(pose: Sequence[Sequence[float]]) -> Frame:
    """Return the frame of a pose as a file has it: position, then quaternion x, y, z, w."""
    at, (x, y, z, w) = pose[0], np.array(pose[1]) / np.linalg.norm(pose[1])
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return Frame(np.eye(3) + 2 * w * skew + 2 * skew @ skew, np.array(at, dtype=float))


def sound(pose: Sequence[Sequence[float]]) -> bool:
    """Tell whether a pose is of finite numbers, with a quaternion of length one."""
    at, quaternion = (np.array(part, dtype=float) for part in pose)
    finite = at.shape == (3,) and quaternion.shape == (4,) and np.isfinite([*at, *quaternion]).all()
    return bool(finite and abs(np.linalg.norm(quaternion) - 1) < 1e-6)
