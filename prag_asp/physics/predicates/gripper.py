"""``at``, ``holding``, ``gripper_open`` and ``over``: a gripper's width, and its pose relative to an object.

A gripper holds one object at a time, and is not open while it holds one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.grasps.antipodal import Grasp
from prag_asp.physics.grasps.body_grasps import body_grasps, lever, pad_contact
from prag_asp.physics.grasps.opposite_faces import is_never_spanned
from prag_asp.physics.grasps.pads import PadContact, ParallelGripper
from prag_asp.physics.predicates.gaps import ROUNDING, Demand, Gap, Z, along, between, bottom, centre, top
from prag_asp.physics.predicates.predicate import Arguments, Gripper, Predicate, states, words
from prag_asp.physics.predicates.volume import Ring, Volume, over_rectangle
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Quaternion, compose, heading, invert, rotate, to_local, turn_between, width_along
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
"""The smallest difference between the opening of a gripper and the width of an object that it grasps, in metres."""

TIP_ROOM = 0.002
"""The clearance of the fingertips above the bottom of a grasped object, in metres, unless that is flat."""

FLAT_TIP_ROOM = 0.0005
"""The clearance of the fingertips above the bottom of a flat object, in metres: more than what arms are off."""

PAD_OVERLAP = 0.002
"""The least height of the part of an object that is between the pads, in metres."""

FINGER_FRICTION = 1.4
"""The coefficient of friction of the rubber pads, which PyBullet multiplies by that of the object."""

GRAVITY = 9.81
SLIPS = 1.05
"""A body is proved to slip if its weight exceeds the friction at rest by this factor.

