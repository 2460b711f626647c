"""``at``, ``holding``, ``gripper_open`` and ``over``: what a robot's gripper does, and how it stands to an object.

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
"""How much farther than an object is wide a gripper opens to close around it, in metres."""
TIP_ROOM = 0.002
"""How far above the bottom of what it takes a gripper keeps the tips of its fingers, in metres."""

FINGER_FRICTION = 1.4
"""The coefficient of friction of the fingers' rubber, which is multiplied by that of what they hold."""

GRAVITY = 9.81
SLIPS = 1.05
"""How many times what friction bears at rest a body weighs at least that is proved to slip.

The robot also speeds up what it lifts, so it loses bodies that weigh less: it takes some to prove that none is held.
"""

RISE, ROOM, AJAR = 0.04, 0.03, 2.0
"""How far above an object the tool has to be to come over it, and how much farther than that is wide the fingers have
to be open, in metres; nearer than that, less: so many times what the tool misses."""

SLANT = 1e-9
"""The cosine of a side that is taken to be parallel to the opening of the gripper."""


def grip_width(situation: Situation, entity: str, robot: str) -> float:
    """Return how far a gripper is open when it holds an object with the tool turned as it is, in metres.

    Of a box that is turned between the pads they meet only what is between them: ends that stick out do not matter.
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
    """Return how far above the bottom of an object the tool grips it at least, in metres: so high is what it holds."""
    return robot.fingertip + TIP_ROOM


def bearable(scene: Scene, entity: str, robot: str) -> float:
    """Return the mass in kilograms that the friction of both fingers of a robot bears at rest, for a body's material.

    It is Coulomb's law, 2 mu F / g, with the force F of a finger and the product mu of both coefficients, as PyBullet
    combines them.
    """
    friction = FINGER_FRICTION * scene.material(entity).friction
    return 2 * friction * robot_of(scene, robot).grip_force / GRAVITY


def slips(scene: Scene, entity: str, robot: str) -> str | None:
    """Return in words that a body slips out of a gripper that lifts it, None where it need not."""
    heavy, most = weight(scene, entity), bearable(scene, entity, robot)
    if heavy > SLIPS * most:
        return f"{words(entity)} weighs {heavy:.3g} kg, and {_called(scene, robot)} lifts {most:.3g} kg by its friction"
    return None


def _at_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool misses the middle of the object."""
    robot, entity = arguments
    yield from _height_violations(situation, robot, entity)
    yield _off_centre(situation, robot, entity) - CENTRE_TOLERANCE


def _height_violations(situation: Situation, robot: str, entity: str) -> Iterator[float]:
    """Yield by how many metres the tool is above or below the object."""
    z = situation.tool(robot).position[2]
    yield z - situation.top(entity)
    yield situation.bottom(entity) - BELOW - z


def _off_centre(situation: Situation, robot: str, entity: str) -> float:
    """Return how far the tool is from the middle of the object, seen from above, in metres."""
    x, y, _ = situation.tool(robot).position
    cx, cy, _ = situation.pose(entity).position
    return math.hypot(x - cx, y - cy)


def _at_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return a disc around the axis of the object for the tool."""
    entity = arguments[1]
    x, y, _ = situation.pose(entity).position
    side = CENTRE_TOLERANCE - MARGIN
    low, high = situation.bottom(entity) - BELOW + MARGIN, situation.top(entity) - MARGIN
    return Volume((x - side, y - side, low), (x + side, y + side, high), rings=(Ring(x, y, 0.0, side),))


def _holding_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool misses the object, and the opening its width.

    The width is left out where the tool is so far away that it cannot matter.
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
    """Yield by how many metres the tool misses where it can grip the object.

    A box can be held anywhere but at its edges, for instance a long one at its end.
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

    Beside the object the tool has to rise above it, and around it the fingers have to be open wider than it is. Both
    demands grow with how far the tool is from where it grips, so the way does not leap.
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
    """Return a disc around the axis of the object for the tool, and the opening that grips the object."""
    width = grip_width(situation, arguments[1], arguments[0])
    tight = GRIP_TOLERANCE - MARGIN
    return _at_volume(situation, arguments, quaternion).meet(Volume(width=(width - tight, width + tight)))


