"""Antipodal grasps of a parallel gripper on the surface of a body.

A grasp is antipodal if the line between its two contacts lies in both friction cones; with soft fingers it is then in
force closure (Nguyen, "Constructing force-closure grasps", 1988). Candidates are sampled: a point of the surface, a
line through it within its friction cone, each point where the line leaves the body, and tool directions around it.
Each candidate is then judged by the exact contact of the closed pads (`ParallelGripper.contact`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.pads import TOUCH, PadContact, ParallelGripper
from prag_asp.scene.boxes import Box
from prag_asp.scene.geometry import Pose, compose, matrix
from prag_asp.scene.surfaces import in_frame

Floats = NDArray[np.float64]

POINTS = 400
"""The number of points of the surface at which grasps are sampled."""

DENSE = 4000
"""The number of points of the surface that must not be inside the hand: one every 4 mm on an object of 150 mm."""

TILTS = (0.0, 0.35, 0.7, 1.05, 1.4)
"""The angles to try between the tool's direction and straight down, in radians: from above to the side."""

CONE_SHARE = 0.6
"""The share of the friction angle that a sampled contact may use: the rest is for accelerations when lifting."""

FLATTER = (0.5, 0.95)
"""The shares of the cone's angle by which an axis is turned from the normal towards the horizontal."""

UPRIGHT = 1e-3
"""The slope in radians below which a normal is horizontal, and the cosine below which it is vertical."""

SMALLEST_PATCH = 6e-6
"""The minimum area of a contact in m²: 2 mm x 3 mm, a corner of a pad."""

OPPOSITE = 0.004
"""The maximum distance in metres between the centres of both contacts, parallel to the pads, so that they do not turn
the body."""

ROOM = 0.003
"""The distance in metres between open fingers and the body on each side when the hand descends."""

SOFT = 0.002
"""The depth in metres to which fingers may penetrate a held body: their rubber yields, and grasps are not exact."""

BELOW = 0.0005
"""The minimum distance of the fingertips from the plane on which the body stands, in metres."""

ENOUGH_POINTS, UNSURE = 8, 0.15
"""The minimum number of points between the pads to judge a contact before it is computed, and its error in cosine."""

MOST = (40, 40, 24)
"""The maximum numbers of distinct grasps to keep, the best of a body: from above, at a slant, and from the side."""

SLANTED, SIDEWAYS = 0.5, 1.2
"""The smallest angles between the tool's direction and straight down of slanted and of sideways grasps, in radians."""

PARALLEL = 1e-15
"""The triple product in m² of a triangle's sides and a unit vector below which both count as parallel."""

STEEP = -0.3
"""The tool's direction along z above which fingers are not lifted off the ground: they come from the side."""

LONG_LEVER, TILT_COST = 0.05, 0.3
"""The lever arm of the centre of mass in metres that lowers a score by 1, and the cost of a radian of tilt."""

UNBEARABLE = 1e6
"""The `sag` of a grasp whose contacts have no extent."""

ENOUGH_SLACK, WIDE_CONTACT = 0.01, 0.005
"""The room at a finger, and the radius of a contact, above which the score no longer rises, in metres."""

APART, TURNED = (0.008, 0.008, 0.03), (0.25, 0.25, 0.4)
"""The minimum distance in metres, or angle in radians, between the tools of distinct grasps of each of these kinds.

A hand has the least room from the side, where grasps from all directions are worth more than many from one.
"""


class Grasp(NamedTuple):
    """A way to hold a body.

    `tool` is the pose of the tool in the frame of the body; `width` the distance in metres between the pads in contact
    and `approach` that between the pads on the approach; `tilt` the angle between the tool's direction and straight
    down in radians; `lever` the horizontal distance in metres of the centre of mass from the line between the pads;
    `radius` the lever arm of friction about that line, in metres; `sag` the torque of the weight across that line, see
    `sag_of`; `score` is higher for better grasps.
    """

    tool: Pose
    width: float
    approach: float
    tilt: float
    lever: float
    radius: float
    sag: float
    score: float


class GraspProblem(NamedTuple):
    """The input for sampling grasps: a body's convex parts as triangles, its centre of mass, and friction.

    `parts` have the shape (n, 3, 3), in the body's frame in metres; z is up as the body stands. `friction` is the
    coefficient between pad and body.
    """

    parts: tuple[Floats, ...]
    centre: tuple[float, float, float]
    friction: float


