"""What each spatial predicate means, written anew from its description: by how much a state misses it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tests.independent.convex import Part, outline_of, outlines_apart, reach
from tests.independent.frames import Array, Frame
from tests.independent.grips import RUBBER, Grip, grip
from tests.independent.tolerances import SAME, SLACK, TILT
from tests.independent.world import Layout, World

ROUND = ("cylinder", "sphere")
HOLLOW = ("container", "drawer", "cupboard")
LEANING = np.radians(2)
ASIDE = 0.03
"""Twice the metres by which a tool may be off the middle of what it holds."""

OPEN, CLOSED = 0.9, 0.05
"""From which share of the way on furniture is open, and up to which it is closed."""


@dataclass(frozen=True)
class Seen:
    """One moment: where the bodies are, where the tools are, how far the grippers are open."""

    layout: Layout
    tools: Mapping[str, Frame]
    widths: Mapping[str, float]

    @property
    def world(self) -> World:
        return self.layout.world

    def local(self, name: str, at: Array) -> Array:
        """Return a point in the axes of a body, a zone or the table."""
        pose = self.layout.pose(name)
        return np.asarray(pose.turn.T @ (at - pose.at))

    def ends(self, name: str, direction: Array) -> tuple[float, float]:
        """Return where a body begins and ends along a direction of length one, furniture as the box around it."""
        if name in self.world.furniture:
            box = self.layout.span(name)
            middle, half = direction @ np.add(*box) / 2, np.abs(direction) @ (box[1] - box[0]) / 2
            return float(middle - half), float(middle + half)
        low, high = np.inf, -np.inf
        for solid in self.layout.body(name).solids:
            middle = solid.middle @ direction
            ends = reach(solid.part, solid.place.turn, np.array([-direction, direction]))
            low, high = min(low, middle - ends[0]), max(high, middle + ends[1])
        return float(low), float(high)

    def shadow(self, name: str) -> Array:
        """Return the outline of a body from a file, seen from above."""
        return outline_of(self._points(name)[:, :2])

    def crown(self, name: str) -> Array:
        """Return the outline of the highest points of a body from a file, on which others stand."""
        points = self._points(name)
        return outline_of(points[points[:, 2] >= points[:, 2].max() - SAME][:, :2])

    def _points(self, name: str) -> Array:
        """Return points of a body from a file whose hull it is, of round solids nearly."""
        solids = self.layout.body(name).solids
        return np.concatenate([_corners(solid.part) @ solid.place.turn.T + solid.middle for solid in solids])


def _corners(part: Part) -> Array:
    """Return points about the middle of a solid whose hull it is, of round ones nearly."""
    if part.hull is not None:
        return part.hull.corners
    if part.kind == "box":
        return np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * part.half
    turns = np.linspace(0.0, 2 * np.pi, 64, endpoint=False)
    ring = np.column_stack([np.cos(turns), np.sin(turns)])
    if part.kind == "cylinder":
        return np.concatenate([np.column_stack([ring, np.full(64, z)]) for z in (-1.0, 1.0)]) * part.half
    slopes = np.linspace(-np.pi / 2, np.pi / 2, 33)
    rings = [np.column_stack([ring * np.cos(t), np.full(64, np.sin(t))]) for t in slopes]
    return np.concatenate(rings) * part.half


def holds(seen: Seen, name: str, arguments: Sequence[str], value: bool) -> bool:
    """Tell whether a predicate has a value; where it is on the edge, either value is right."""
    if name not in MEANINGS:
        raise ValueError(f"the independent check has no definition of {name}; write one")
    missed = max(MEANINGS[name](seen, arguments))
    return missed <= SLACK if value else missed > -SLACK


def _middles(seen: Seen, names: Sequence[str]) -> list[Array]:
    """Return the middles of the boxes around bodies."""
    return [np.add(*seen.layout.span(name)) / 2 for name in names]


def _sides(seen: Seen, names: Sequence[str]) -> Array:
    """Return the sum of half the sides of the boxes around two bodies."""
    return np.asarray(sum((high - low) / 2 for low, high in map(seen.layout.span, names)))


def _beside(axis: int, sign: float) -> Callable[[Seen, Sequence[str]], Iterator[float]]:
    """Boxes 5 mm apart along the axis; centres no more than twice as far apart across it as along it."""

    def missed(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
        one, two = _middles(seen, arguments)
        along = (one - two)[axis] * sign * (-1 if seen.world.viewer else 1)
        yield _sides(seen, arguments)[axis] + 0.005 - along
        yield abs((one - two)[1 - axis]) - 2 * along

    return missed


def _gap(seen: Seen, arguments: Sequence[str]) -> float:
    """Return how far the boxes around two bodies are apart, seen from above."""
    one, two = _middles(seen, arguments)
    beyond = np.abs(one - two)[:2] - _sides(seen, arguments)[:2]
    return float(np.linalg.norm(np.maximum(beyond, 0.0)))


def _near(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """Up to 10 cm apart."""
    yield _gap(seen, arguments) - 0.10


def _far(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """From 25 cm apart on."""
    yield 0.25 - _gap(seen, arguments)


def _touching(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The gap in space at most 2 mm, or bodies in each other by as much; what is no upright primitive is its box, but
    what is from a file is the prism around it."""
    (one, low, high, radius, ball), (two, other_low, other_high, other_radius, other_ball) = (
        _prism(seen, name) for name in arguments
    )
    aside = outlines_apart(one, two) - radius - other_radius
    above = max(low - other_high, other_low - high)
    outside = float(np.linalg.norm(np.maximum([aside, above], 0.0)))
    yield abs((outside or max(aside, above)) - ball - other_ball) - 0.002


