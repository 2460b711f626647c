"""Whether two pads hold a body, judged by lines between them or points on it; no geometry of the package is used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from tests.independent.convex import Part, depth
from tests.independent.frames import Array, Frame

STEP = 0.0015
"""Metres between the points on a face."""

PAD, AHEAD = 0.0176, 0.009
"""The side of a pad, and how far it reaches beyond the tool; metres."""

OFF = 0.003
"""By how much a pad may be off the surface, in metres: 2 mm of the definition, and the step of the points."""

SLANT = 0.5
"""The least cosine between a pad and what it touches: friction of 45 degrees, and the points at edges."""

FINGER = ((-0.0088, 0.0088), (0.0, 0.0142), (-0.0086, 0.009))
"""The ends of a closed finger's pad along x, y and z of the tool, in metres."""

RUBBER = 1.4
"""The coefficient of friction of a pad, times that of the body."""

LINES = 45
"""Lines between the pads along either side: every 0.4 mm."""

GIVES = 0.001
"""Metres of rubber that give way: what is so near to the outermost is touched as well."""

YIELDS = 0.0027
"""Metres by which a finger may be in what it holds: 2 mm of the definition, and how exact depths of hulls are."""

BESIDE = 0.0005
"""Metres by which a point may be off a face that it is still on, for lines are as far apart."""

LINED = 1e-9
"""The cosine from which a line is parallel to a face."""


class Grip(NamedTuple):
    """What is between two pads: its ends along y of the tool in metres, and what each pad touches of it.

    Of that there are the mean angle to the pad in radians, the centre along x and z in metres, the mean square of the
    distances from the centre, and the lowest and highest x and z, shape (2, 2). `edges` are the angles between the pads
    and the nearest normals that what is outermost has, as an edge has those between its faces.
    """

    low: float
    high: float
    angles: tuple[float, float]
    centres: tuple[Array, Array]
    spreads: tuple[float, float]
    ends: tuple[Array, Array]
    edges: tuple[float, float]

    @property
    def width(self) -> float:
        return self.high - self.low

    def leans(self, friction: float) -> float:
        """Return the larger angle between a pad and what it touches; at edges only if they are opposite."""
        aside = float(np.linalg.norm(self.centres[0] - self.centres[1]))
        if aside > friction * self.width:
            return max(self.angles)
        return max(min(pair) for pair in zip(self.angles, self.edges, strict=True))


def grip(parts: Sequence[tuple[Part, Frame]], tool: Frame, opening: float) -> Grip | None:
    """Return what pads meet of convex parts when they close, None where there is nothing between them."""
    across = np.linspace(-PAD / 2, PAD / 2, LINES)
    x, z = (each.ravel() for each in np.meshgrid(across, across + AHEAD - PAD / 2))
    begins = np.column_stack([x, np.zeros_like(x), z]) @ tool.turn.T + tool.at
    ends = [_through(part, place, begins, tool.turn[:, 1], opening / 2) for part, place in parts]
    lows, highs = (np.array([each[k] for each in ends]) for k in (0, 1))
    met = lows < highs
    if not met.any():
        return None
    sides = []
    for outward, places, normals in ((-1.0, -lows, 2), (1.0, highs, 3)):
        values = np.where(met, places, -np.inf)
        outermost = values.argmax(axis=0)
        farthest = values.max(axis=0)
        touched = farthest > values.max() - GIVES
        slopes = np.array([each[normals] for each in ends])[outermost, np.arange(len(x))] * outward
        touched &= slopes > 0.0
        flat = np.column_stack([x, z])[touched]
        centre = flat.mean(axis=0) if len(flat) else np.zeros(2)
        slope = float(slopes[touched].mean()) if len(flat) else 0.0
        spread = float(((flat - centre) ** 2).sum(axis=1).mean()) if len(flat) else 0.0
        borders = np.array([flat.min(axis=0), flat.max(axis=0)]) if len(flat) else np.zeros((2, 2))
        owner, line = np.unravel_index(values.argmax(), values.shape)
        place = begins[line] + outward * farthest[line] * tool.turn[:, 1]
        edge = _nearest_normal(*parts[owner], place, outward * tool.turn[:, 1])
        sides.append((outward * float(values.max()), float(np.arccos(min(1.0, slope))), centre, spread, borders, edge))
    (low, one, here, near, first, edge), (high, two, there, far, last, other) = sides
    return Grip(low, high, (one, two), (here, there), (near, far), (first, last), (edge, other))


def _nearest_normal(part: Part, place: Frame, point: Array, way: Array) -> float:
    """Return the least angle in radians between a direction and what the faces of a part at a point span."""
    local, along = (point - place.at) @ place.turn - part.at, way @ place.turn
    if part.kind == "sphere":
        return float(np.arccos(min(1.0, local @ along / float(np.linalg.norm(local)))))
    normals, offsets = _faces(part)
    met = normals[offsets - normals @ local < BESIDE]
    best = float((met @ along).max(initial=-1.0))
    for one, two in combinations(met, 2):
        # The nearest direction between two normals is the direction's own projection, if that is between them.
        both, first, second = one @ two, along @ one, along @ two
        if min(first - both * second, second - both * first) >= 0.0 and 1.0 - both**2 > LINED:
            best = max(best, ((first**2 + second**2 - 2 * both * first * second) / (1.0 - both**2)) ** 0.5)
    return float(np.arccos(np.clip(best, -1.0, 1.0)))