The robot also accelerates the object, so it may drop lighter bodies; a proof needs this margin.
"""

RISE, ROOM, AJAR = 0.04, 0.03, 2.0
"""The height of the tool above an object over which it moves, and the room between the fingers and the object, both in
metres; and the largest ratio of either to the distance by which the tool misses the grasp."""

NOTHING_BETWEEN = 0.02
"""By how many metres `holding` is missed if there is nothing between the pads, at the box around a body."""

LEVER = 0.05
"""What a turn of the tool by one radian counts on the way to a grasp, in metres: what it moves at the fingertips."""

SLANT = 1e-9
"""The cosine below which a side counts as parallel to the opening direction of the gripper."""


def grip_width(situation: Situation, entity: str, robot: str) -> float:
    """Return the opening with which a gripper holds an object in the present orientation of the tool, in metres.

    For a rotated box, only the part between the pads counts; for a body with a model, what is between them where the
    tool is. If there is nothing, it is 0.
    """
    if situation.shape(entity).model is not None:
        contact = contact_at(situation, entity, robot)
        return 0.0 if contact is None else contact.width
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


def contact_at(situation: Situation, entity: str, robot: str) -> PadContact | None:
    """Return what the pads of a gripper touch when they close on a body, None if there is nothing between them."""
    tool = compose(invert(situation.pose(entity)), situation.tool(robot))
    return pad_contact(situation.shape(entity), ParallelGripper.of(situation.robot(robot)), tool)


def lowest_grip(robot: Robot, height: float) -> float:
    """Return the least height of the tool above the bottom of an object that it grasps, in metres.

    An object that is lower than the fingers usually reach is flat: they close on its edges just above its support.
    """
    return robot.fingertip + (FLAT_TIP_ROOM if is_flat(robot, height) else TIP_ROOM)


def is_flat(robot: Robot, height: float) -> bool:
    """Return whether an object of a height in metres is lower than the fingers of a robot usually reach."""
    return height < robot.fingertip + TIP_ROOM - ROUNDING


def rise_over_flat(robot: Robot, height: float) -> float:
    """Return by how much the tool may be above the top of an object that it grasps, in metres; 0 unless it is flat."""
    return max(0.0, min(TIP_ROOM + robot.fingertip - height, robot.fingertip - PAD_OVERLAP))


def lowest_body() -> float:
    """Return the least height of an object that is held, in metres."""
    return FLAT_TIP_ROOM + PAD_OVERLAP


def bearable(scene: Scene, entity: str, robot: str) -> float:
    """Return the largest mass in kilograms that the fingers of a robot hold by friction, for the material of a body.

    By Coulomb's law it is 2 mu F / g, with the force F of a finger and the product mu of both coefficients, as PyBullet
    combines them.
    """
    return 2 * pad_friction(scene, entity) * robot_of(scene, robot).grip_force / GRAVITY


def pad_friction(scene: Scene, entity: str) -> float:
    """Return the coefficient of friction between the pads and a body, as PyBullet combines it."""
    return FINGER_FRICTION * scene.material(entity).friction


def slips(scene: Scene, entity: str, robot: str) -> str | None:
    """Return the reason, in words, why a body slips out of a gripper that lifts it; None if it may not slip."""
    heavy, most = weight(scene, entity), bearable(scene, entity, robot)
    if heavy > SLIPS * most:
        return f"{words(entity)} weighs {heavy:.3g} kg, and {_called(scene, robot)} lifts {most:.3g} kg by its friction"
    return None


def twists(situation: Situation, entity: str, robot: str) -> bool:
    """Return whether the weight of a body with a model turns it between the pads that hold it in the air.

    The friction of both pads bears the torque 2 mu F r, with the force F of a finger, the product mu of both
    coefficients and the radius of gyration r of the smaller contact. The margin is that of `SLIPS`.
    """
    contact, shape = contact_at(situation, entity, robot), situation.shape(entity)
    if contact is None:
        return False
    tool = compose(invert(situation.pose(entity)), situation.tool(robot))
    bears = 2 * pad_friction(situation.scene, entity) * situation.robot(robot).grip_force * contact.radius
    return GRAVITY * weight(situation.scene, entity) * lever(shape, tool, contact) > SLIPS * bears


def _tool_violations(situation: Situation, arguments: Arguments, even: bool) -> Iterator[float]:
    """Yield by how many metres the tool misses the height of the object, and its centre.

    An `even` body, a box, can be held anywhere except at its edges: a long one, for instance, near its end.
    """
    robot, entity = arguments
    shape, body = situation.shape(entity), situation.body(entity)
    x, y, z = situation.tool(robot).position
    if shape.model is not None:
        beyond = pad_reach(situation.robot(robot))
        yield from (
            abs(at - middle) - half - beyond for at, middle, half in zip((x, y, z), body.centre, body.half, strict=True)
        )
        return
    yield z - body.high[2] - rise_over_flat(situation.robot(robot), body.high[2] - body.low[2])
    yield body.low[2] - BELOW - z
    if even:
        (dx, dy), (half_x, half_y, _) = to_local(body.pose, x, y), shape.half
        yield max(abs(dx) - max(CENTRE_TOLERANCE, half_x - EDGE), abs(dy) - max(CENTRE_TOLERANCE, half_y - EDGE))
    else:
        cx, cy, _ = body.pose.position
        yield math.hypot(x - cx, y - cy) - CENTRE_TOLERANCE


def pad_reach(robot: Robot) -> float:
    """Return how far at most the tool is from the box around a body with a model that it holds, in metres.

    Both contacts are in the box and so is the middle between them, which is off the tool by at most the reach of a pad
    across the axis of the fingers, and by `GRIP_TOLERANCE` along it.
    """
    gripper = ParallelGripper.of(robot)
    return math.hypot(gripper.half_x, max(-gripper.low_z, gripper.high_z)) + GRIP_TOLERANCE


def _contact_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how much the pads miss opposite sides of a body with a model: metres, and radians of their friction."""
    robot, entity = arguments
    contact = contact_at(situation, entity, robot)
    if contact is None:
        yield NOTHING_BETWEEN
        return
    yield abs(situation.arm(robot).width - contact.width) - GRIP_TOLERANCE
    yield abs(contact.low + contact.high) / 2 - GRIP_TOLERANCE
    cone = math.atan(pad_friction(situation.scene, entity))
    for patch in contact.patches:
        yield math.acos(max(-1.0, min(1.0, patch.slope))) - cone


