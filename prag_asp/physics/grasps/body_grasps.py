"""The grasps of bodies with a model, computed once for each body and gripper, and cached in memory and on disk."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.output.cache_files import cache_folder, read_cached, write_cached
from prag_asp.physics.grasps.antipodal import (
    Grasp,
    GraspProblem,
    dense_points,
    hand_is_free,
    lever_of,
    open_width,
    sampled_grasps,
)
from prag_asp.physics.grasps.pads import PadContact, ParallelGripper
from prag_asp.scene.geometry import Pose, matrix
from prag_asp.scene.scene import Shape
from prag_asp.scene.surfaces import in_frame, mesh_states, part_surfaces, surface

FORM = 6
"""The version of the search and of its files; cached grasps of other versions are not read."""

LARGEST_FILE = 1_000_000
"""The largest size in bytes of a file of grasps, which is ample for all grasps of a body."""

SUFFIX = ".grasps"


def body_grasps(shape: Shape, gripper: ParallelGripper, friction: float) -> tuple[Grasp, ...]:
    """Return the grasps of a body with a model, in the frame of the body, best first.

    `friction` is the coefficient between pad and body.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return _grasps(shape, gripper, friction, mesh_states(shape))


class GraspTable(NamedTuple):
    """The grasps of a body as arrays: poses of the tool as matrices (n, 4, 4) and quaternions (4, n), and scores (n,).

    `loads` (n,) are the factors by which the levers of the grasps raise the loads; see `grip_load`. `at_edge` (n,) are
    the grasps with a contact at an edge.
    """

    frames: NDArray[np.float64]
    quaternions: NDArray[np.float64]
    scores: NDArray[np.float64]
    loads: NDArray[np.float64]
    at_edge: NDArray[np.bool_]


def grasp_table(shape: Shape, gripper: ParallelGripper, friction: float) -> GraspTable:
    """Return the grasps of `body_grasps`, in the same order, as arrays.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return _table(shape, gripper, friction, mesh_states(shape))


def pad_contact(shape: Shape, gripper: ParallelGripper, tool: Pose) -> PadContact | None:
    """Return the contact of the pads when they close on a body, or None if there is nothing between them.

    `tool` is the pose of the tool in the frame of the body.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return _contact(shape, gripper, tool, mesh_states(shape))


def free_opening(shape: Shape, gripper: ParallelGripper, tool: Pose, width: float) -> float | None:
    """Return the widest opening in metres at which the fingers around a held body do not penetrate it.

    The result is None if the fingers cannot release the body. `width` is the width of the material between the pads.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return open_width(_dense_points(shape, mesh_states(shape)), gripper, tool, width)


def is_hand_free(shape: Shape, gripper: ParallelGripper, tool: Pose, width: float) -> bool:
    """Return whether neither a finger nor the palm penetrates the held body deeper than the rubber of the pads yields.

    `tool` is the pose of the tool in the frame of the body, and `width` is the distance between the pads in metres.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return hand_is_free(_dense_points(shape, mesh_states(shape)), gripper, tool, width)


@lru_cache(maxsize=256)
def _grasps(
    shape: Shape, gripper: ParallelGripper, friction: float, files: tuple[tuple[int, int], ...]
) -> tuple[Grasp, ...]:
    """Return the grasps of a body; the cache key includes the states of its files."""
    problem, folder = _problem(shape, friction), cache_folder()
    if folder is None:
        return sampled_grasps(problem, gripper)
    key = hashlib.sha256(repr((FORM, gripper, friction, problem.centre)).encode())
    for part in problem.parts:
        key.update(part.tobytes())
    path = folder / f"{key.hexdigest()}{SUFFIX}"
    content = read_cached(path, LARGEST_FILE)
    if content is not None:
        return tuple(map(_grasp, json.loads(content)))
    grasps = sampled_grasps(problem, gripper)
    write_cached(path, json.dumps([grasp._asdict() for grasp in grasps]).encode())
    return grasps


@lru_cache(maxsize=256)
def _table(shape: Shape, gripper: ParallelGripper, friction: float, files: tuple[tuple[int, int], ...]) -> GraspTable:
    """Return the grasps of a body as arrays; the cache key includes the states of its files."""
    grasps = _grasps(shape, gripper, friction, files)
    levers = [grasp.lever / grasp.radius if grasp.radius > 0.0 else np.inf for grasp in grasps]
    return GraspTable(
        np.array([matrix(grasp.tool) for grasp in grasps]).reshape(-1, 4, 4),
        np.array([grasp.tool.quaternion for grasp in grasps]).reshape(-1, 4).T,
        np.array([grasp.score for grasp in grasps]),
        np.hypot(1.0, levers),
        np.array([grasp.at_edge for grasp in grasps], dtype=bool),
    )


def _grasp(row: Mapping[str, Any]) -> Grasp:
    """Make a grasp from its fields in a file."""
    position, quaternion = row["tool"]
    return Grasp(**{**row, "tool": Pose(tuple(position), tuple(quaternion))})


def _problem(shape: Shape, friction: float) -> GraspProblem:
    """Return the geometry of a body from which its grasps are sampled."""
    return GraspProblem(part_surfaces(shape), _centre(shape), friction)


def lever(shape: Shape, tool: Pose, contact: PadContact) -> float:
    """Return the torque of the weight of a body about the line between the pads, per newton, in metres.

    `tool` is the pose of the tool in the frame of the body, which is upright.
    """
    return lever_of(_centre(shape), tool, contact)


def _centre(shape: Shape) -> tuple[float, float, float]:
    """Return the centre of mass of a body in its frame, in metres."""
    return (0.0, 0.0, 0.0) if shape.model is None else shape.model.centre


@lru_cache(maxsize=64)
def _dense_points(shape: Shape, files: tuple[tuple[int, int], ...]) -> NDArray[np.float64]:
    """Return the points of a body that must not be in the hand; the cache key includes the states of its files."""
    return dense_points(part_surfaces(shape))


@lru_cache(maxsize=1 << 10)
def _contact(
    shape: Shape, gripper: ParallelGripper, tool: Pose, files: tuple[tuple[int, int], ...]
) -> PadContact | None:
    """Return the contact of the pads; the cache key includes the states of the body's files."""
    return gripper.contact(in_frame(surface(shape), tool))
