"""``at``, ``holding``, ``gripper_open`` and ``reachable``: how the gripper stands to an object."""

from __future__ import annotations

import math

from prag_asp.physics.geometry import Vector, rotate, width_along
from prag_asp.physics.predicates.predicate import Arguments, Predicate, Volume, excess, states
from prag_asp.physics.robot import ROBOTS, Robot
from prag_asp.physics.situation import Situation

CENTRE_TOLERANCE = 0.015
BELOW = 0.005
MARGIN = 0.001
OPEN_TOLERANCE = 0.001
GRIP_TOLERANCE = 0.002


def grip_width(situation: Situation, entity: str) -> float:
    """Return how far the gripper is open when it holds an object with the tool turned as it is, in metres."""
    opening = rotate(situation.tool.quaternion, (0.0, 1.0, 0.0))
    return width_along(situation.shape(entity), situation.pose(entity).quaternion, opening)


def _robot(situation: Situation) -> Robot:
    """Return the robot of the scene."""
    return ROBOTS[situation.scene.robot]


def _at_distance(situation: Situation, arguments: Arguments) -> float:
    """Return by how many metres the tool misses the middle of the object."""
    entity = arguments[1]
    x, y, z = situation.tool.position
    cx, cy, _ = situation.pose(entity).position
    beside = math.hypot(x - cx, y - cy) - CENTRE_TOLERANCE
    return excess(beside, situation.bottom(entity) - BELOW - z, z - situation.top(entity))


def _at_volume(situation: Situation, arguments: Arguments, half: Vector) -> Volume:
    """Return a box around the axis of the object for the tool."""
    entity = arguments[1]
    x, y, _ = situation.pose(entity).position
    side = CENTRE_TOLERANCE / math.sqrt(2) - MARGIN
    bottom, top = situation.bottom(entity), situation.top(entity)
    return Volume((x - side, y - side, bottom), (x + side, y + side, top))


def _holding_distance(situation: Situation, arguments: Arguments) -> float:
    """Return by how many metres the tool misses the object, or the opening its width."""
    entity = arguments[1]
    slack = abs(situation.width - grip_width(situation, entity)) - GRIP_TOLERANCE
    return excess(_at_distance(situation, arguments), slack)


def _holding_volume(situation: Situation, arguments: Arguments, half: Vector) -> Volume:
    """Return a box around the axis of the object for the tool, and the opening that grips the object."""
    width = grip_width(situation, arguments[1])
    tight = GRIP_TOLERANCE - MARGIN
    return _at_volume(situation, arguments, half).meet(Volume(width=(width - tight, width + tight)))


def _open_distance(situation: Situation, arguments: Arguments) -> float:
    """Return by how many metres the gripper is short of open."""
    return excess(_robot(situation).opening - OPEN_TOLERANCE - situation.width)


def _open_volume(situation: Situation, arguments: Arguments, half: Vector) -> Volume:
    """Return the openings that count as open."""
    opening = _robot(situation).opening
    return Volume(width=(opening - OPEN_TOLERANCE, opening))


def _reachable_distance(situation: Situation, arguments: Arguments) -> float:
    """Return by how many metres an object is too near, too far or too high for a grasp from above."""
    robot = _robot(situation)
    x, y, z = situation.pose(arguments[1]).position
    radius = math.hypot(x, y)
    return excess(robot.reach[0] - radius, radius - robot.reach[1], z - robot.reach_height)


def _reachable_volume(situation: Situation, arguments: Arguments, half: Vector) -> Volume:
    """Return the bounding box of the ring that the gripper reaches from above."""
    robot = _robot(situation)
    reach = robot.reach[1]
    return Volume((-reach, -reach, -math.inf), (reach, reach, robot.reach_height))


AT = Predicate(
    name="at",
    distance=_at_distance,
    volume=_at_volume,
    sentence=states("the gripper {is} at {1}"),
    of_gripper=True,
)
HOLDING = Predicate(
    name="holding",
    distance=_holding_distance,
    volume=_holding_volume,
    sentence=states("{1} {is} held by the gripper"),
    subject=1,
    of_gripper=True,
)
GRIPPER_OPEN = Predicate(
    name="gripper_open",
    distance=_open_distance,
    volume=_open_volume,
    sentence=states("the gripper {is} open"),
    of_gripper=True,
)
REACHABLE = Predicate(
    name="reachable",
    distance=_reachable_distance,
    volume=_reachable_volume,
    sentence=states("{1} {is} within reach"),
    subject=1,
)