def _prism(seen: Seen, name: str) -> tuple[Array, float, float, float, float]:
    """Return corners seen from above, bottom and top of what a body is around, and the radii of discs and of a ball."""
    low, high = seen.layout.span(name)
    if name in seen.world.models:
        return seen.shadow(name), low[2], high[2], 0.0, 0.0
    middle, pose, kind = (low + high) / 2, seen.layout.pose(name), seen.world.kinds[name]
    if kind == "sphere":
        return middle[None, :2], middle[2], middle[2], 0.0, seen.world.halves[name][0]
    signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    if kind in ("drawer", "cupboard", "table", "zone") or pose.turn[2, 2] < np.cos(LEANING):
        return middle[:2] + signs * (high - low)[:2] / 2, low[2], high[2], 0.0, 0.0
    if kind == "cylinder":
        return middle[None, :2], low[2], high[2], seen.world.halves[name][0], 0.0
    yaw = _yaw(pose)
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    return middle[:2] + (signs * seen.world.halves[name][:2]) @ turn.T, low[2], high[2], 0.0, 0.0


def _between(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The line between the centres of two bodies passes through this one, 5 mm or more from either along it."""
    name, one, two = arguments
    begin, end = (middle[:2] for middle in _middles(seen, (one, two)))
    long = float(np.linalg.norm(end - begin))
    way = np.append((end - begin) / long if long > 0.0 else [1.0, 0.0], 0.0)
    across = np.array([-way[1], way[0], 0.0])
    left = seen.ends(name, across)
    aside = float(np.append(begin, 0.0) @ across)
    yield max(left[0] - aside, aside - left[1])
    first, last = seen.ends(name, way)
    yield seen.ends(one, way)[1] + 0.005 - first
    yield last + 0.005 - seen.ends(two, way)[0]


def _aligned(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """In a row along an axis within 1 cm, boxes 5 mm apart; sides parallel within five degrees, where both have any."""
    one, two = _middles(seen, arguments)
    apart, close = np.abs(one - two), _sides(seen, arguments) + 0.005
    yield min(max(apart[1 - axis] - 0.01, close[axis] - apart[axis]) for axis in (0, 1))
    if not any(seen.world.kinds[name] in ROUND for name in arguments):
        yaws = [_side(seen, name) for name in arguments]
        yield abs(float(np.angle(np.exp(4j * (yaws[0] - yaws[1]))))) / 4 - np.radians(5)


def _yaw(pose: Frame) -> float:
    return float(np.arctan2(pose.turn[1, 0], pose.turn[0, 0]))


def _side(seen: Seen, name: str) -> float:
    """Return the heading of a side of a body: from a file, of the smallest rectangle around it if that is 2 % less."""
    own = _yaw(seen.layout.pose(name))
    if name not in seen.world.models:
        return own
    outline = seen.shadow(name)
    edges = np.roll(outline, -1, axis=0) - outline

    def area(turn: float) -> float:
        along = np.array([np.cos(turn), np.sin(turn)])
        return float(np.ptp(outline @ along) * np.ptp(outline @ [-along[1], along[0]]))

    best = min((float(np.arctan2(y, x)) for x, y in edges), key=area)
    return best if area(best) <= 0.98 * area(own) else own


def _upright(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The body's z axis vertical within ten degrees; a ball stands as it likes."""
    axis = seen.layout.poses[arguments[0]].turn[:, 2]
    ball = seen.world.kinds[arguments[0]] == "sphere"
    yield -1.0 if ball else float(np.arctan2(np.hypot(axis[0], axis[1]), axis[2])) - TILT


def _rotated(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The heading of the body's x axis within ten degrees of the named one."""
    wanted = seen.world.rotations[arguments[1]]
    yield abs(float(np.angle(np.exp(1j * (_yaw(seen.layout.poses[arguments[0]]) - wanted))))) - TILT


def _on_top(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The foot within 2 mm of the top, the centre above the top."""
    name, support = arguments
    yield abs(seen.layout.span(name)[0][2] - seen.layout.span(support)[1][2]) - 0.002
    if support in seen.world.models:
        yield outlines_apart(seen.layout.poses[name].at[None, :2], seen.crown(support))
        return
    local = seen.local(support, seen.layout.poses[name].at)[:2]
    if seen.world.kinds[support] in ROUND:
        yield float(np.linalg.norm(local)) - seen.world.halves[support][0]
    else:
        yield from np.abs(local) - seen.layout.flat(support)


def _within(seen: Seen, arguments: Sequence[str], highest: float | None) -> Iterator[float]:
    """Above the floor but for 2 mm, all of it between the walls, no higher than `highest`, or 20 cm above the rim."""
    name, container = arguments
    frame, (x, y, (floor, rim)) = seen.layout.room(container)
    height = seen.layout.span(name)[0][2] - (floor + frame.at[2])
    yield -0.002 - height
    yield height - (rim - floor + 0.2 if highest is None else highest)
    local = frame.inverse() @ seen.layout.poses[name]
    for axis, (low, high) in ((0, x), (1, y)):
        first, last = _ends_within(seen, name, local, axis)
        yield low - first
        yield last - high


def _ends_within(seen: Seen, name: str, local: Frame, axis: int) -> tuple[float, float]:
    """Return where a body begins and ends along an axis of a frame in which it has a place."""
    low, high = np.inf, -np.inf
    for solid in seen.layout.body(name).solids:
        middle = (local.turn @ solid.part.at + local.at)[axis]
        back, ahead = reach(solid.part, local.turn, np.outer([-1.0, 1.0], np.eye(3)[axis]))
        low, high = min(low, middle - back), max(high, middle + ahead)
    return float(low), float(high)


def _inside(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """On the floor of the container, within 1 cm."""
    return _within(seen, arguments, 0.01)


def _located(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """In a container or up to 20 cm above its rim; on the table or as far above it, and over nothing hollow."""
    name, place = arguments
    if seen.world.kinds[place] != "table":
        yield from _within(seen, arguments, None)
        return
    height = seen.layout.span(name)[0][2]
    yield -0.002 - height
    yield height - 0.2
    at = seen.layout.poses[name].at
    yield from np.abs(seen.local(place, at)[:2]) - seen.layout.flat(place)
    for other in seen.layout.poses:
        if other != name and _is_hollow(seen, other):
            yield from _beyond(seen, other, at)


def _is_hollow(seen: Seen, name: str) -> bool:
    if name in seen.world.models:
        return bool(seen.world.models[name].cavity[1].any())
    return seen.world.kinds[name] in HOLLOW


def _beyond(seen: Seen, container: str, at: Array) -> Iterator[float]:
    """Yield how far a point is within the outline of a container, and within that of the tray of a drawer."""
    if container in seen.world.models:
        yield -outlines_apart(at[None, :2], seen.shadow(container))
        return
    yield float((seen.world.halves[container][:2] - np.abs(seen.local(container, at)[:2])).min())
    furniture = seen.world.furniture.get(container)
    if furniture is not None:
        frame = seen.layout.room(container)[0]
        x, y, _ = frame.turn.T @ (at - frame.at)
        (low_x, high_x), (low_y, high_y), _ = furniture.floor
        yield float(min(x - low_x, high_x - x, y - low_y, high_y - y))


def _height(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The tool between the body's top and 5 mm below its foot; at what is flat, fingertips 2 mm below the top."""
    low, high = seen.layout.span(arguments[1])
    height = seen.tools[arguments[0]].at[2]
    yield min(height - high[2], max(height - low[2] - 0.011, height - 0.009 - high[2] + 0.002))
    yield low[2] - 0.005 - height


def _at(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The tool within 15 mm of the body's axis, between its top and 5 mm below its foot."""
    yield from _height(seen, arguments)
    offset = seen.tools[arguments[0]].at - seen.layout.poses[arguments[1]].at
    yield float(np.linalg.norm(offset[:2])) - 0.015


def _holding(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """At the body, a box anywhere but 1 cm from its ends; open as wide as what is between the pads, +- 2 mm.

    That is no less than the least side of the body, +- 2 mm.
    """
    robot, name = arguments
    if name in seen.world.models:
        yield from _gripped(seen, robot, name)
        return
    if seen.world.kinds[name] == "box":
        local = np.abs(seen.local(name, seen.tools[robot].at)[:2])
        beyond = [*_height(seen, arguments), *(local - np.maximum(0.015, seen.world.halves[name][:2] - 0.01))]
    else:
        beyond = list(_at(seen, arguments))
    yield from beyond
    if max(beyond) <= SLACK:
        # The pads sweep as far as any body is long.
        met = grip_of(seen, robot, name, 2 * float(np.linalg.norm(seen.world.halves[name])) + ASIDE)
        wide = 0.0 if met is None else met.width
        yield abs(seen.widths[robot] - wide) - 0.002
        yield 2 * float(seen.world.halves[name].min()) - wide - 0.002


def _gripped(seen: Seen, robot: str, name: str) -> Iterator[float]:
    """Both pads on opposite sides, as wide open as these are apart, their normals within the cone of friction."""
    grip = grip_of(seen, robot, name)
    if grip is None:
        yield 0.02
        return
    yield abs(seen.widths[robot] - grip.width) - 0.002
    yield abs(grip.high + grip.low) / 2 - 0.002
    friction = RUBBER * seen.world.frictions[name]
    yield grip.leans(friction) - np.arctan(friction)


def grip_of(seen: Seen, robot: str, name: str, opening: float | None = None) -> Grip | None:
    """Return what the pads of a gripper meet of a body, None where nothing is between them.

    They are as far apart before as the gripper opens, or as is given.
    """
    body, widest = seen.layout.body(name), opening or seen.world.robots[robot].robot.opening
    return grip([(solid.part, solid.place) for solid in body.solids], seen.tools[robot], widest)


def _gripper_open(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """Open but for 1 mm."""
    name = arguments[0]
    yield seen.world.robots[name].robot.opening - 0.001 - seen.widths[name]


def _over(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The tool above the top of a body or a zone, within its sides."""
    at = seen.tools[arguments[0]].at
    yield seen.layout.span(arguments[1])[1][2] - at[2]
    if arguments[1] in seen.world.models:
        yield outlines_apart(at[None, :2], seen.shadow(arguments[1]))
        return
    yield from np.abs(seen.local(arguments[1], at)[:2]) - seen.layout.flat(arguments[1])


def _reachable(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The centre in the ring around the robot's axis that it reaches from above however it turns, at most so high."""
    mounted = seen.world.robots[arguments[0]]
    at, (inner, outer) = seen.layout.poses[arguments[1]].at, mounted.robot.reach
    far = float(np.linalg.norm((at - mounted.base.at)[:2]))
    yield inner - far
    yield far - outer
    yield float(at[2]) - mounted.robot.highest


def _is_open(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """Open nine tenths of the way or more."""
    yield OPEN * seen.world.furniture[arguments[0]].limit - seen.layout.openings[arguments[0]]


def _is_closed(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """Open a twentieth of the way or less."""
    yield seen.layout.openings[arguments[0]] - CLOSED * seen.world.furniture[arguments[0]].limit


MEANINGS: Mapping[str, Callable[[Seen, Sequence[str]], Iterator[float]]] = {
    "left_of": _beside(1, 1.0),
    "right_of": _beside(1, -1.0),
    "in_front_of": _beside(0, -1.0),
    "behind": _beside(0, 1.0),
    "near": _near,
    "far": _far,
    "touching": _touching,
    "between": _between,
    "aligned": _aligned,
    "upright": _upright,
    "rotated": _rotated,
    "on_top": _on_top,
    "inside": _inside,
    "located": _located,
    "at": _at,
    "holding": _holding,
    "gripper_open": _gripper_open,
    "over": _over,
    "reachable": _reachable,
    "is_open": _is_open,
    "is_closed": _is_closed,
}
"""By the name of a predicate: by how many metres or radians a moment misses each of its conditions."""
