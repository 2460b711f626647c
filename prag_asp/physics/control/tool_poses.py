"""Tool poses as six numbers: a position, and a rotation vector relative to a tool that points straight down.

A rotation vector relative to the scene would be useless: for a tool that points down, its length would be close to pi,
where the vector jumps between opposite directions.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.robot.kinematics import quaternion_of

Floats = NDArray[np.float64]

DOWN = np.diag((1.0, -1.0, -1.0))
"""The rotation of a tool that points straight down, with its x axis along that of the scene."""

TINY = 1e-12
"""The angle in radians below which a rotation is taken to have no axis."""


def vector_of_pose(pose: Floats) -> Floats:
    """Return the position in metres and the rotation vector in radians of a pose of shape (4, 4); shape (6,)."""
    return np.concatenate([pose[:3, 3], rotation_vector(pose[:3, :3] @ DOWN.T)])


def pose_from_vector(vector: Floats) -> Floats:
    """Return the pose whose position and rotation vector are the first six numbers; shape (4, 4)."""
    pose: Floats = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation(vector[3:6]) @ DOWN, vector[:3]
    return pose


def moved_pose(pose: Floats, motion: Floats) -> Floats:
    """Return a pose after a motion: a translation and a rotation vector along the axes of the scene; shape (4, 4)."""
    moved: Floats = pose.copy()
    moved[:3, :3], moved[:3, 3] = rotation(motion[3:6]) @ pose[:3, :3], pose[:3, 3] + motion[:3]
    return moved


def motion_between(one: Floats, two: Floats) -> Floats:
    """Return the motion by which `moved_pose` changes one pose into another; shape (6,)."""
    return np.concatenate([two[:3, 3] - one[:3, 3], rotation_vector(two[:3, :3] @ one[:3, :3].T)])


def rotation(vector: Floats) -> Floats:
    """Return the rotation matrix of a rotation vector, by Rodrigues' formula."""
    angle = float(np.linalg.norm(vector))
    if angle < TINY:
        return np.eye(3)
    x, y, z = (vector / angle).tolist()
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    result: Floats = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return result


def rotation_vector(turn: Floats) -> Floats:
    """Return the rotation vector of a rotation matrix, computed from its unit quaternion; its length is 0 to pi."""
    x, y, z, w = quaternion_of(turn.tolist())
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(sine, w) / sine if sine > TINY else 2.0
    return np.array([scale * x, scale * y, scale * z])
