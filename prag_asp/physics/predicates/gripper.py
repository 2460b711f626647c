"""``at``, ``holding``, ``gripper_open`` and ``over``: the gripper of a robot, and its pose relative to an object.

A gripper holds one object at a time, and is not open while it holds one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.predicates.gaps import ROUNDING, Demand, Gap, Z, along, between, bottom, centre, top
from prag_asp.physics.predicates.predicate import Arguments, Gripper, Predicate, states, words
from prag_asp.physics.predicates.volume import Ring, Volume, turned_box
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Quaternion, heading, rotate, to_local, width_along
from prag_asp.scene.robots import Robot, robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import weight

CENTRE_TOLERANCE = 0.015
BELOW = 0.005
MARGIN = 0.001
OVER_MARGIN = 0.003
EDGE = 0.01
OPEN_TOLERANCE = 0.001
GRIP_TOLERANCE = 0.002
CLEARANCE = 0.006
"""By how much the opening of a gripper has to exceed the width of an object to grasp it, in metres."""
TIP_ROOM = 0.002
"""The clearance of the fingertips above the bottom of a grasped object, in metres."""

FINGER_FRICTION = 1.4
"""The coefficient of friction of the rubber pads, which PyBullet multiplies by that of the object."""

GRAVITY = 9.81
SLIPS = 1.05
"""A body is proved to slip if its weight is more than this multiple of what friction bears at rest.

The robot also accelerates what it lifts, so it may drop lighter bodies; a proof needs this margin.
"""

RISE, ROOM, AJAR = 0.04, 0.03, 2.0
"""How far above an object the tool has to be to move over it, and by how much the opening of the fingers has to exceed
its width, both in metres; closer to the object, at most `AJAR` times the distance by which the tool misses it."""

SLANT = 1e-9
"""The cosine below which a side counts as parallel to the opening direction of the gripper."""


def grip_width(situation: Situation, entity: str, robot: str) -> float:
    """Return the opening of a gripper that holds an object with the present orientation of the tool, in metres.

    The pads touch only the part of a rotated box that is between them; the ends that stick out do not matter.
    """
    opening = rotate(situation.tool(robot).quaternion, (0.0, 1.0, 0.0))
    shape, quaternion = situation.shape(entity), situation.pose(entity).quaternion
    width = width_along(shape, quaternion, opening)
    if shape.kind != "box":
        return width
    x, y, z, w = quaternion
    along = [max(abs(part), SLANT) for part in rotate((-x, -y, -z, w), opening)]
    half, cosine = min(zip(shape.half, along, strict=True), key=lambda side: side[0] / side[1])
    pad = situation.robot(robot).finger_boxes[0].size[0]
    return min(width, (2 * half + pad * math.sqrt(max(0.0, 1.0 - cosine**2))) / cosine)


def lowest_grip(robot: Robot) -> float:
    """Return the least height of the tool above the bottom of an object that it grasps, in metres."""
    return robot.fingertip + TIP_ROOM


def bearable(scene: Scene, entity: str, robot: str) -> float:
    """Return the mass in kilograms that the friction of both fingers of a robot bears at rest, for a body's material.

    By Coulomb's law it is 2 mu F / g, with the force F of a finger and the product mu of both coefficients, as PyBullet
    combines them.
    """
    friction = FINGER_FRICTION * scene.material(entity).friction
    return 2 * friction * robot_of(scene, robot).grip_force / GRAVITY


def slips(scene: Scene, entity: str, robot: str) -> str | None:
    """Return in words that a body slips out of a gripper that lifts it, None if it need not."""
    heavy, most = weight(scene, entity), bearable(scene, entity, robot)
    if heavy > SLIPS * most:
        return f"{words(entity)} weighs {heavy:.3g} kg, and {_called(scene, robot)} lifts {most:.3g} kg by its friction"
    return None


def _at_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool misses the centre of the object."""
    robot, entity = arguments
    yield from _height_violations(situation, robot, entity)
    yield _off_centre(situation, robot, entity) - CENTRE_TOLERANCE


def _height_violations(situation: Situation, robot: str, entity: str) -> Iterator[float]:
    """Yield by how many metres the tool is above or below the object."""
    z = situation.tool(robot).position[2]
    yield z - situation.top(entity)
    yield situation.bottom(entity) - BELOW - z


