"""Candidates for antipodal grasps: points on a surface, the points opposite to them, and tools around their line."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.edges import edge_pairs
from prag_asp.physics.grasps.pads import ParallelGripper, crossed
from prag_asp.physics.grasps.surface_rays import SurfaceRays
from prag_asp.scene.geometry import Pose

Floats = NDArray[np.float64]

POINTS = 400
"""The number of points on the surface at which grasps are sampled."""

TILTS = (0.0, 0.35, 0.7, 1.05, 1.4)
"""The angles to try between the tool's direction and straight down, in radians: from above to the side."""

CONE_SHARE = 0.6
"""The share of the friction angle that a sampled contact may use; the rest is left for accelerations when lifting."""

FLATTER = (0.5, 0.95)
"""The angles by which an axis is turned from the normal towards the horizontal, as shares of the cone's half-angle."""

UPRIGHT = 1e-3
"""The slope in radians below which a normal is horizontal, and the cosine below which it is vertical."""

STEEP = -0.3
"""The component of the tool's direction along z above which fingers come from the side and are not lifted off the
ground."""

ROOM = 0.003
"""The distance in metres on each side between the open fingers and the body when the hand descends."""

BELOW = 0.0005
"""The minimum distance of the fingertips from the plane on which the body stands, in metres."""

LONG_LEVER, TILT_COST = 0.05, 0.3
"""The lever arm of the centre of mass, in metres, that lowers a score by 1, and the cost of a radian of tilt."""


class Candidate(NamedTuple):
    """A candidate for a grasp: its cost and number, which determine the order of attempts, and the place of the tool.

    `tilt` is the angle between the tool's direction and straight down, in radians; `middle` (3,) is the point midway
    between the contacts, in metres; `rotation` (3, 3) has the axes of the tool as columns. All are in the frame of the
    body. `at_edge` is set if a contact is at an edge.
    """

    cost: float
    number: int
    tilt: float
    middle: Floats
    rotation: Floats
    at_edge: bool = False


def grasp_candidates(
    parts: Sequence[Floats], centre: tuple[float, float, float], friction: float, opening: float, at_edges: bool = False
) -> list[Candidate]:
    """Return candidates for grasps of a body, at faces or `at_edges`, most promising first; the samples are fixed.

    `parts` (n, 3, 3) are the convex parts of the body as triangles, and `centre` is the centre of mass, in the body's
    frame in metres; `friction` is the coefficient between pad and body, and `opening` is the opening of the gripper in
    metres.
    """
    least, rays = math.cos(CONE_SHARE * math.atan(friction)), SurfaceRays(np.concatenate(parts))
    if at_edges:
        pairs = edge_pairs(parts, rays, least, opening)
    else:
        points, normals = surface_points(parts, POINTS, np.random.default_rng(0))
        pairs = _antipodal_pairs(points, normals, rays, least, opening)
    candidates: list[Candidate] = []
    for point, far, axis in pairs:
        middle = (point + far) / 2
        lever = middle - centre
        lever -= (lever @ axis) * axis
        leverage = math.hypot(lever[0], lever[1]) / LONG_LEVER
        for tilt, rotation in _tools(axis):
            candidates.append(Candidate(leverage + TILT_COST * tilt, len(candidates), tilt, middle, rotation, at_edges))
    return sorted(candidates, key=lambda each: each[:2])


