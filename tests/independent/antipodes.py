"""Search for a place where two pads grip a body of convex parts, without an arm, a hand or a margin; and random bodies.

A proof that no gripper closes around a body is wrong where this finds such a place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tests.independent.convex import Part
from tests.independent.frames import Array, Frame
from tests.independent.grips import Grip, grip
from tests.independent.hulls import hull_of

OPEN = 1e-4
"""Metres by which open pads have to be off a body on either side."""

LARGEST_SPACING = 1.0
"""Metres between points on hulls of which only the corners are used."""


class Place(NamedTuple):
    """Where a tool is in the frame of a body, and what its pads meet there."""

    tool: Frame
    grip: Grip


def gripped(
    parts: Sequence[Array], opening: float, friction: float, rng: np.random.Generator, tries: int
) -> Place | None:
    """Return a place where both pads meet a body in their cones of friction, None if no try finds one.

    `parts` are the corners (n, 3) of convex parts. The tool is somewhere in the body with its axis along the normal of
    a face, or along a line between two corners or two faces, turned about that as it may be.
    """
    solids = [(_part(corners), Frame(np.eye(3), np.zeros(3))) for corners in parts]
    lines = _lines(solids, rng)
    cone = np.arctan(friction)
    for _ in range(tries):
        middle, axis = next(lines)
        side = np.cross(axis, rng.normal(size=3))
        side /= np.linalg.norm(side)
        tool = Frame(np.column_stack([side, axis, np.cross(side, axis)]), middle)
        for reach in (opening, 2 * opening):
            # Pads that are open around the middle of what is there are off it, or in the body.
            found = grip(solids, tool, reach)
            if found is None:
                break
            around = tool @ Frame(np.eye(3), np.array([0.0, (found.low + found.high) / 2, 0.0]))
            found = grip(solids, around, opening)
            if found is None or found.leans(friction) > cone:
                continue
            if max(-found.low, found.high) < opening / 2 - OPEN:
                return Place(around, found)
    return None


def _part(corners: Array) -> Part:
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle = (low + high) / 2
    return Part("hull", (high - low) / 2, middle, hull_of(corners - middle, LARGEST_SPACING))


def _lines(solids: Sequence[tuple[Part, Frame]], rng: np.random.Generator) -> Iterator[tuple[Array, Array]]:
    """Yield middles of tools and axes along which pads close."""
    while True:
        part = solids[rng.integers(len(solids))][0]
        assert part.hull is not None
        shares = rng.dirichlet(np.full(len(part.hull.corners), 0.3))
        middle = shares @ part.hull.corners + part.at
        kind = rng.random()
        if kind < 0.6:
            axis = part.hull.normals[rng.integers(len(part.hull.normals))] + rng.choice([0.0, 0.3]) * rng.normal(size=3)
        else:
            other = solids[rng.integers(len(solids))][0]
            assert other.hull is not None
            there = rng.dirichlet(np.full(len(other.hull.corners), 0.3)) @ other.hull.corners + other.at
            middle, axis = (middle + there) / 2, there - middle
        length = np.linalg.norm(axis)
        if length > 1e-6:
            yield middle + rng.normal(size=3) * 0.003, axis / length


def random_body(rng: np.random.Generator, kinds: Sequence[str] = ()) -> tuple[str, list[Array]]:
    """Return the name of a kind of body, and the corners of the convex parts of a random one, in metres.

    It is one of some kinds, or of all in `MAKERS`.
    """
    kinds = kinds or list(MAKERS)
    name = kinds[rng.integers(len(kinds))]
    parts = MAKERS[name](rng)
    turn, scale = _random_turn(rng), rng.choice([1.0, 1.4, 2.0, 3.0])
    return name, [scale * corners @ turn.T for corners in parts]


def _random_turn(rng: np.random.Generator) -> Array:
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.asarray(turn * np.sign(np.linalg.det(turn)))


def _box(x: float, y: float, z: float, at: Sequence[float] = (0.0, 0.0, 0.0)) -> Array:
    signs = np.array([(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
    return signs * np.array([x, y, z]) / 2 + at


def _block(rng: np.random.Generator) -> list[Array]:
    return [_box(*rng.uniform(0.03, 0.16, 3))]


def _sheet(rng: np.random.Generator) -> list[Array]:
    return [_box(*rng.uniform(0.06, 0.25, 2), rng.uniform(0.003, 0.011))]


def _revolved(rng: np.random.Generator) -> list[Array]:
    """Return wedges of a body that is turned on a lathe: hollow or not."""
    rows, sides = int(rng.integers(2, 5)), int(rng.integers(10, 20))
    heights = np.sort(rng.uniform(0.0, 0.15, rows))
    heights += 0.01 * np.arange(rows)
    outer = rng.uniform(0.03, 0.09, rows)
    inner = outer - rng.uniform(0.003, 0.02) if rng.random() < 0.7 else np.zeros(rows)
    angles = np.linspace(0, 2 * np.pi, sides + 1)
    parts = []
    for k in range(rows - 1):
        for a, b in pairwise(angles):
            ends = [(r[i], angle, heights[i]) for i in (k, k + 1) for r in (outer, inner) for angle in (a, b)]
            parts.append(np.array([(r * np.cos(angle), r * np.sin(angle), h) for r, angle, h in ends]))
    return parts


def _ring(rng: np.random.Generator) -> list[Array]:
    radius, thick, high, sides = rng.uniform(0.05, 0.12), rng.uniform(0.005, 0.05), rng.uniform(0.01, 0.06), 16
    angles = np.linspace(0, 2 * np.pi, sides + 1)
    return [
        np.array(
            [
                (r * np.cos(angle), r * np.sin(angle), h)
                for r in (radius, radius - min(thick, 0.9 * radius))
                for angle in pair
                for h in (0.0, high)
            ]
        )
        for pair in pairwise(angles)
    ]


def _profile(rng: np.random.Generator) -> list[Array]:
    """Return an L, a T or a U of bars."""
    long, wide, high, thick = (
        rng.uniform(0.1, 0.25),
        rng.uniform(0.085, 0.15),
        rng.uniform(0.085, 0.2),
        rng.uniform(0.01, 0.12),
    )
    foot, wall = _box(wide, long, thick), _box(thick, long, high, (0.0, 0.0, (high + thick) / 2))
    aside = np.array([(wide - thick) / 2, 0.0, 0.0])
    match rng.integers(3):
        case 0:
            return [foot, wall + aside]
        case 1:
            return [foot, wall]
    return [foot, wall + aside, wall - aside]


def _cone(rng: np.random.Generator) -> list[Array]:
    angles = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(20)])
    low, high, tall = rng.uniform(0.04, 0.1), rng.uniform(0.0, 0.1), rng.uniform(0.05, 0.2)
    return [np.concatenate([ring * low, ring * max(high, 0.001) + np.array([0, 0, tall])])]


def _stone(rng: np.random.Generator) -> list[Array]:
    return [rng.normal(size=(14, 3)) * rng.uniform(0.03, 0.06, 3)]


def _handled(rng: np.random.Generator) -> list[Array]:
    """Return a wide body with a bar at its side or a knob on top."""
    body = _box(*rng.uniform(0.085, 0.16, 3))
    reach = np.abs(body).max(axis=0)
    bar = _box(*rng.uniform(0.01, 0.1, 3))
    return [body, bar + np.array([reach[0] + np.abs(bar[:, 0]).max(), 0.0, 0.0])]


MAKERS: dict[str, Callable[[np.random.Generator], list[Array]]] = {
    "block": _block,
    "sheet": _sheet,
    "revolved": _revolved,
    "ring": _ring,
    "profile": _profile,
    "cone": _cone,
    "stone": _stone,
    "handled": _handled,
}