def _off_centre(situation: Situation, robot: str, entity: str) -> float:
    """Return the distance of the tool from the centre of the object, seen from above, in metres."""
    x, y, _ = situation.tool(robot).position
    cx, cy, _ = situation.pose(entity).position
    return math.hypot(x - cx, y - cy)


def _at_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return a disc for the tool around the vertical axis of the object."""
    entity = arguments[1]
    x, y, _ = situation.pose(entity).position
    side = CENTRE_TOLERANCE - MARGIN
    low, high = situation.bottom(entity) - BELOW + MARGIN, situation.top(entity) - MARGIN
    return Volume((x - side, y - side, low), (x + side, y + side, high), rings=(Ring(x, y, 0.0, side),))


def _holding_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool misses the object, and the opening misses its width.

    The width is left out if the tool is so far away that it cannot be the largest violation.
    """
    robot, entity = arguments
    places = []
    for missed in _grip_violations(situation, robot, entity):
        places.append(missed)
        yield missed
    width = situation.arm(robot).width
    if max(places) < max(width, 2 * math.hypot(*situation.shape(entity).half)):
        yield abs(width - grip_width(situation, entity, robot)) - GRIP_TOLERANCE


def _grip_violations(situation: Situation, robot: str, entity: str) -> Iterator[float]:
    """Yield by how many metres the tool misses the places where it can grip the object.

    A box can be held anywhere except at its edges: a long one, for instance, near its end.
    """
    shape, body = situation.shape(entity), situation.body(entity)
    x, y, z = situation.tool(robot).position
    yield z - body.high[2]
    yield body.low[2] - BELOW - z
    if shape.traits.even:
        (dx, dy), (half_x, half_y, _) = to_local(body.pose, x, y), shape.half
        yield max(abs(dx) - max(CENTRE_TOLERANCE, half_x - EDGE), abs(dy) - max(CENTRE_TOLERANCE, half_y - EDGE))
    else:
        yield _off_centre(situation, robot, entity) - CENTRE_TOLERANCE


def _holding_way(situation: Situation, arguments: Arguments) -> float:
    """Return how far the tool and the fingers have to move until the object is held, in metres.

    Beside the object the tool has to rise above it, and around it the fingers have to be wider open than the object.
    Both demands grow with the distance of the tool from the grasp, so the way is continuous.
    """
    robot, entity = arguments
    over, under, beside = _grip_violations(situation, robot, entity)
    aside, height = max(0.0, beside), over + under
    least = min(RISE, AJAR * aside + height)
    tool = aside + max(0.0, least - over) + max(0.0, over, least)
    room = min(ROOM, AJAR * max(0.0, over, under, beside))
    fingers = abs(situation.arm(robot).width - grip_width(situation, entity, robot) - room) + room - GRIP_TOLERANCE
    return tool + max(0.0, fingers)


def _holding_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return a disc for the tool around the vertical axis of the object, and the opening that grips it."""
    width = grip_width(situation, arguments[1], arguments[0])
    tight = GRIP_TOLERANCE - MARGIN
    return _at_volume(situation, arguments, quaternion).meet(Volume(width=(width - tight, width + tight)))


def _open_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the gripper is not yet open."""
    yield situation.robot(arguments[0]).opening - OPEN_TOLERANCE - situation.arm(arguments[0]).width


def _open_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the openings that count as open."""
    opening = situation.robot(arguments[0]).opening
    return Volume(width=(opening - OPEN_TOLERANCE, opening))


def _over_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool is below the top of a zone or an object, and beside it."""
    robot, entity = arguments
    x, y, z = situation.tool(robot).position
    yield situation.top(entity) - z
    places = to_local(situation.pose(entity), x, y)
    yield from (abs(at) - half for at, half in zip(places, _sides(situation, entity), strict=False))