def sampled_grasps(problem: GraspProblem, gripper: ParallelGripper) -> tuple[Grasp, ...]:
    """Return distinct grasps of a body, the most promising first; none if no sample is a grasp.

    The samples are fixed, so the same body has the same grasps.
    """
    rng = np.random.default_rng(0)
    triangles = np.concatenate(problem.parts)
    points, normals = _surface_points(problem.parts, POINTS, rng)
    # The same points as in `dense_points`, so that the check of a witness agrees.
    dense, facing = _surface_points(problem.parts, DENSE, np.random.default_rng(0))
    candidates: list[tuple[float, int, float, Floats, Floats]] = []
    for point, far, axis in _antipodal_pairs(points, normals, triangles, problem.friction, gripper.opening):
        middle = (point + far) / 2
        for tilt, rotation in _tools(axis):
            lever = middle - problem.centre
            lever -= (lever @ axis) * axis
            candidates.append(
                (
                    math.hypot(lever[0], lever[1]) / LONG_LEVER + TILT_COST * tilt,
                    len(candidates),
                    tilt,
                    middle,
                    rotation,
                )
            )
    kept, counts = list[Grasp](), [0] * len(MOST)
    for _, _, tilt, middle, rotation in sorted(candidates, key=lambda each: each[:2]):
        kind = (tilt >= SLANTED) + (tilt >= SIDEWAYS)
        if counts[kind] == MOST[kind]:
            continue
        place = _above_ground(gripper, triangles, middle, rotation)
        if place is None or not all(_differ(place, other.tool, kind) for other in kept):
            continue
        if not _promises(in_frame(dense[None], place)[0], facing @ matrix(place)[:3, 1], gripper, problem.friction):
            continue
        grasp = _judged(problem, gripper, triangles, dense, place, tilt)
        if grasp is not None and all(_differ(grasp.tool, other.tool, kind) for other in kept):
            kept.append(grasp)
            counts[kind] += 1
    return tuple(sorted(kept, key=lambda grasp: -grasp.score))


