"""A bound on the width of every grasp of a body, for proofs that a gripper cannot hold it.

Theorem. Let a body consist of convex parts, and call their faces, edges and corners features. Let phi be the angle of
friction between body and pads, d the diagonal of a pad, and o the opening of the gripper. Call two features opposite if
their normal cones contain unit vectors m and n such that the angle between m and -n is at most 2 phi; a feature may be
opposite to itself. If the distance between any two opposite features is greater than sqrt(o² + d²), the gripper cannot
hold the body: in every grasp, the pads are more than o apart.

Proof. In a grasp, let a be the closing axis, w the distance between the pads, and p and q points at which the pads
touch the body, on two features. The normals m and n of these contacts are in the normal cones of the features. By
Coulomb's law, the angle between a and m is at most phi, and so is the angle between -a and n. The angle between m and
-n is therefore at most 2 phi, so the two features are opposite. The points p and q are at most w apart along a and at
most d apart perpendicular to a, so |p - q|² <= w² + d². As the features are farther apart than sqrt(o² + d²), it
follows that w > o.

The distance between two triangles is at least the gap between them along any line, such as the line through their
centroids. Triangles are divided until this bound is decisive, which takes few steps unless the body is close to the
limit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.normal_cones import Feature, angle_between, caps, edges_and_corners, unit_normals
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.scene.scene import Shape
from prag_asp.scene.surfaces import mesh_states, part_surfaces

Floats = NDArray[np.float64]

MOST_PAIRS = 100_000
"""The maximum number of pairs of faces to examine; a body that needs more remains undecided."""

MOST_CONES = 4_000
"""The maximum number of pairs of normal cones to compare, which takes about a second."""

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
    angle = min(2 * math.atan(friction), math.pi)
    triangles = np.concatenate(parts)
    if len(triangles) ** 2 > MOST_PAIRS:
        return False
    normals = unit_normals(triangles)
    facing = -normals @ normals.T >= math.cos(angle) - FLAT
    one, two = np.nonzero(np.triu(facing))
    return _all_apart(triangles[one], triangles[two], limit) and _edges_apart(
        [Feature(*face) for face in zip(triangles, normals[:, None], strict=True)],
        [feature for part in parts for feature in edges_and_corners(part)],
        limit,
        angle,
    )


def _edges_apart(faces: list[Feature], edges: list[Feature], limit: float, angle: float) -> bool:
    """Return whether each edge and corner is farther than a limit from every feature that is opposite to it."""
    features = edges + faces
    places = np.array([feature.place for feature in features])
    centres, radii, (axes, widths) = places.mean(1), _radii(places), caps(features)
    one, two = np.triu_indices(len(edges), 0, len(features))
    # Cheap bounds exclude most pairs, so that few cones must be compared.
    near = np.linalg.norm(centres[one] - centres[two], axis=1) - radii[one] - radii[two] <= limit
    one, two = one[near], two[near]
    opposite = -np.einsum("ij,ij->i", axes[one], axes[two])
    facing = np.arccos(np.clip(opposite, -1, 1)) - widths[one] - widths[two] <= angle + FLAT
    one, two = one[facing], two[facing]
    if len(one) > MOST_CONES:
        return False
    return all(
        _all_apart(places[i][None], places[j][None], limit)
        for i, j in zip(one, two, strict=True)
        if angle_between(features[i].normals, -features[j].normals) <= angle + FLAT
    )


def _all_apart(one: Floats, two: Floats, limit: float) -> bool:
    """Return whether the triangles of each pair are proved to be farther apart than a limit in metres."""
    while len(one):
        lines = two.mean(1) - one.mean(1)
        apart = np.linalg.norm(lines, axis=1)
        if (apart <= limit).any():
            return False
        lines /= apart[:, None]
        gaps = np.einsum("ijk,ik->ij", two, lines).min(1) - np.einsum("ijk,ik->ij", one, lines).max(1)
        undecided = gaps <= limit
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
    normals = unit_normals(part)
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