def _grip_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool misses the places where it can grip the object."""
    return _tool_violations(situation, arguments, situation.shape(arguments[1]).traits.even)


def _at_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return a disc for the tool around the vertical axis of the object."""
    entity = arguments[1]
    x, y, _ = situation.pose(entity).position
    side = CENTRE_TOLERANCE - MARGIN
    bottom, top = situation.bottom(entity), situation.top(entity)
    rise = rise_over_flat(situation.robot(arguments[0]), top - bottom)
    low, high = bottom - BELOW + MARGIN, top + rise - MARGIN
    return Volume((x - side, y - side, low), (x + side, y + side, high), rings=(Ring(x, y, 0.0, side),))


def _holding_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool misses the object, and the opening misses its width.

    The width is not compared if the tool is so far away that its error cannot be the largest.
    """
    robot, entity = arguments
    if situation.shape(entity).model is not None:
        beyond = list(_tool_violations(situation, arguments, even=False))
        yield from beyond
        if max(beyond) > 0.0:
            return
        yield from _contact_violations(situation, arguments)
        return
    places = []
    for missed in _grip_violations(situation, arguments):
        places.append(missed)
        yield missed
    width = situation.arm(robot).width
    if max(places) < max(width, 2 * math.hypot(*situation.shape(entity).half)):
        yield abs(width - grip_width(situation, entity, robot)) - GRIP_TOLERANCE


def _holding_way(situation: Situation, arguments: Arguments) -> float:
    """Return how far the tool and the fingers have to move to hold the object, in metres.

    The tool has to approach from above, and the fingers have to be wider open than the object. Both requirements grow
    with the distance of the tool from the grasp, so that the length is continuous.
    """
    robot, entity = arguments
    if situation.shape(entity).model is not None:
        return _way_to_grasp(situation, robot, entity)
    over, under, beside = _grip_violations(situation, arguments)
    aside, height = max(0.0, beside), over + under
    least = min(RISE, AJAR * aside + height)
    tool = aside + max(0.0, least - over) + max(0.0, over, least)
    room = min(ROOM, AJAR * max(0.0, over, under, beside))
    fingers = abs(situation.arm(robot).width - grip_width(situation, entity, robot) - room) + room - GRIP_TOLERANCE
    return tool + max(0.0, fingers)


def _way_to_grasp(situation: Situation, robot: str, entity: str) -> float:
    """Return how far the tool and the fingers have to move to the nearest grasp of a body with a model, in metres."""
    tool = compose(invert(situation.pose(entity)), situation.tool(robot))
    ways = [math.inf]
    for grasp in grasps_in_body(situation, entity, robot):
        far = math.dist(tool.position, grasp.tool.position)
        far += LEVER * turn_between(tool.quaternion, grasp.tool.quaternion)
        room = min(ROOM, AJAR * far)
        fingers = abs(situation.arm(robot).width - grasp.width - room) + room - GRIP_TOLERANCE
        ways.append(far + max(0.0, fingers))
    return min(ways)


def grasps_in_body(situation: Situation, entity: str, robot: str) -> tuple[Grasp, ...]:
    """Return the grasps of a body with a model in its own frame, the best first."""
    gripper = ParallelGripper.of(situation.robot(robot))
    return body_grasps(situation.shape(entity), gripper, pad_friction(situation.scene, entity))


def _holding_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return a disc for the tool around the vertical axis of the object, and the opening that grips it."""
    tight, (robot, entity) = GRIP_TOLERANCE - MARGIN, arguments
    if situation.shape(entity).model is not None:
        for grasp in grasps_in_body(situation, entity, robot):
            at = compose(situation.pose(entity), grasp.tool).position
            return Volume(at, at, width=(grasp.width - tight, grasp.width + tight))
        return Volume(width=(1.0, 0.0))
    width = grip_width(situation, entity, robot)
    return _at_volume(situation, arguments, quaternion).meet(Volume(width=(width - tight, width + tight)))