def _surface_points(parts: Sequence[Floats], number: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return points of the surface, evenly by area, and their outward normals, without those inside another part."""
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
    points: Floats, normals: Floats, triangles: Floats, friction: float, opening: float
) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Yield points of the surface, the points opposite to them, and the unit vectors from the latter to the former."""
    least = math.cos(CONE_SHARE * math.atan(friction))
    corner, one, two = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    facing = np.cross(one, two)
    facing /= np.linalg.norm(facing, axis=1)[:, None]
    rays = [(point, axis) for point, normal in zip(points, normals, strict=True) for axis in _axes(normal, least)]
    for point, normal in rays:
        # Möller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997.
        crossed = np.cross(-normal, two)
        scale = np.einsum("ij,ij->i", one, crossed)
        # A triangle parallel to the line is not hit: the distance along the line is then 0.
        scale[np.abs(scale) < PARALLEL] = math.inf
        offset = point - corner
        u = np.einsum("ij,ij->i", offset, crossed) / scale
        other = np.cross(offset, one)
        v = (other @ -normal) / scale
        way = np.einsum("ij,ij->i", two, other) / scale
        hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (way > 1e-5) & (way <= opening) & (facing @ -normal >= least)
        for length in sorted({round(float(each), 6) for each in way[hit]}):
            yield point, point - length * normal, normal


def _axes(normal: Floats, least: float) -> Iterator[Floats]:
    """Yield closing axes at a contact: its normal, and flatter axes within the cone of cosine `least`.

    The hand is broad along this axis: the flatter the axis, the farther the hand is from the ground.
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
    """Yield directions of the tool around an opening axis: the angle to straight down, and the axes as columns."""
    down = np.array([0.0, 0.0, -1.0])
    side = down - (down @ axis) * axis
    length = float(np.linalg.norm(side))
    if length < 1e-3:
        return
    side /= length
    across = np.cross(axis, side)
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
            yield angle, np.stack([np.cross(axis, direction), axis, direction], 1)


def _above_ground(gripper: ParallelGripper, triangles: Floats, middle: Floats, rotation: Floats) -> Pose | None:
    """Return the pose of a tool with its fingertips above the ground, moved back as far as necessary.

    None if the fingers of a tool from the side, or the palm, would be in the ground.
    """
    tips = min(
        z * rotation[2, 2] - np.abs(rotation[2]) @ (x_half, y + y_half + gripper.opening / 2, z_half)
        for (_, y, z), (x_half, y_half, z_half) in gripper.fingers
    )
    ground = float(triangles[:, :, 2].min()) + BELOW
    miss = ground - (middle[2] + tips)
    if miss > 0.0:
        if rotation[2, 2] > STEEP:
            return None
        middle = middle + miss / rotation[2, 2] * rotation[:, 2]
    centre, sides = gripper.palm
    if middle[2] + rotation[2] @ centre - np.abs(rotation[2]) @ sides < ground + ROOM:
        return None
    return Pose((float(middle[0]), float(middle[1]), float(middle[2])), _quaternion(rotation))


def _promises(points: Floats, facing: Floats, gripper: ParallelGripper, friction: float) -> bool:
    """Return whether surface points, in the frame of a tool, allow a grasp: a filter before the exact contact.

    `facing` are the components of the points' normals along the axis of the fingers.
    """
    if not _free(points, (gripper.palm,)):
        return False
    x, y, z = points.T
    low, high = gripper.low_z, gripper.high_z
    between = (np.abs(x) < gripper.half_x) & (z > low) & (z < high) & (np.abs(y) < gripper.opening / 2)
    if between.sum() < ENOUGH_POINTS:
        return True
    y, facing = y[between], facing[between]
    least = math.cos(CONE_SHARE * math.atan(friction)) - UNSURE
    for side in (1.0, -1.0):
        outermost = (side * y >= (side * y).max() - 2 * TOUCH) & (side * facing > 0.0)
        if not outermost.any() or (side * facing[outermost]).mean() < least:
            return False
    return True


def dense_points(parts: Sequence[Floats]) -> Floats:
    """Return points of the surface of a body that must not be inside the hand, shape (n, 3), in its frame in metres."""
    return _surface_points(parts, DENSE, np.random.default_rng(0))[0]


def open_width(points: Floats, gripper: ParallelGripper, tool: Pose, width: float) -> float | None:
    """Return the widest opening in metres at which the hand at a tool pose is free of a body, None if there is none.

    `points` are those of `dense_points`; `width` is that of the material between the pads.
    """
    return _widest(in_frame(points[None], tool)[0], gripper, width)


def hand_is_free(points: Floats, gripper: ParallelGripper, tool: Pose, width: float) -> bool:
    """Return whether the hand at a tool pose, with the pads `width` metres apart, penetrates a body by `SOFT` at most.

    `points` are those of `dense_points`.
    """
    return _free(in_frame(points[None], tool)[0], _soft_boxes(gripper, width))


def _soft_boxes(gripper: ParallelGripper, width: float) -> list[Box]:
    """Return the boxes of the hand with the pads `width` metres apart, shrunk by `SOFT` on every side."""
    return [
        (centre, (max(x - SOFT, 0.0), max(y - SOFT, 0.0), max(z - SOFT, 0.0)))
        for centre, (x, y, z) in gripper.boxes(width)
    ]


def _widest(points: Floats, gripper: ParallelGripper, width: float) -> float | None:
    """Return the widest opening in metres at which points in the hand's frame are outside it, None if there is none."""
    openings = (gripper.opening, width + 4 * ROOM, width + 2 * ROOM)
    return next((wide for wide in openings if wide <= gripper.opening and _free(points, gripper.boxes(wide))), None)


def _judged(
    problem: GraspProblem, gripper: ParallelGripper, triangles: Floats, dense: Floats, place: Pose, tilt: float
) -> Grasp | None:
    """Return the grasp with the pads at a place on the body, None if there is none."""
    contact = gripper.contact(in_frame(triangles, place))
    if contact is None or contact.width > gripper.opening - 2 * ROOM or not _holds(contact, problem.friction):
        return None
    tool = compose(place, Pose((0.0, (contact.low + contact.high) / 2, 0.0)))
    points = in_frame(dense[None], tool)[0]
    approach = _widest(points, gripper, contact.width)
    # Material beside the pads may block the fingers when they close.
    if approach is None or not _free(points, _soft_boxes(gripper, contact.width)):
        return None
    arm, radius = lever_of(problem.centre, tool, contact), contact.radius
    slack = min((gripper.opening - contact.width) / 2, ENOUGH_SLACK) / ENOUGH_SLACK
    flat = min(radius, WIDE_CONTACT) / WIDE_CONTACT
    score = flat + 0.5 * slack - arm / LONG_LEVER - TILT_COST * tilt + 0.2 * (approach == gripper.opening)
    return Grasp(tool, contact.width, approach, tilt, arm, radius, sag_of(problem.centre, tool, contact), score)


def sag_of(centre: tuple[float, float, float], tool: Pose, contact: PadContact) -> float:
    """Return the force of each finger that keeps a body from sagging, as a multiple of the body's weight.

    Gravity also turns a body that is gripped aside of its centre of mass about axes across the line between the pads:
    a bowl that is held at its rim. The pads do not turn about these axes. Their pressure moves to opposite edges of
    both contacts, which bears at most the force of a finger times the sum of half the extents of the contacts. `tool`
    is the pose of the tool in the frame of the upright body.
    """
    offset, rows = _offset(centre, tool, contact), matrix(tool)[:3, :3]
    # The torque of a weight of 1 N at the centre of mass, in the frame of the tool.
    x, _, z = rows.T @ np.cross(-offset, (0.0, 0.0, -1.0))
    torque = math.hypot(x, z)
    if torque == 0.0:
        return 0.0
    # Forces along y with arms along d turn about y x d.
    reach = sum(patch.half_extent(z / torque, -x / torque) for patch in contact.patches)
    return torque / reach if reach > 0.0 else UNBEARABLE


def _offset(centre: tuple[float, float, float], tool: Pose, contact: PadContact) -> Floats:
    """Return the vector from a centre of mass to the middle of the contacts of two pads, in the frame of the body."""
    x, z = ((a + b) / 2 for a, b in zip(contact.patches[0].centre, contact.patches[1].centre, strict=True))
    offset: Floats = np.array(compose(tool, Pose((x, 0.0, z))).position) - centre
    return offset


def lever_of(centre: tuple[float, float, float], tool: Pose, contact: PadContact) -> float:
    """Return the horizontal distance in metres from a centre of mass to the line between two pads.

    `tool` is the pose of the tool in the frame of the upright body; the distance is perpendicular to the line.
    """
    offset = _offset(centre, tool, contact)
    axis = matrix(tool)[:3, 1]
    offset -= (offset @ axis) * axis
    return math.hypot(offset[0], offset[1])


def _holds(contact: PadContact, friction: float) -> bool:
    """Return whether both contacts are large enough, within their friction cones, and opposite to each other."""
    one, two = contact.patches
    least = math.cos(CONE_SHARE * math.atan(friction))
    apart = math.hypot(one.centre[0] - two.centre[0], one.centre[1] - two.centre[1])
    return min(one.area, two.area) >= SMALLEST_PATCH and min(one.slope, two.slope) >= least and apart <= OPPOSITE


def _free(points: Floats, boxes: Sequence[Box]) -> bool:
    """Return whether no point is in one of the boxes, all in the frame of the tool.

    The hand approaches along its own direction, so the fingers sweep only the space of the fingers and the palm.
    """
    return not any(bool((np.abs(points - centre) < half).all(1).any()) for centre, half in boxes)


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


def _differ(one: Pose, two: Pose, kind: int) -> bool:
    """Return whether two tools differ enough in position or orientation for a kind of grasp.

    Half a turn about the tool's own axis does not count as a difference.
    """
    ax, ay, az, aw = one.quaternion
    bx, by, bz, bw = two.quaternion
    same = abs(ax * bx + ay * by + az * bz + aw * bw)
    # The other tool turned by half a turn about z has the quaternion (y, -x, w, -z).
    turned = abs(ax * by - ay * bx + az * bw - aw * bz)
    return (
        math.dist(one.position, two.position) > APART[kind] or 2 * math.acos(min(1.0, max(same, turned))) > TURNED[kind]
    )
