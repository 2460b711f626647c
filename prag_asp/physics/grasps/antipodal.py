"""Antipodal grasps of a body by a parallel gripper.

A grasp is antipodal if the line between its two contacts lies in both friction cones; with soft fingers it is then in
force closure (Nguyen, "Constructing force-closure grasps", 1988). Candidates are sampled: a point on the surface, a
line through it within its friction cone, each point where the line leaves the body, and directions of the tool around
the line. Each candidate is then judged by the exact contact of the closed pads (`ParallelGripper.contact`).

If there are few grasps from a direction, points on edges are sampled as well. Between a face and an edge, or between
two edges, a body is held less firmly than between two faces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.candidates import (
    CONE_SHARE,
    LONG_LEVER,
    ROOM,
    TILT_COST,
    Candidate,
    above_ground,
    grasp_candidates,
    surface_points,
)
from prag_asp.physics.grasps.pads import TOUCH, PadContact, ParallelGripper
from prag_asp.scene.boxes import Box
from prag_asp.scene.geometry import Pose, compose, matrix
from prag_asp.scene.surfaces import in_frame

Floats = NDArray[np.float64]

DENSE = 4000
"""The number of sampled surface points that must not be inside the hand; on an object of 150 mm, they are about 4 mm
apart."""

SMALLEST_PATCH = 6e-6
"""The minimum area of a contact in m²: 2 mm x 3 mm, a corner of a pad."""

OPPOSITE = 0.004
"""The maximum distance in metres between the centres of the two contacts, measured parallel to the pads, so that the
contacts do not turn the body."""

SOFT = 0.002
"""The depth in metres to which fingers may penetrate a held body: their rubber yields, and grasps are not exact."""

ENOUGH_POINTS, UNSURE = 8, 0.15
"""The minimum number of points between the pads for estimating a contact before it is computed, and the error of this
estimate as a cosine."""

MOST = (40, 40, 24)
"""The maximum number of distinct grasps of a body to keep, best first, for each kind: from above, at an angle, and from
the side."""

FEW = 8
"""The number of grasps at faces of each kind, below which grasps at edges are added."""

SLANTED, SIDEWAYS = 0.5, 1.2
"""The smallest angles, in radians, between the tool's direction and straight down for grasps at an angle and from the
side.
"""

ENOUGH_SLACK, WIDE_CONTACT = 0.01, 0.005
"""The clearance at a finger and the radius of a contact, in metres, above which the score no longer rises."""

APART, TURNED = (0.008, 0.008, 0.03), (0.25, 0.25, 0.4)
"""The minimum distance in metres, or angle in radians, between the tools of distinct grasps of each of these kinds.