def _over_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the tool is below the top of a zone or an object, and beside it."""
    robot, entity = arguments
    x, y, z = situation.tool(robot).position
    yield situation.top(entity) - z
    places = to_local(situation.pose(entity), x, y)
    yield from (abs(at) - half for at, half in zip(places, situation.own_half(entity), strict=False))


def _over_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the region for the tool over a zone or an object."""
    pose, half = situation.pose(arguments[1]), situation.own_half(arguments[1])
    dx, dy = (max(0.0, side - OVER_MARGIN) for side in half[:2])
    heights = (situation.top(arguments[1]) + MARGIN, math.inf)
    return over_rectangle(pose.position, heading(pose.quaternion), (dx, dy), heights)


def _at_demands(scene: Scene, arguments: Arguments, near: float = CENTRE_TOLERANCE) -> Iterator[Demand]:
    """Yield that the tool is at the height of a body, at most `near` metres from its centre along each axis."""
    robot, entity = arguments
    if scene.shapes[entity].model is not None:
        beyond = pad_reach(robot_of(scene, robot))
        near = math.hypot(*scene.shapes[entity].half) + beyond
        for axis in (0, 1):
            yield from along(axis, between(centre(entity), centre(robot), -near, near))
        yield Z, Gap(bottom(entity), centre(robot), -beyond)
        yield Z, Gap(centre(robot), top(entity), -beyond)
        return
    for axis in (0, 1):
        yield from along(axis, between(centre(entity), centre(robot), -near, near))
    # However it is turned, a body is at least as high as its shortest side.
    rise = rise_over_flat(robot_of(scene, robot), min(scene.shapes[entity].size))
    yield Z, Gap(bottom(entity), centre(robot), -BELOW)
    yield Z, Gap(centre(robot), top(entity), -rise)


def _holding_impossible(scene: Scene, arguments: Arguments) -> Iterator[str]:
    """Yield that a body is too wide for the gripper, too low for the fingers, or too heavy.

    A body with a model can be narrow and high in parts, so the box around it proves nothing about it.
    """
    robot, entity = arguments
    able, gripper, shape = robot_of(scene, robot), _called(scene, robot), scene.shapes[entity]
    opens, heavy = f"{gripper} opens {able.opening * 1000:.0f} mm", weight(scene, entity)
    if shape.model is not None:
        if is_never_spanned(shape, ParallelGripper.of(able), pad_friction(scene, entity)):
            yield f"{words(entity)} is wider than the gripper between all sides that face each other, {opens}"
    else:
        # Bodies stand upright and are grasped from above, so their height does not count as a width.
        narrowest, height = shape.breadth(widest=False), shape.size[2]
        if narrowest > able.opening:
            yield f"{words(entity)} is {narrowest * 1000:.0f} mm wide, {opens}"
        if height < lowest_body() - ROUNDING:
            least = f"{gripper} takes what is at least {lowest_body() * 1000:.3g} mm high"
            yield f"{words(entity)} is {height * 1000:.3g} mm high, {least}"
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
    violations=lambda situation, arguments: _tool_violations(situation, arguments, even=False),
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
    # The tool is somewhere over the body, because a long one can be held at its end.
    demands=lambda scene, of: _at_demands(scene, of, max(CENTRE_TOLERANCE, math.hypot(*scene.shapes[of[1]].half[:2]))),
    excludes=_holding_excludes,
    caption_rank=10,
)
GRIPPER_OPEN = Predicate(
    name="gripper_open",
    violations=lambda situation, of: iter(
        [situation.robot(of[0]).opening - OPEN_TOLERANCE - situation.arm(of[0]).width]
    ),
    volume=lambda situation, of, quaternion: Volume(
        width=(situation.robot(of[0]).opening - OPEN_TOLERANCE, situation.robot(of[0]).opening)
    ),
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