def surface_points(parts: Sequence[Floats], number: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return points sampled evenly on the surface, except those inside other parts, and their outward normals."""
    owners = np.concatenate([np.full(len(part), i) for i, part in enumerate(parts)])
    triangles = np.concatenate(parts)
    crossed = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.linalg.norm(crossed, axis=1)
    steps = (np.arange(number) + rng.random(number)) / number
    chosen = np.searchsorted(np.cumsum(lengths) / lengths.sum(), steps)
    chosen = np.minimum(chosen, len(triangles) - 1)
    one, two = np.sqrt(rng.random(number)), rng.random(number)
    shares = np.stack([1 - one, one * (1 - two), one * two], 1)
    points = np.einsum("ij,ijk->ik", shares, triangles[chosen])
    normals = crossed[chosen] / lengths[chosen, None]
    free = np.ones(number, bool)
    for i, part in enumerate(parts):
        planes = np.cross(part[:, 1] - part[:, 0], part[:, 2] - part[:, 0])
        planes /= np.linalg.norm(planes, axis=1)[:, None]
        depth = (points @ planes.T - np.einsum("ij,ij->i", planes, part[:, 0])).max(1)
        free &= (owners[chosen] == i) | (depth > -1e-6)
    return points[free], normals[free]


def _antipodal_pairs(
    points: Floats, normals: Floats, rays: SurfaceRays, least: float, opening: float
) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Yield surface points, each with an opposite point and the unit vector from the opposite point to it."""
    for point, normal in zip(points, normals, strict=True):
        for axis in _axes(normal, least):
            for length in rays.lengths(point, -axis, least, opening):
                yield point, point - length * axis, axis


def _axes(normal: Floats, least: float) -> Iterator[Floats]:
    """Yield closing axes at a contact: the normal, and flatter axes in a cone; `least` is the cosine of its half-angle.

    The hand is broad along this axis, so the flatter the axis is, the farther the hand is from the ground.
    """
    yield normal
    flat, slope = math.hypot(normal[0], normal[1]), math.asin(max(-1.0, min(1.0, float(normal[2]))))
    if flat < UPRIGHT or abs(slope) < UPRIGHT:
        return
    for share in FLATTER:
        left = max(0.0, abs(slope) - share * math.acos(least))
        turned = math.copysign(left, slope)
        yield np.array([*(normal[:2] / flat * math.cos(turned)), math.sin(turned)])
        if left == 0.0:
            return


def _tools(axis: Floats) -> Iterator[tuple[float, Floats]]:
    """Yield directions of the tool around an opening axis: the angle from straight down, and the axes as columns."""
    down = np.array([0.0, 0.0, -1.0])
    side = down - (down @ axis) * axis
    length = float(np.linalg.norm(side))
    if length < 1e-3:
        return
    side /= length
    across = crossed(axis, side)
    steepest = math.acos(min(1.0, length))
    for tilt in TILTS:
        if tilt < steepest and tilt + 0.35 > steepest:
            turns = {0.0}
        elif tilt >= steepest:
            turn = math.acos(min(1.0, math.cos(tilt) / length))
            turns = {turn, -turn}
        else:
            continue
        for turn in sorted(turns):
            direction = math.cos(turn) * side + math.sin(turn) * across
            angle = math.acos(max(-1.0, min(1.0, -float(direction[2]))))
            yield angle, np.ascontiguousarray(np.array([crossed(axis, direction), axis, direction]).T)


def above_ground(gripper: ParallelGripper, lowest: float, middle: Floats, rotation: Floats) -> Pose | None:
    """Return the pose of a tool, moved back as far as necessary for its fingertips to be above the ground.

    `lowest` is the height of the ground in metres. The result is None if the palm, or fingers that come from the side,
    would be in the ground.
    """
    slope = np.abs(rotation[2])
    tips = min(
        z * rotation[2, 2] - slope @ (x_half, y + y_half + gripper.opening / 2, z_half)
        for (_, y, z), (x_half, y_half, z_half) in gripper.fingers
    )
    ground = lowest + BELOW
    miss = ground - (middle[2] + tips)
    if miss > 0.0:
        if rotation[2, 2] > STEEP:
            return None
        middle = middle + miss / rotation[2, 2] * rotation[:, 2]
    centre, sides = gripper.palm
    if middle[2] + rotation[2] @ centre - slope @ sides < ground + ROOM:
        return None
    return Pose((float(middle[0]), float(middle[1]), float(middle[2])), _quaternion(rotation))


def _quaternion(rotation: Floats) -> tuple[float, float, float, float]:
    """Return a rotation matrix as a quaternion, computed from its largest component (Shepperd, 1978)."""
    trace = rotation.trace()
    squares = [1 + 2 * rotation[i, i] - trace for i in range(3)] + [1 + trace]
    k = int(np.argmax(squares))
    if k == 3:
        parts = [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
            squares[3],
        ]
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        parts = [0.0, 0.0, 0.0, rotation[j, i] - rotation[i, j]]
        parts[k], parts[i], parts[j] = squares[k], rotation[i, k] + rotation[k, i], rotation[j, k] + rotation[k, j]
    x, y, z, w = (np.array(parts) / np.linalg.norm(parts)).tolist()
    return (x, y, z, w)