def _open_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the gripper is short of open."""
    yield situation.robot(arguments[0]).opening - OPEN_TOLERANCE - situation.arm(arguments[0]).width


def _open_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the openings that count as open."""
    opening = situation.robot(arguments[0]).opening
    return Volume(width=(opening - OPEN_TOLERANCE, opening))


def _over_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool is below the top of a zone or an object, or beside it."""
    robot, entity = arguments
    x, y, z = situation.tool(robot).position
    yield situation.top(entity) - z
    places = to_local(situation.pose(entity), x, y)
    yield from (abs(at) - half for at, half in zip(places, _sides(situation, entity), strict=False))


def _over_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the room over a zone or an object for the tool."""
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
    """Return half the sides of an entity in its own axes, in metres."""
    return situation.half(entity) if situation.is_table(entity) else situation.shape(entity).half


def _at_demands(scene: Scene, arguments: Arguments, near: float = CENTRE_TOLERANCE) -> Iterator[Demand]:
    """Yield that the tool is at a body, `near` metres from its middle."""
    robot, entity = arguments
    for axis in (0, 1):
        yield from along(axis, between(centre(entity), centre(robot), -near, near))
    yield Z, Gap(bottom(entity), centre(robot), -BELOW)
    yield Z, Gap(centre(robot), top(entity), 0.0)


def _holding_demands(scene: Scene, arguments: Arguments) -> Iterator[Demand]:
    """Yield that the tool is somewhere over a body, for a long one can be held at its end."""
    half = scene.shapes[arguments[1]].half
    return _at_demands(scene, arguments, max(CENTRE_TOLERANCE, math.hypot(half[0], half[1])))


def _holding_impossible(scene: Scene, arguments: Arguments) -> Iterator[str]:
    """Yield that a body is too wide for the gripper, too low for its fingers, or too heavy."""
    robot, entity = arguments
    able, gripper = robot_of(scene, robot), _called(scene, robot)
    # Bodies stand upright and are gripped from above, so that their height does not count as a width.
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
    if other.name == "holding" and others[1] != entity:
        return f"{_called(scene, robot)} cannot hold {words(entity)} and {words(others[1])} at once"
    if other.name == "gripper_open":
        return f"{_called(scene, robot)} cannot be open while it holds {words(entity)}"
    return None


def _called(scene: Scene, robot: str) -> str:
    """Return which gripper is meant, in words."""
    return f"the {words(robot)} gripper" if len(scene.robots) > 1 else "the gripper"


AT = Predicate(
    name="at",
    violations=_at_violations,
    volume=_at_volume,
    sentence=states("the gripper {is} at {1}"),
    named=states("the {0} gripper {is} at {1}"),
    of_gripper=True,
    gripper=Gripper.AT,
    demands=_at_demands,
    told=180,
)
HOLDING = Predicate(
    name="holding",
    violations=_holding_violations,
    volume=_holding_volume,
    way=_holding_way,
    sentence=states("{1} {is} held by the gripper"),
    named=states("{1} {is} held by the {0} gripper"),
    subject=1,
    of_gripper=True,
    gripper=Gripper.HOLDS,
    impossible=_holding_impossible,
    demands=_holding_demands,
    excludes=_holding_excludes,
    told=10,
)
GRIPPER_OPEN = Predicate(
    name="gripper_open",
    violations=_open_violations,
    volume=_open_volume,
    sentence=states("the gripper {is} open"),
    named=states("the {0} gripper {is} open"),
    of_gripper=True,
    gripper=Gripper.OPEN,
    told=math.inf,
)
OVER = Predicate(
    name="over",
    violations=_over_violations,
    volume=_over_volume,
    sentence=states("the {0} gripper {is} over {1}"),
    of_gripper=True,
    gripper=Gripper.OVER,
    told=20,
)

PREDICATES = {"at": AT, "holding": HOLDING, "gripper_open": GRIPPER_OPEN, "over": OVER}
