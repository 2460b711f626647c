"""What each spatial predicate means, written anew from its description: by how much a state misses it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tests.independent.convex import reach
from tests.independent.panda import OPENING
from tests.independent.world import Frame, Part, World, bottom, box, top

SLACK = 1e-6
"""Metres and radians by which two ways to compute the same number may differ."""


@dataclass(frozen=True)
class Seen:
    """One moment: where the bodies are, where the tool is, how far the gripper is open."""

    world: World
    poses: Mapping[str, Frame]
    tool: Frame
    width: float


def holds(seen: Seen, name: str, arguments: Sequence[str], value: bool) -> bool:
    """Tell whether a predicate has a value; where it is on the edge, either value is right."""
    if name not in MEANINGS:
        raise ValueError(f"the independent check has no definition of {name}; write one")
    missed = max(MEANINGS[name](seen, arguments))
    return missed <= SLACK if value else missed > -SLACK


def _beside(axis: int, sign: float) -> Callable[[Seen, Sequence[str]], Iterator[float]]:
    """Boxes 5 mm apart along the axis; centres no more than twice as far apart across it as along it."""

    def missed(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
        one, two = (seen.poses[name] for name in arguments)
        along = (one.at - two.at)[axis] * sign * (-1 if seen.world.viewer else 1)
        sides = [box(seen.world, name, seen.poses[name].turn)[axis] for name in arguments]
        yield sum(sides) + 0.005 - along
        yield abs((one.at - two.at)[1 - axis]) - 2 * along

    return missed


def _on_top(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The foot within 2 mm of the top, the centre above the top."""
    world, (name, support) = seen.world, arguments
    yield abs(bottom(world, name, seen.poses) - top(world, support, seen.poses)) - 0.002
    at = seen.poses[name].at
    if world.kinds[support] == "table":
        centre, half = world.table
        yield from np.abs(at[:2] - centre) - half
        return
    local = (seen.poses[support].inverse() @ seen.poses[name]).at[:2]
    if world.kinds[support] in ("cylinder", "sphere"):
        yield float(np.linalg.norm(local)) - world.halves[support][0]
    else:
        yield from np.abs(local) - world.halves[support][:2]


def _within(seen: Seen, arguments: Sequence[str], highest: float) -> Iterator[float]:
    """Above the floor but for 2 mm, no higher than `highest` above it, and all of it between the walls."""
    world, (name, container) = seen.world, arguments
    floor = bottom(world, container, seen.poses) + world.walls[container]
    height = bottom(world, name, seen.poses) - floor
    yield -0.002 - height
    yield height - highest
    local = seen.poses[container].inverse() @ seen.poses[name]
    room = world.halves[container][:2] - world.walls[container]
    yield from np.abs(local.at[:2]) + box(world, name, local.turn)[:2] - room


def _inside(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """On the floor of the container, within 1 cm."""
    return _within(seen, arguments, 0.01)


def _located(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """In the container or up to 20 cm above its rim."""
    container = arguments[1]
    depth = 2 * seen.world.halves[container][2] - seen.world.walls[container]
    return _within(seen, arguments, depth + 0.2)


def _at(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The tool within 15 mm of the body's axis, between its top and 5 mm below its foot."""
    name = arguments[1]
    height = seen.tool.at[2]
    yield height - top(seen.world, name, seen.poses)
    yield bottom(seen.world, name, seen.poses) - 0.005 - height
    yield float(np.linalg.norm((seen.tool.at - seen.poses[name].at)[:2])) - 0.015


def _holding(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """At the body, open as wide as the body is between the fingers, within 2 mm."""
    yield from _at(seen, arguments)
    name = arguments[1]
    kind, half = seen.world.kinds[name], seen.world.halves[name]
    part = Part("box" if kind == "container" else kind, half, np.zeros(3))
    wide = 2 * reach(part, seen.poses[name].turn, seen.tool.turn[None, :, 1])[0]
    yield abs(seen.width - wide) - 0.002


def _open(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """Open but for 1 mm."""
    yield OPENING - 0.001 - seen.width


def _reachable(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The centre 28 to 76 cm from the robot's axis, at most 35 cm high."""
    at = seen.poses[arguments[1]].at
    far = float(np.hypot(at[0], at[1]))
    yield 0.28 - far
    yield far - 0.76
    yield float(at[2]) - 0.35


def _rotated(seen: Seen, arguments: Sequence[str]) -> Iterator[float]:
    """The heading of the body's x axis within ten degrees of the named one."""
    axis = seen.poses[arguments[0]].turn[:, 0]
    wanted = seen.world.rotations[arguments[1]]
    off = np.angle(np.exp(1j * (np.arctan2(axis[1], axis[0]) - wanted)))
    yield abs(float(off)) - np.radians(10)


MEANINGS: Mapping[str, Callable[[Seen, Sequence[str]], Iterator[float]]] = {
    "left_of": _beside(1, 1.0),
    "right_of": _beside(1, -1.0),
    "in_front_of": _beside(0, -1.0),
    "behind": _beside(0, 1.0),
    "on_top": _on_top,
    "inside": _inside,
    "located": _located,
    "at": _at,
    "holding": _holding,
    "gripper_open": _open,
    "reachable": _reachable,
    "rotated": _rotated,
}
"""By the name of a predicate: by how many metres or radians a moment misses each of its conditions."""
