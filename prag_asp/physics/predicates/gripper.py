"""``at``, ``holding``, ``gripper_open`` and ``reachable``: how the gripper stands to an object."""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.geometry import Quaternion, rotate, width_along
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Ring, Volume
from prag_asp.physics.robot import ROBOTS, Robot
from prag_asp.physics.situation import Situation

CENTRE_TOLERANCE = 0.015
BELOW = 0.005
MARGIN = 0.001
REACH_MARGIN = 0.003
OPEN_TOLERANCE = 0.001
GRIP_TOLERANCE = 0.002


def grip_width(situation: Situation, entity: str) -> float:
    """Return how far the gripper is open when it holds an object with the tool turned as it is, in metres."""
    opening = rotate(situation.tool.quaternion, (0.0, 1.0, 0.0))
    return width_along(situation.shape(entity), situation.pose(entity).quaternion, opening)


def _robot(situation: Situation) -> Robot:
    """Return the robot of the scene."""
    return ROBOTS[situation.scene.robot]


def _at_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool misses the middle of the object."""
    entity = arguments[1]
    x, y, z = situation.tool.position
    yield z - situation.top(entity)
    yield situation.bottom(entity) - BELOW - z
    cx, cy, _ = situation.pose(entity).position
    yield math.hypot(x - cx, y - cy) - CENTRE_TOLERANCE


def _at_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return a disc around the axis of the object for the tool."""
    entity = arguments[1]
    x, y, _ = situation.pose(entity).position
    side = CENTRE_TOLERANCE - MARGIN
    low, high = situation.bottom(entity) - BELOW + MARGIN, situation.top(entity) - MARGIN
    return Volume((x - side, y - side, low), (x + side, y + side, high), rings=(Ring(x, y, 0.0, side),))


def _holding_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool misses the object, and the opening its width."""
    yield from _at_violations(situation, arguments)
    yield abs(situation.width - grip_width(situation, arguments[1])) - GRIP_TOLERANCE


def _holding_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return a disc around the axis of the object for the tool, and the opening that grips the object."""
    width = grip_width(situation, arguments[1])
    tight = GRIP_TOLERANCE - MARGIN
    return _at_volume(situation, arguments, quaternion).meet(Volume(width=(width - tight, width + tight)))


def _open_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the gripper is short of open."""
    yield _robot(situation).opening - OPEN_TOLERANCE - situation.width


def _open_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the openings that count as open."""
    opening = _robot(situation).opening
    return Volume(width=(opening - OPEN_TOLERANCE, opening))


def _reachable_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres an object is too near, too far or too high for a grasp from above."""
    robot = _robot(situation)
    x, y, z = situation.pose(arguments[1]).position
    radius = math.hypot(x, y)
    yield robot.reach[0] - radius
    yield radius - robot.reach[1]
    yield z - robot.reach_height


def _reachable_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the ring that the gripper reaches from above."""
    robot = _robot(situation)
    inner, outer = robot.reach[0] + REACH_MARGIN, robot.reach[1] - REACH_MARGIN
    height = robot.reach_height - MARGIN
    ring = Ring(0.0, 0.0, inner, outer)
    return Volume((-outer, -outer, -math.inf), (outer, outer, height), rings=(ring,))


AT = Predicate(
    name="at",
    violations=_at_violations,
    volume=_at_volume,
    sentence=states("the gripper {is} at {1}"),
    of_gripper=True,
)
HOLDING = Predicate(
    name="holding",
    violations=_holding_violations,
    volume=_holding_volume,
    sentence=states("{1} {is} held by the gripper"),
    subject=1,
    of_gripper=True,
)
GRIPPER_OPEN = Predicate(
    name="gripper_open",
    violations=_open_violations,
    volume=_open_volume,
    sentence=states("the gripper {is} open"),
    of_gripper=True,
)
REACHABLE = Predicate(
    name="reachable",
    violations=_reachable_violations,
    volume=_reachable_volume,
    sentence=states("{1} {is} within reach"),
    subject=1,
)