def _over_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the region for the tool over a zone or an object."""
    pose, half = situation.pose(arguments[1]), _sides(situation, arguments[1])
    x, y, _ = pose.position
    cosine, sine = heading(pose.quaternion)
    dx, dy = (max(0.0, side - OVER_MARGIN) for side in half[:2])
    reach_x, reach_y = abs(cosine) * dx + abs(sine) * dy, abs(sine) * dx + abs(cosine) * dy
    return Volume(
        (x - reach_x, y - reach_y, situation.top(arguments[1]) + MARGIN),
        (x + reach_x, y + reach_y, math.inf),
        sides=turned_box((pose.position, (cosine, sine)), (dx, dy)),
    )


def _sides(situation: Situation, entity: str) -> Vector:
    """Return the half-sides of an entity in its own frame, in metres."""
    return situation.half(entity) if situation.is_table(entity) else situation.shape(entity).half


def _at_demands(scene: Scene, arguments: Arguments, near: float = CENTRE_TOLERANCE) -> Iterator[Demand]:
    """Yield that the tool is at a body, at most `near` metres from its centre."""
    robot, entity = arguments
    for axis in (0, 1):
        yield from along(axis, between(centre(entity), centre(robot), -near, near))
    yield Z, Gap(bottom(entity), centre(robot), -BELOW)
    yield Z, Gap(centre(robot), top(entity), 0.0)


def _holding_demands(scene: Scene, arguments: Arguments) -> Iterator[Demand]:
    """Yield that the tool is somewhere over a body, because a long one can be held at its end."""
    half = scene.shapes[arguments[1]].half
    return _at_demands(scene, arguments, max(CENTRE_TOLERANCE, math.hypot(half[0], half[1])))


def _holding_impossible(scene: Scene, arguments: Arguments) -> Iterator[str]:
    """Yield that a body is too wide for the gripper, too low for its fingers, or too heavy."""
    robot, entity = arguments
    able, gripper = robot_of(scene, robot), _called(scene, robot)
    # Bodies stand upright and are grasped from above, so their height does not count as a width.
    narrowest, heavy = scene.shapes[entity].breadth(widest=False), weight(scene, entity)
    if narrowest > able.opening:
        yield f"{words(entity)} is {narrowest * 1000:.0f} mm wide, {gripper} opens {able.opening * 1000:.0f} mm"
    if scene.shapes[entity].size[2] < lowest_grip(able) - ROUNDING:
        low, least = scene.shapes[entity].size[2] * 1000, lowest_grip(able) * 1000
        yield f"{words(entity)} is {low:.3g} mm high, {gripper} takes what is at least {least:.3g} mm high"
    if heavy > able.payload:
        yield f"{words(entity)} weighs {heavy:.3g} kg, {gripper} carries {able.payload:g} kg"


def _holding_excludes(scene: Scene, arguments: Arguments, other: Predicate, others: Arguments) -> str | None:
    """Return that the gripper would hold two things, or be open while it holds one."""
    robot, entity = arguments
    if others[0] != robot:
        return None
    if other.gripper is Gripper.HOLDS and others[1] != entity:
        return f"{_called(scene, robot)} cannot hold {words(entity)} and {words(others[1])} at once"
    if other.gripper is Gripper.OPEN:
        return f"{_called(scene, robot)} cannot be open while it holds {words(entity)}"
    return None


def _called(scene: Scene, robot: str) -> str:
    """Return the gripper's name for a sentence."""
    return f"the {words(robot)} gripper" if len(scene.robots) > 1 else "the gripper"


AT = Predicate(
    name="at",
    violations=_at_violations,
    volume=_at_volume,
    sentence=states("the gripper {is} at {1}"),
    robot_sentence=states("the {0} gripper {is} at {1}"),
    of_gripper=True,
    gripper=Gripper.AT,
    demands=_at_demands,
    caption_rank=180,
)
HOLDING = Predicate(
    name="holding",
    violations=_holding_violations,
    volume=_holding_volume,
    way=_holding_way,
    sentence=states("{1} {is} held by the gripper"),
    robot_sentence=states("{1} {is} held by the {0} gripper"),
    subject=1,
    of_gripper=True,
    gripper=Gripper.HOLDS,
    impossible=_holding_impossible,
    demands=_holding_demands,
    excludes=_holding_excludes,
    caption_rank=10,
)
GRIPPER_OPEN = Predicate(
    name="gripper_open",
    violations=_open_violations,
    volume=_open_volume,
    sentence=states("the gripper {is} open"),
    robot_sentence=states("the {0} gripper {is} open"),
    of_gripper=True,
    gripper=Gripper.OPEN,
    caption_rank=math.inf,
)
OVER = Predicate(
    name="over",
    violations=_over_violations,
    volume=_over_volume,
    sentence=states("the {0} gripper {is} over {1}"),
    of_gripper=True,
    gripper=Gripper.OVER,
    caption_rank=20,
)

PREDICATES = {"at": AT, "holding": HOLDING, "gripper_open": GRIPPER_OPEN, "over": OVER}
