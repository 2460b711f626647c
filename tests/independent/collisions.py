"""What bodies and arms are in: primitives by directions that separate them, links by points of the one in the other."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tests.independent.convex import clearance, depth, surface
from tests.independent.frames import Array, Frame
from tests.independent.hulls import Hull
from tests.independent.robots import LEFT, Mounted
from tests.independent.tolerances import DEEPEST, SPACING
from tests.independent.world import Body, Layout, Solid

Placed = tuple[int, Hull, Frame]
"""A part of a link: the number of the link, its hull, where it is."""


def overlapping(layout: Layout, names: Iterable[str]) -> Iterator[str]:
    """Yield which of some bodies are in others or in the table."""
    done = set[str]()
    for one in names:
        done.add(one)
        for two in layout.poses:
            if two not in done and layout.gap(one, two) <= 0.0 and _overlap(layout.body(one), layout.body(two)):
                yield f"{one} and {two} are in each other"
        if _in_table(layout, one):
            yield f"{one} is in the table"


def _overlap(one: Body, two: Body) -> bool:
    """Tell whether two bodies are deeper in each other than they may be."""
    gaps = np.maximum(one.lows[:, None] - two.highs[None], two.lows[None] - one.highs[:, None]).max(axis=2)
    pairs = ((one.solids[i], two.solids[j]) for i, j in np.argwhere(gaps < -DEEPEST))
    return any(depth(a.part, a.place, b.part, b.place, DEEPEST) > DEEPEST for a, b in pairs)


def _in_table(layout: Layout, name: str) -> bool:
    """Tell whether a body over the table is lower than its top; its foot is taken to be all below its centre."""
    centre, half = layout.world.table
    over = (np.abs(layout.poses[name].at[:2] - centre) <= half).all()
    return bool(over and layout.body(name).lows[:, 2].min() < -DEEPEST)


class Arm:
    """The links of an arm where they are."""

    def __init__(self, mounted: Mounted, joints: tuple[float, ...], width: float):
        self._apart = set(mounted.robot.apart)
        frames = mounted.frames(joints, width)
        pairs = enumerate(zip(mounted.robot.links, frames, strict=True))
        self.placed: list[Placed] = [(number, hull, frame) for number, (hulls, frame) in pairs for hull in hulls]
        self._fingers = len(frames) + LEFT
        self._middles = np.array([frame.turn @ hull.middle + frame.at for _, hull, frame in self.placed])
        self._radii = np.array([hull.radius for _, hull, _ in self.placed])

    def in_itself(self) -> bool:
        """Tell whether links that are no neighbours are in each other."""
        numbers = [number for number, _, _ in self.placed]
        close = self._close(self) & np.array([[(low, high) in self._apart for high in numbers] for low in numbers])
        return any(_cross(self.placed[i], self.placed[j]) for i, j in np.argwhere(close))

    def _close(self, other: Arm) -> NDArray[np.bool_]:
        """Tell of every two parts of two arms whether the balls around them meet."""
        apart: Array = np.linalg.norm(self._middles[:, None] - other._middles[None], axis=2)
        return np.asarray(apart < self._radii[:, None] + other._radii[None])

    def in_table(self, layout: Layout) -> bool:
        """Tell whether a link that moves is lower than the table's top."""
        centre, half = layout.world.table
        for (number, hull, frame), middle in zip(self.placed, self._middles, strict=True):
            if number > 0 and middle[2] < hull.radius:
                points = hull.points @ frame.turn.T + frame.at
                if ((points[:, 2] < -DEEPEST) & (np.abs(points[:, :2] - centre) <= half).all(axis=1)).any():
                    return True
        return False

    def in_arm(self, other: Arm) -> bool:
        """Tell whether this arm and another one are in each other."""
        return any(_cross(self.placed[i], other.placed[j]) for i, j in np.argwhere(self._close(other)))

    def in_bodies(
        self, layout: Layout, names: Iterable[str], touched: Collection[str], handle: str | None
    ) -> list[str]:
        """Return the bodies that the arm is in; its fingers may touch some, and the handle of one."""
        return [name for name in names if self._in_body(layout, name, name in touched, name == handle)]

    def _in_body(self, layout: Layout, name: str, touched: bool, handle: bool) -> bool:
        body = layout.body(name)
        near = np.nonzero(_beyond(body.low, body.high, self._middles) < self._radii)[0]
        if not len(near):
            return False
        close = _beyond(body.lows, body.highs, self._middles[near][:, None]) < self._radii[near][:, None]
        for i, j in np.argwhere(close):
            number, hull, frame = self.placed[near[i]]
            finger, solid = number >= self._fingers, body.solids[j]
            if not (finger and (touched or (handle and solid.handle))) and _pierces(hull, frame, solid):
                return True
        return False


def _beyond(low: Array, high: Array, points: Array) -> Array:
    """Return how far points are from boxes by their lowest and highest corners, 0 within them."""
    return np.asarray(np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0.0), axis=-1))


@lru_cache(maxsize=1 << 8)
def arm(mounted: Mounted, joints: tuple[float, ...], width: float) -> Arm:
    """Return an arm where it is."""
    return Arm(mounted, joints, width)


def _pierces(hull: Hull, frame: Frame, solid: Solid) -> bool:
    """Tell whether points of a link are in a primitive, or points of the primitive in the link."""
    place, part = solid.place, solid.part
    if clearance(part, place, hull.points @ frame.turn.T + frame.at).min() < -DEEPEST:
        return True
    local = surface(part, SPACING / 3) @ (frame.turn.T @ place.turn).T
    return bool(hull.within(local + frame.turn.T @ (solid.middle - frame.at)).max() > DEEPEST)


def _cross(one: Placed, two: Placed) -> bool:
    """Tell whether points of one link are in another, either way."""
    (_, first, here), (_, second, there) = one, two
    gap = (here.turn @ first.middle + here.at) - (there.turn @ second.middle + there.at)
    if float(np.linalg.norm(gap)) > first.radius + second.radius:
        return False
    return _deep(first, here, second, there) or _deep(second, there, first, here)


def _deep(one: Hull, at: Frame, two: Hull, there: Frame) -> bool:
    shift: Frame = there.inverse() @ at
    points: Array = one.points @ shift.turn.T + shift.at
    near = np.linalg.norm(points - two.middle, axis=1) < two.radius
    return bool(near.any() and two.within(points[near]).max() > DEEPEST)