A hand has the least room when it comes from the side, where grasps from all directions are worth more than many grasps
from one direction.
"""


class Grasp(NamedTuple):
    """A way to hold a body.

    `tool` is the pose of the tool in the frame of the body. `width` is the distance in metres between the pads when
    they are in contact, and `approach` is their distance during the approach. `tilt` is the angle in radians between
    the tool's direction and straight down, `lever` is the horizontal distance in metres from the centre of mass to the
    line between the pads, and `radius` is the lever arm of friction about that line, in metres. `score` is higher for
    better grasps. `at_edge` is set if a contact is at an edge.
    """

    tool: Pose
    width: float
    approach: float
    tilt: float
    lever: float
    radius: float
    score: float
    at_edge: bool = False


class GraspProblem(NamedTuple):
    """The input for sampling grasps: a body's convex parts as triangles, its centre of mass, and friction.

    `parts` have the shape (n, 3, 3), in the body's frame in metres; z points up when the body stands. `friction` is the
    coefficient between pad and body.
    """

    parts: tuple[Floats, ...]
    centre: tuple[float, float, float]
    friction: float


def sampled_grasps(problem: GraspProblem, gripper: ParallelGripper) -> tuple[Grasp, ...]:
    """Return distinct grasps of a body, most promising first; the result is empty if no sample yields one.

    The samples are fixed, so the same body has the same grasps.
    """
    triangles = np.concatenate(problem.parts)
    # the same points as in `dense_points`, so that the check of a witness agrees
    dense, facing = surface_points(problem.parts, DENSE, np.random.default_rng(0))
    lowest = float(triangles[:, :, 2].min())
    kept, counts = list[Grasp](), [0] * len(MOST)
    for at_edges in (False, True):
        most = [min(FEW, limit) if at_edges else limit for limit in MOST]
        if all(count >= limit for count, limit in zip(counts, most, strict=True)):
            break
        for candidate in grasp_candidates(problem.parts, problem.centre, problem.friction, gripper.opening, at_edges):
            tilt = candidate.tilt
            kind = (tilt >= SLANTED) + (tilt >= SIDEWAYS)
            if counts[kind] >= most[kind]:
                continue
            place = above_ground(gripper, lowest, candidate.middle, candidate.rotation)
            if place is None or not _is_distinct(place, kept, kind):
                continue
            if not _promises(in_frame(dense[None], place)[0], facing, place, gripper, problem.friction, at_edges):
                continue
            grasp = _judged(problem, gripper, triangles, dense, place, candidate)
            if grasp is not None and _is_distinct(grasp.tool, kept, kind):
                kept.append(grasp)
                counts[kind] += 1
    return tuple(sorted(kept, key=lambda grasp: (grasp.at_edge, -grasp.score)))


def _promises(
    points: Floats, normals: Floats, tool: Pose, gripper: ParallelGripper, friction: float, at_edge: bool
) -> bool:
    """Return whether surface points, in the frame of a tool, may allow a grasp, before the exact contact is computed.

    `normals` are the normals of the points in the frame of the body; at an edge, they decide nothing.
    """
    if not _free(points, (gripper.palm,)):
        return False
    x, y, z = points.T
    low, high = gripper.low_z, gripper.high_z
    between = (np.abs(x) < gripper.half_x) & (z > low) & (z < high) & (np.abs(y) < gripper.opening / 2)
    if at_edge or between.sum() < ENOUGH_POINTS:
        return True
    y, facing = y[between], (normals @ matrix(tool)[:3, 1])[between]
    least = math.cos(CONE_SHARE * math.atan(friction)) - UNSURE
    for side in (1.0, -1.0):
        outermost = (side * y >= (side * y).max() - 2 * TOUCH) & (side * facing > 0.0)
        if not outermost.any() or (side * facing[outermost]).mean() < least:
            return False
    return True


def dense_points(parts: Sequence[Floats]) -> Floats:
    """Return the surface points of a body that must not be inside the hand, shape (n, 3), in its frame in metres."""
    return surface_points(parts, DENSE, np.random.default_rng(0))[0]


def open_width(points: Floats, gripper: ParallelGripper, tool: Pose, width: float) -> float | None:
    """Return the widest opening in metres at which the hand does not penetrate a body, or None if there is none.

    `points` are the points of `dense_points`; `width` is the width of the material between the pads.
    """
    return _widest(in_frame(points[None], tool)[0], gripper, width)


def hand_is_free(points: Floats, gripper: ParallelGripper, tool: Pose, width: float) -> bool:
    """Return whether the hand, in a tool pose with the pads `width` metres apart, penetrates a body by at most `SOFT`.

    `points` are the points of `dense_points`.
    """
    return _free(in_frame(points[None], tool)[0], _soft_boxes(gripper, width))


def _soft_boxes(gripper: ParallelGripper, width: float) -> list[Box]:
    """Return the boxes of the hand with the pads `width` metres apart, shrunk by `SOFT` on every side."""
    return [
        (centre, (max(x - SOFT, 0.0), max(y - SOFT, 0.0), max(z - SOFT, 0.0)))
        for centre, (x, y, z) in gripper.boxes(width)
    ]


def _widest(points: Floats, gripper: ParallelGripper, width: float) -> float | None:
    """Return the widest opening in metres at which given points are outside the hand, or None if there is none."""
    openings = (gripper.opening, width + 4 * ROOM, width + 2 * ROOM)
    return next((wide for wide in openings if wide <= gripper.opening and _free(points, gripper.boxes(wide))), None)


def _judged(
    problem: GraspProblem, gripper: ParallelGripper, triangles: Floats, dense: Floats, place: Pose, candidate: Candidate
) -> Grasp | None:
    """Return the grasp at a tool pose `place`, or None if the pads cannot grasp the body there."""
    contact = gripper.contact(in_frame(triangles, place))
    if contact is None or contact.width > gripper.opening - 2 * ROOM:
        return None
    if not _holds(contact, problem.friction, candidate.at_edge):
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
    score = flat + 0.5 * slack - arm / LONG_LEVER - TILT_COST * candidate.tilt + 0.2 * (approach == gripper.opening)
    return Grasp(tool, contact.width, approach, candidate.tilt, arm, radius, score, candidate.at_edge)


def lever_of(centre: tuple[float, float, float], tool: Pose, contact: PadContact) -> float:
    """Return the torque of the weight of an upright body about the line between two pads, per newton, in metres.

    `tool` is the pose of the tool in the frame of the body. If the line is horizontal, the result is its horizontal
    distance from the centre of mass. If the line is inclined, the result is only the component of the torque along it;
    the other component tilts the body, see `tilting.py`.
    """
    x, z = ((a + b) / 2 for a, b in zip(contact.patches[0].centre, contact.patches[1].centre, strict=True))
    offset = np.array(compose(tool, Pose((x, 0.0, z))).position) - centre
    axis = matrix(tool)[:3, 1]
    return abs(float(offset[0] * axis[1] - offset[1] * axis[0]))


def _holds(contact: PadContact, friction: float, at_edge: bool) -> bool:
    """Return whether both contacts are large enough, within their friction cones, and opposite to each other."""
    one, two = contact.patches
    least = math.cos(CONE_SHARE * math.atan(friction))
    cosines = contact.cosines(friction) if at_edge else (one.slope, two.slope)
    return min(one.area, two.area) >= SMALLEST_PATCH and min(cosines) >= least and contact.offset <= OPPOSITE


def _free(points: Floats, boxes: Sequence[Box]) -> bool:
    """Return whether no point is in any of the boxes; all are in the frame of the tool.

    The hand approaches along its own direction, so the fingers sweep only the space of the fingers and the palm.
    """
    x, y, z = points.T
    for (a, b, c), (half_x, half_y, half_z) in boxes:
        near = np.flatnonzero(np.abs(z - c) < half_z)
        if len(near) and ((np.abs(x[near] - a) < half_x) & (np.abs(y[near] - b) < half_y)).any():
            return False
    return True


def _is_distinct(tool: Pose, kept: Sequence[Grasp], kind: int) -> bool:
    """Return whether a tool pose differs enough from those of the grasps found so far, for a given kind of grasp.

    Half a turn of the tool about its axis does not count as a difference.
    """
    ax, ay, az, aw = tool.quaternion
    for grasp in kept:
        if math.dist(tool.position, grasp.tool.position) <= APART[kind]:
            bx, by, bz, bw = grasp.tool.quaternion
            same = abs(ax * bx + ay * by + az * bz + aw * bw)
            # After half a turn about z, the other tool has the quaternion (y, -x, w, -z).
            turned = abs(ax * by - ay * bx + az * bw - aw * bz)
            if 2 * math.acos(min(1.0, max(same, turned))) <= TURNED[kind]:
                return False
    return True
