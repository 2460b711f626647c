"""A bound on the width of every grasp of a body, for proofs that a gripper cannot hold it.

Theorem. Let each pad touch a face of a body made of convex parts, within the friction cone of the face. Let a be the
axis along which the pads close and w the distance between them. The angle between a and the outward normal of one face
is at most the friction angle phi, and so is the angle between -a and the normal of the other face: hence the angle
between the first normal and the opposite of the second is at most 2 phi. Contact points p and q on the two faces are at
most w apart along a and, perpendicular to a, at most the diagonal d of a pad apart. Therefore |p - q|² <= w² + d². If
all pairs of faces that are opposite to within 2 phi are farther apart than sqrt(o² + d²), no grasp has w <= o.

The distance between two triangles is at least the distance between their centroids minus both radii. Triangles are
divided until this bound is decisive, which takes few steps unless the body is close to the limit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.scene.scene import Shape
from prag_asp.scene.surfaces import mesh_states, part_surfaces

Floats = NDArray[np.float64]

MOST_PAIRS = 100_000
"""The maximum number of pairs of faces to examine; a body that needs more remains undecided."""

FLAT = 1e-6
"""The distance in metres by which a corner of a convex part may be outside a face, because numbers in files are
rounded."""


def is_never_spanned(shape: Shape, gripper: ParallelGripper, friction: float) -> bool:
    """Return whether `exceeds_opening` proves that a gripper cannot close around a body; the result is cached.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return _decided(shape, gripper, friction, mesh_states(shape))


@lru_cache(maxsize=256)
def _decided(shape: Shape, gripper: ParallelGripper, friction: float, files: tuple[tuple[int, int], ...]) -> bool:
    """Return whether the proof succeeds for a body; the cache key includes the states of its files."""
    return exceeds_opening(part_surfaces(shape), gripper, friction)


def exceeds_opening(parts: Sequence[Floats], gripper: ParallelGripper, friction: float) -> bool:
    """Return whether every grasp of a body is proved to be wider than the gripper can open.

    `parts` are the triangles of its convex parts, shape (n, 3, 3) in metres; `friction` is the coefficient between pad
    and body. False proves nothing: the body may be close to the limit, have too many faces, or have parts that are not
    convex.
    """
    if not all(map(_is_convex, parts)):
        return False
    limit = math.hypot(gripper.opening, 2 * gripper.half_x, gripper.high_z - gripper.low_z)
    triangles = np.concatenate(parts)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    if len(triangles) ** 2 > MOST_PAIRS:
        return False
    angle = 2 * math.atan(friction)
    facing = -normals @ normals.T >= math.cos(min(angle, math.pi)) - FLAT
    one, two = (triangles[index] for index in np.nonzero(np.triu(facing)))
    while len(one):
        apart = np.linalg.norm(one.mean(1) - two.mean(1), axis=1)
        if (apart <= limit).any():
            return False
        undecided = apart - _radii(one) - _radii(two) <= limit
        one, two = one[undecided], two[undecided]
        if 4 * len(one) > MOST_PAIRS:
            return False
        # The larger triangle of each pair is divided.
        larger = (_radii(one) >= _radii(two))[:, None, None]
        divided, other = np.where(larger, one, two), np.where(larger, two, one)
        one, two = _quarters(divided), np.tile(other, (4, 1, 1))
    return True


def _is_convex(part: Floats) -> bool:
    """Return whether no corner of a part is outside any of its faces."""
    normals = np.cross(part[:, 1] - part[:, 0], part[:, 2] - part[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    corners = np.unique(part.reshape(-1, 3), axis=0)
    offsets = np.einsum("ij,ij->i", normals, part[:, 0])
    return all(bool((corners @ normal <= offset + FLAT).all()) for normal, offset in zip(normals, offsets, strict=True))


def _radii(triangles: Floats) -> Floats:
    """Return, for each triangle, the maximum distance in metres from its centroid to its corners."""
    radii: Floats = np.linalg.norm(triangles - triangles.mean(1, keepdims=True), axis=2).max(1)
    return radii


def _quarters(triangles: Floats) -> Floats:
    """Divide each triangle into four triangles of half its size, shape (4 n, 3, 3)."""
    a, b, c = triangles.transpose(1, 0, 2)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    return np.concatenate([np.stack(each, 1) for each in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
