"""The pads and fingers of a parallel gripper, and the material between them, in the frame of the tool.

The tool's origin is the point between the pads, z points along the fingers towards their tips, and y is the axis along
which they open.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.normal_cones import angle_between, distinct_normals
from prag_asp.scene.boxes import Box, box_between
from prag_asp.scene.robots import Robot

Floats = NDArray[np.float64]

PALM = (0.063, 0.204, 0.066)
"""The dimensions in metres of the palm (Franka's) of a robot that has no `hand` in its description."""

TOUCH = 0.001
"""The depth in metres to which the rubber of a pad yields: material this close to the outermost point is in contact."""


TINY = 1e-15
"""The threshold below which sums of areas, in m², and lengths of normals count as zero."""

OUTERMOST, PLACES = 1e-6, 8
"""The distance in metres within which points are outermost, or equal, and the maximum number of outermost points to
examine."""

FACING = 0.9999
"""The cosine between a pad and a face from which the pad lies flat on the face."""


class PadContact(NamedTuple):
    """The contact of the closed pads: the interval that the material covers along y, in metres, and both patches."""

    low: float
    high: float
    patches: tuple[PadPatch, PadPatch]

    @property
    def width(self) -> float:
        """The distance between the pads in metres."""
        return self.high - self.low

    @property
    def radius(self) -> float:
        """The smaller radius of gyration of the two patches in metres, which is the lever arm of their friction."""
        return min(patch.gyration for patch in self.patches)

    @property
    def offset(self) -> float:
        """The distance in metres between the centres of the two patches, measured parallel to the pads."""
        return math.dist(self.patches[0].centre, self.patches[1].centre)

    def cosines(self, friction: float) -> tuple[float, float]:
        """Return, for each pad, the cosine of the angle between the closing axis and the normal of the contact.

        At an edge or a corner, the normal is the direction in its normal cone that is nearest to the axis. Pads hold a
        body there only if the line between both contacts is in the friction cones of the pads; otherwise, and at faces,
        the mean normal of the surface counts.
        """
        one, two = self.patches
        if self.offset > friction * self.width:
            return one.slope, two.slope
        return max(one.slope, one.edge), max(two.slope, two.edge)


class PadPatch(NamedTuple):
    """The patch of one pad: its area in m², centroid (x, z) in m, radius of gyration in m, and normals.

    `slope` is the mean cosine of the angle between the outward normal and the direction in which the pad lies. `edge`
    is the largest cosine between this direction and a vector in the normal cone of an outermost point of the patch: it
    is 1 at an edge or a corner that a flat pad touches.
    """

    area: float
    centre: tuple[float, float]
    gyration: float
    slope: float
    edge: float = 0.0


class ParallelGripper(NamedTuple):
    """The dimensions of a parallel gripper in metres: half of a pad along x, its ends along z, and the opening.

    `fingers` are the boxes of the finger on the side of positive y when the gripper is closed, and `palm` is the box of
    the hand; all are in the frame of the tool.
    """

    half_x: float
    low_z: float
    high_z: float
    opening: float
    fingers: tuple[Box, ...]
    palm: Box

    @staticmethod
    def of(robot: Robot) -> ParallelGripper:
        """Return the gripper of a robot."""
        pad = robot.finger_boxes[0]
        offset = robot.fingertip - pad.at[2] - pad.size[2] / 2
        fingers = tuple(
            (
                (solid.at[0], solid.at[1], solid.at[2] + offset),
                (solid.size[0] / 2, solid.size[1] / 2, solid.size[2] / 2),
            )
            for solid in robot.finger_boxes
        )
        x, y, z = PALM if robot.hand is None else robot.hand.palm
        palm = box_between((-x / 2, x / 2), (-y / 2, y / 2), (-robot.finger_depth - z, -robot.finger_depth))
        low, high = robot.fingertip - pad.size[2], robot.fingertip
        return ParallelGripper(pad.size[0] / 2, low, high, robot.opening, fingers, palm)

    def boxes(self, width: float) -> tuple[Box, ...]:
        """Return the boxes of both fingers and the palm with the pads `width` metres apart."""
        fingers = [((x, side * (y + width / 2), z), half) for (x, y, z), half in self.fingers for side in (1.0, -1.0)]
        return (*fingers, self.palm)

    def contact(self, triangles: Floats) -> PadContact | None:
        """Return the contact of the pads when they close on a body, or None if there is nothing between them.

        `triangles`, shape (n, 3, 3), form the surface of the body in the frame of the tool, in metres. The interval is
        exact for this surface: its triangles are clipped to the prism that the pads sweep.
        """
        polygons = self.between(triangles)
        if not len(polygons.corners):
            return None
        ends = float(polygons.corners[:, :, 1].min()), float(polygons.corners[:, :, 1].max())
        return PadContact(*ends, (polygons.patch(ends[0], -1.0), polygons.patch(ends[1], 1.0)))

    def between(self, triangles: Floats) -> Polygons:
        """Return the parts of triangles (n, 3, 3) in the prism that the pads sweep, in the frame of the tool."""
        low = np.array([-self.half_x, -self.opening / 2, self.low_z])
        high = np.array([self.half_x, self.opening / 2, self.high_z])
        one, two, three = triangles[:, 0], triangles[:, 1], triangles[:, 2]
        lowest, highest = (end(end(one, two), three) for end in (np.minimum, np.maximum))
        triangles = triangles[((lowest <= high) & (highest >= low)).all(1)]
        normals = crossed(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        polygons = Polygons(triangles, normals / np.maximum(np.linalg.norm(normals, axis=1), TINY)[:, None])
        for axis in range(3):
            polygons = polygons.cut(axis, 1.0, high[axis]).cut(axis, -1.0, -low[axis])
        return polygons


class Polygons(NamedTuple):
    """Convex polygons with their unit normals; `corners` has the shape (n, m, 3).

    If a polygon has fewer than m corners, its last corner is repeated.
    """

    corners: Floats
    normals: Floats

    def cut(self, axis: int, sign: float, end: float) -> Polygons:
        """Return the polygons, cut to ``sign * coordinate <= end`` along an axis (Sutherland and Hodgman, 1974)."""
        corners, normals = self.corners, self.normals
        depth = end - sign * corners[:, :, axis]
        inside = depth >= 0.0
        some = inside.any(1)
        if not some.all():
            corners, normals, depth, inside = corners[some], normals[some], depth[some], inside[some]
        if inside.all():
            return Polygons(corners, normals)
        # The corner that follows each corner; for so few corners, np.roll and np.stack take twice the time.
        following, after = (np.concatenate([each[:, 1:], each[:, :1]], 1) for each in (corners, depth))
        crossing = inside != (after >= 0.0)
        share = np.where(crossing, depth / np.where(crossing, depth - after, 1.0), 0.0)
        points = np.empty((*depth.shape, 2, 3))
        points[:, :, 0] = corners
        points[:, :, 1] = corners + share[:, :, None] * (following - corners)
        used = np.empty((*depth.shape, 2), np.bool_)
        used[:, :, 0], used[:, :, 1] = inside, crossing
        points, used = points.reshape(len(corners), -1, 3), used.reshape(len(corners), -1)
        order = np.argsort(~used, axis=1, kind="stable")
        counts = used.sum(1)
        places = np.minimum(np.arange(counts.max(initial=1)), counts[:, None] - 1)
        chosen = order[np.arange(len(order))[:, None], places]
        return Polygons(points[np.arange(len(order))[:, None], chosen], normals)

    def patch(self, end: float, side: float) -> PadPatch:
        """Return the patch of a pad on one side: the surface facing it within `TOUCH` of the outermost point."""
        corners, normals = self.touched(end, side)
        flat, facing = corners[:, :, [0, 2]], side * normals[:, 1]
        if flat.shape[1] < 3:
            return PadPatch(0.0, (0.0, 0.0), 0.0, 0.0)
        first = np.broadcast_to(flat[:, :1], flat[:, 1:-1].shape)
        fans = np.stack([first, flat[:, 1:-1], flat[:, 2:]], 2)
        slopes = np.broadcast_to(facing[:, None], fans.shape[:2]).ravel()
        fans = fans.reshape(-1, 3, 2)
        one, two = fans[:, 1] - fans[:, 0], fans[:, 2] - fans[:, 0]
        areas = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 2
        total = float(areas.sum())
        if total <= TINY:
            return PadPatch(0.0, (0.0, 0.0), 0.0, 0.0)
        share, centroids = areas / total, fans.mean(1)
        centre = share @ centroids
        # The mean of |p|² over a triangle with the corners v and the centroid c is (Σ|v|² + 9|c|²) / 12.
        square = float(share @ ((fans**2).sum((1, 2)) + 9 * (centroids**2).sum(1))) / 12
        gyration = max(square - float(centre @ centre), 0.0) ** 0.5
        slope = float(share @ slopes)
        edge = slope if slope >= FACING else self.edge(end, side)
        return PadPatch(total, (float(centre[0]), float(centre[1])), gyration, slope, edge)

    def edge(self, end: float, side: float) -> float:
        """Return the largest cosine between a side and a vector in the normal cone of an outermost point there.

        The normal cone of a point is spanned by the normals of the polygons that meet there.
        """
        axis = np.array([[0.0, side, 0.0]])
        outermost = self.corners[side * self.corners[:, :, 1] >= side * end - OUTERMOST]
        points = outermost[np.unique(np.round(outermost / OUTERMOST), axis=0, return_index=True)[1][:PLACES]]
        best = -1.0
        for point in points:
            met = (np.linalg.norm(self.corners - point, axis=2) <= 2 * OUTERMOST).any(1)
            best = max(best, math.cos(angle_between(axis, distinct_normals(list(self.normals[met])))))
        return best

    def touched(self, end: float, side: float) -> Polygons:
        """Return the surface facing a pad on one side that is within `TOUCH` of the outermost point."""
        corners, normals = self.cut(1, -side, TOUCH - side * end)
        facing = side * normals[:, 1] > 0.0
        return Polygons(corners[facing], normals[facing])


def crossed(one: Floats, two: Floats) -> Floats:
    """Return the cross products of vectors (3,) or (n, 3); for few vectors, `np.cross` takes several times as long."""
    if one.ndim == two.ndim == 1:
        (a, b, c), (d, e, f) = one.tolist(), two.tolist()
        return np.array([b * f - c * e, c * d - a * f, a * e - b * d])
    (a, b, c), (d, e, f) = one.T, two.T
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], -1)
