"""``reachable``: the centre of a body is within the ring in which a robot can grasp it from above."""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.extent import least_reach
from prag_asp.physics.predicates.gaps import ORIGIN, ROUNDING, Demand, Gap, Z, along, between, bottom, centre
from prag_asp.physics.predicates.predicate import Arguments, Gripper, Predicate, states
from prag_asp.physics.predicates.volume import Ring, Volume
from prag_asp.physics.situation import Situation
from prag_asp.scene.forms import Point
from prag_asp.scene.geometry import Quaternion
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene

MARGIN, HEIGHT_MARGIN = 0.003, 0.001


def _violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the amounts in metres by which an object is too near, too far or too high to be grasped from above."""
    robot = situation.robot(arguments[0])
    x, y, z = situation.pose(arguments[1]).position
    radius = math.hypot(x - robot.base.position[0], y - robot.base.position[1])
    yield robot.reach[0] - radius
    yield radius - robot.reach[1]
    yield z - robot.reach_height


def _volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the ring that the gripper can reach from above."""
    robot = situation.robot(arguments[0])
    x, y, _ = robot.base.position
    inner, outer = robot.reach[0] + MARGIN, robot.reach[1] - MARGIN
    height = robot.reach_height - HEIGHT_MARGIN
    return Volume((x - outer, y - outer, -math.inf), (x + outer, y + outer, height), rings=(Ring(x, y, inner, outer),))


def _demands(scene: Scene, arguments: Arguments) -> Iterator[Demand]:
    """Yield constraints that a body is within the square around the ring of the gripper's reach and is not too high."""
    robot, entity = robot_of(scene, arguments[0]), arguments[1]
    for axis in (0, 1):
        base, reach = robot.base.position[axis], robot.reach[1]
        yield from along(axis, between(centre(entity), ORIGIN, base - reach, base + reach))
    yield Z, Gap(bottom(entity), ORIGIN, least_reach(scene.shapes[entity]) - robot.reach_height)


def _nowhere(scene: Scene, arguments: Arguments, low: Point, high: Point) -> bool:
    """Return whether a rectangle is entirely too near or too far for the gripper."""
    robot = robot_of(scene, arguments[0])
    nearest, farthest = robot.reach
    base = robot.base.position
    sides = [(low[axis] - base[axis], high[axis] - base[axis]) for axis in (0, 1)]
    near = math.hypot(*(max(low, -high, 0.0) for low, high in sides))
    far = math.hypot(*(max(-low, high) for low, high in sides))
    return near > farthest + ROUNDING or far < nearest - ROUNDING


REACHABLE = Predicate(
    name="reachable",
    violations=_violations,
    volume=_volume,
    sentence=states("{1} {is} within reach"),
    robot_sentence=states("{1} {is} within reach of the {0} gripper"),
    subject=1,
    gripper=Gripper.REACHES,
    demands=_demands,
    nowhere=_nowhere,
    caption_rank=math.inf,
)

PREDICATES = {"reachable": REACHABLE}