def _through(part: Part, place: Frame, begins: Array, way: Array, most: float) -> tuple[Array, Array, Array, Array]:
    """Return where lines enter and leave a convex part, and its normals there along the lines; cut off at the pads."""
    local, along = (begins - place.at) @ place.turn - part.at, way @ place.turn
    if part.kind == "sphere":
        radius, nearest = part.half[0], local @ along
        half = radius**2 - (local**2).sum(axis=1) + nearest**2
        root = np.sqrt(np.maximum(half, 0.0))
        low, high = np.maximum(-nearest - root, -most), np.minimum(root - nearest, most)
        return low, np.where(half < 0.0, low - 1.0, high), -root / radius, root / radius
    normals, offsets = _faces(part)
    toward, left = normals @ along, offsets - local @ normals.T
    parallel = np.abs(toward) < LINED
    with np.errstate(divide="ignore", invalid="ignore"):
        cut = left / toward
    leaves, enters = np.where(toward > LINED, cut, np.inf), np.where(toward < -LINED, cut, -np.inf)
    outside = (left[:, parallel] < 0.0).any(axis=1)
    exits, entries = leaves.argmin(axis=1), enters.argmax(axis=1)
    low, high = np.maximum(enters.max(axis=1), -most), np.minimum(leaves.min(axis=1), most)
    high = np.where(outside, low - 1.0, high)
    return low, high, toward[entries], toward[exits]


def _faces(part: Part) -> tuple[Array, Array]:
    """Return the normals of the faces of a part, and their distances from its middle; a round side has many faces."""
    if part.hull is not None:
        return part.hull.normals, part.hull.offsets
    angles = np.linspace(0, 2 * np.pi, 96, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    if part.kind == "cylinder":
        normals = np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]])
        return normals, np.array([part.half[0]] * len(ring) + [part.half[2]] * 2)
    return np.concatenate([np.eye(3), -np.eye(3)]), np.concatenate([part.half, part.half])


def in_fingers(parts: Sequence[tuple[Part, Frame]], tool: Frame, width: float) -> bool:
    """Tell whether a finger is in a body that it holds, by more than rubber gives way."""
    low, high = (np.array(ends) for ends in zip(*FINGER, strict=True))
    for side in (1.0, -1.0):
        middle = (low + high) / 2 * [1.0, side, 1.0] + [0.0, side * width / 2, 0.0]
        pad = Part("box", (high - low) / 2, middle)
        if any(depth(pad, tool, part, place, YIELDS) > YIELDS for part, place in parts):
            return True
    return False


def borne(found: Grip, friction: float, force: float) -> float:
    """Return the torque in newton metres that the friction of both pads bears: 2 mu F r, of the smaller contact."""
    return 2 * RUBBER * friction * force * min(found.spreads) ** 0.5


def tilted(found: Grip, torque: Array, friction: float, force: float) -> float:
    """Return the share of a torque in newton metres, in the frame of the tool, that turns a body out of its pads.

    About x and z alone, that is, across the line between the pads. Each pad presses somewhere on what it touches: two
    forces at opposite ends turn a body as much as pads can, and friction up one pad and down the other adds to that.
    """
    low, high = found.ends
    shares = []
    for axis, across, sign in ((0, 1, 1.0), (2, 0, -1.0)):
        # The pad of low y presses along y, and turns the body about x by -z and about z by x for each newton.
        first, last = (low, high) if sign * torque[axis] > 0.0 else (high, low)
        couple = first[1, across] - last[0, across] + PAD / (LINES - 1)
        shares.append(abs(torque[axis]) / max(force * (couple + RUBBER * friction * found.width), 1e-9))
    return float(max(shares))


def points_on(boxes: Sequence[tuple[Array, Frame]]) -> tuple[Array, Array]:
    """Return points on the surface of boxes and their outward normals; a box is half its sides, and its place."""
    places, normals = [], []
    for (half, frame), axis, sign in product(boxes, range(3), (-1.0, 1.0)):
        ranges = [np.linspace(-side, side, max(2, round(2 * side / STEP))) for side in half]
        ranges[axis] = np.array([sign * half[axis]])
        grid = np.stack(np.meshgrid(*ranges), -1).reshape(-1, 3)
        places.append(grid @ frame.turn.T + frame.at)
        normals.append(np.tile(sign * frame.turn[:, axis], (len(grid), 1)))
    return np.concatenate(places), np.concatenate(normals)


def grip_faults(points: Array, normals: Array, tool: Frame, width: float) -> Iterator[str]:
    """Yield why pads that are a width apart do not hold a body, by points of its surface in the frame of the tool."""
    local, outward = (points - tool.at) @ tool.turn, normals @ tool.turn
    x, y, z = local.T
    between = (np.abs(x) < PAD / 2) & (z > AHEAD - PAD) & (z < AHEAD) & (np.abs(y) < width / 2 + OFF)
    for name, side in (("left", 1.0), ("right", -1.0)):
        near = between & (side * y > width / 2 - OFF) & (side * outward[:, 1] > SLANT)
        if not near.any():
            yield f"the {name} pad touches nothing"
        low, high = (np.array(ends) for ends in zip(*FINGER, strict=True))
        finger = local * [1.0, side, 1.0] - [0.0, width / 2, 0.0]
        if ((finger > low + OFF) & (finger < high - OFF)).all(1).any():
            yield f"the {name} finger is in the body"
