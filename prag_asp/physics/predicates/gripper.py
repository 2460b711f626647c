"""``at``, ``holding``, ``gripper_open`` and ``over``: the opening of a gripper, and its pose relative to an object.

A gripper holds one object at a time, and is not open while it holds one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.extent import silhouette
from prag_asp.physics.grasps.opposite_faces import is_never_spanned
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.predicates.gaps import ROUNDING, Demand, Gap, Z, along, between, bottom, centre, top
from prag_asp.physics.predicates.grip_friction import grasps_in_body, gripper_words, pad_friction
from prag_asp.physics.predicates.grip_geometry import (
    GRIP_TOLERANCE,
    contact_at,
    grip_width,
    lowest_body,
    pad_reach,
    rise_over_flat,
)
from prag_asp.physics.predicates.predicate import Arguments, Gripper, Predicate, states, words
from prag_asp.physics.predicates.volume import Ring, Volume, over_polygon, over_rectangle
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import (
    Pose,
    Quaternion,
    compose,
    heading,
    inside_by,
    invert,
    rotate,
    to_local,
    turn_between,
    width_along,
)
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import weight

CENTRE_TOLERANCE = 0.015
"""The maximum offset of a tool from the centre of a held body along each horizontal axis, in metres."""

BELOW = 0.005
"""The maximum depth of a tool below a held body, in metres."""

EDGE = 0.01
"""The minimum distance of a tool from the edges of a box that it holds, in metres."""

OPEN_TOLERANCE = 0.001
"""The tolerance in metres for the opening of an open gripper."""

MARGIN, OVER_MARGIN = 0.001, 0.003
"""The distances in metres by which sampled tools and widths stay within the tolerances, and sampled tools over a body
stay within its sides.

Kinematics is not exact, so samples on a bound could violate it.
"""

RISE, ROOM, AJAR = 0.04, 0.03, 2.0
"""The height of the tool above an object that it passes over, and the clearance between the fingers and the object,
both in metres; and the largest ratio of either of them to the distance by which the tool misses the grasp."""

NOTHING_BETWEEN = 0.02
"""The violation of `holding`, in metres, if the tool is at the bounding box of a body with nothing between the pads."""

LEVER = 0.05
"""The distance in metres that counts as much as a rotation of the tool by one radian."""


def _tool_violations(situation: Situation, arguments: Arguments, even: bool) -> Iterator[float]:
    """Yield the distances in metres of the tool from the height of the object, and from its centre.

    An `even` body, which is a box, can be held anywhere except at its edges; a long box, for instance, can be held near
    its end.
    """
    robot, entity = arguments
    if situation.shape(entity).model is not None:
        beyond, body = pad_reach(situation.robot(robot)), situation.body(entity)
        sides = zip(situation.tool(robot).position, body.centre, body.half, strict=True)
        yield from (abs(at - middle) - half - beyond for at, middle, half in sides)
        return
    yield from _heights(situation, robot, entity)
    yield _aside(situation, robot, entity, even)


def _heights(situation: Situation, robot: str, entity: str) -> tuple[float, float]:
    """Return how far in metres the tool is above and below the heights at which it can grip an object without a model.

    An environment needs these numbers for each object in each step.
    """
    body, z = situation.body(entity), situation.tool(robot).position[2]
    low, high = body.low[2], body.high[2]
    return z - high - rise_over_flat(situation.robot(robot), high - low), low - BELOW - z


def _aside(situation: Situation, robot: str, entity: str, even: bool) -> float:
    """Return the horizontal distance in metres of the tool from the places where it can grip an object."""
    (x, y, _), pose = situation.tool(robot).position, situation.body(entity).pose
    if even:
        (dx, dy), (half_x, half_y, _) = to_local(pose, x, y), situation.shape(entity).half
        return max(abs(dx) - max(CENTRE_TOLERANCE, half_x - EDGE), abs(dy) - max(CENTRE_TOLERANCE, half_y - EDGE))
    return math.hypot(x - pose.position[0], y - pose.position[1]) - CENTRE_TOLERANCE


def _contact_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the errors of the pads at opposite sides of a body with a model, in metres and, for the cone, radians."""
    robot, entity = arguments
    contact = contact_at(situation, entity, robot)
    if contact is None:
        yield NOTHING_BETWEEN
        return
    yield abs(situation.arm(robot).width - contact.width) - GRIP_TOLERANCE
    yield abs(contact.low + contact.high) / 2 - GRIP_TOLERANCE
    friction = pad_friction(situation.scene, entity)
    for cosine in contact.cosines(friction):
        yield math.acos(max(-1.0, min(1.0, cosine))) - math.atan(friction)


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
    """Yield the distances in metres of the tool from the object, and of the fingers from the material between the pads.

    The width is not computed if the tool is so far away that the error of the width cannot be the largest error.
    """
    robot, entity = arguments
    shape = situation.shape(entity)
    if shape.model is not None:
        beyond = list(_tool_violations(situation, arguments, even=False))
        yield from beyond
        if max(beyond) > 0.0:
            return
        yield from _contact_violations(situation, arguments)
        return
    over, under = _heights(situation, robot, entity)
    yield over
    yield under
    beside = _aside(situation, robot, entity, shape.traits.even)
    yield beside
    farthest, tool = max(over, under, beside), situation.tool(robot)
    width = situation.arm(robot).width
    # both of these bounds exceed the largest error; the first one is cheaper
    if farthest < max(width, 2 * math.hypot(*shape.half)) and farthest < max(
        width, min(shape.size), _whole_width(situation, entity, tool)
    ):
        tool = tool if farthest <= 0.0 else _nearest_tool(situation, arguments)
        between = grip_width(situation, entity, robot, tool)
        yield abs(width - between) - GRIP_TOLERANCE
        # Pads at a corner, or at the upper half of a ball, do not hold opposite sides.
        yield min(shape.size) - between - GRIP_TOLERANCE


def _whole_width(situation: Situation, entity: str, tool: Pose) -> float:
    """Return the width in metres of an object without a model along the axis on which the fingers open."""
    opening = rotate(tool.quaternion, (0.0, 1.0, 0.0))
    return width_along(situation.shape(entity), situation.pose(entity).quaternion, opening)


def _nearest_tool(situation: Situation, arguments: Arguments) -> Pose:
    """Return the tool of a gripper, moved to the nearest place where it can grip an object without a model."""
    robot, entity = arguments
    tool, body = situation.tool(robot), situation.body(entity)
    (x, y, z), (centre_x, centre_y, _) = tool.position, body.pose.position
    rise = rise_over_flat(situation.robot(robot), body.high[2] - body.low[2])
    z = min(max(z, body.low[2] - BELOW), body.high[2] + rise)
    if situation.shape(entity).traits.even:
        far_x, far_y = (max(CENTRE_TOLERANCE, half - EDGE) for half in situation.shape(entity).half[:2])
        dx, dy = to_local(body.pose, x, y)
        dx, dy = min(max(dx, -far_x), far_x), min(max(dy, -far_y), far_y)
        cosine, sine = heading(body.pose.quaternion)
        dx, dy = cosine * dx - sine * dy, sine * dx + cosine * dy
    else:
        dx, dy = x - centre_x, y - centre_y
        share = CENTRE_TOLERANCE / max(CENTRE_TOLERANCE, math.hypot(dx, dy))
        dx, dy = share * dx, share * dy
    return tool._replace(position=(centre_x + dx, centre_y + dy, z))


def _holding_way(situation: Situation, arguments: Arguments) -> float:
    """Return the distance in metres that the tool and the fingers have to move to hold the object.

    The tool has to approach from above, and the opening has to be wider than the object. Both requirements grow with
    the distance of the tool from the grasp, so that the result is continuous.
    """
    robot, entity = arguments
    if situation.shape(entity).model is not None:
        return _way_to_grasp(situation, robot, entity)
    over, under = _heights(situation, robot, entity)
    beside = _aside(situation, robot, entity, situation.shape(entity).traits.even)
    aside, height = max(0.0, beside), over + under
    least = min(RISE, AJAR * aside + height)
    tool = aside + max(0.0, least - over) + max(0.0, over, least)
    room = min(ROOM, AJAR * max(0.0, over, under, beside))
    middle = situation.tool(robot)._replace(position=situation.pose(entity).position)
    between = grip_width(situation, entity, robot, middle)
    fingers = abs(situation.arm(robot).width - between - room) + room - GRIP_TOLERANCE
    return tool + max(0.0, fingers)


def _way_to_grasp(situation: Situation, robot: str, entity: str) -> float:
    """Return the distance, in metres, of the tool and the fingers from the nearest grasp of a body with a model."""
    tool = compose(invert(situation.pose(entity)), situation.tool(robot))
    ways = [math.inf]
    for grasp in grasps_in_body(situation, entity, robot):
        far = math.dist(tool.position, grasp.tool.position)
        far += LEVER * turn_between(tool.quaternion, grasp.tool.quaternion)
        room = min(ROOM, AJAR * far)
        fingers = abs(situation.arm(robot).width - grasp.width - room) + room - GRIP_TOLERANCE
        ways.append(far + max(0.0, fingers))
    return min(ways)


def _holding_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the place for the tool (the object's centre or best grasp), and the opening for gripping it."""
    tight, (robot, entity) = GRIP_TOLERANCE - MARGIN, arguments
    if situation.shape(entity).model is not None:
        for grasp in grasps_in_body(situation, entity, robot):
            at = compose(situation.pose(entity), grasp.tool).position
            return Volume(at, at, width=(grasp.width - tight, grasp.width + tight))
        return Volume(width=(1.0, 0.0))
    at = situation.pose(entity).position
    width = grip_width(situation, entity, robot, situation.tool(robot)._replace(position=at))
    return Volume(at, at, width=(width - tight, width + tight))


def _over_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the distances in metres of the tool below the top of a zone or an object, and beyond its sides."""
    robot, entity = arguments
    x, y, z = situation.tool(robot).position
    yield situation.top(entity) - z
    if situation.shape(entity).model is not None:
        yield -inside_by(silhouette(situation.shape(entity), situation.pose(entity)), (x, y))
        return
    places = to_local(situation.pose(entity), x, y)
    yield from (abs(at) - half for at, half in zip(places, situation.own_half(entity), strict=False))


def _over_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the region for the tool over a zone or an object."""
    pose, half = situation.pose(arguments[1]), situation.own_half(arguments[1])
    dx, dy = (max(0.0, side - OVER_MARGIN) for side in half[:2])
    heights = (situation.top(arguments[1]) + MARGIN, math.inf)
    if situation.shape(arguments[1]).model is not None:
        return over_polygon(silhouette(situation.shape(arguments[1]), pose), OVER_MARGIN, heights)
    return over_rectangle(pose.position, heading(pose.quaternion), (dx, dy), heights)


def _at_demands(scene: Scene, arguments: Arguments, near: float = CENTRE_TOLERANCE) -> Iterator[Demand]:
    """Yield constraints that the tool is at a body's height and is near its centre, within `near` metres per axis."""
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
    # In any orientation, a body is at least as high as its shortest side.
    rise = rise_over_flat(robot_of(scene, robot), min(scene.shapes[entity].size))
    yield Z, Gap(bottom(entity), centre(robot), -BELOW)
    yield Z, Gap(centre(robot), top(entity), -rise)


def _holding_impossible(scene: Scene, arguments: Arguments) -> Iterator[str]:
    """Yield the reasons why a body is too wide for the gripper, too flat for the fingers, or too heavy.

    A body with a model can have narrow or high parts, so its bounding box proves nothing.
    """
    robot, entity = arguments
    able, gripper, shape = robot_of(scene, robot), gripper_words(scene, robot), scene.shapes[entity]
    opens, heavy = f"{gripper} opens only to {able.opening * 1000:.0f} mm", weight(scene, entity)
    if shape.model is not None:
        if is_never_spanned(shape, ParallelGripper.of(able), pad_friction(scene, entity)):
            yield f"all opposite sides, edges and corners of {words(entity)} are too far apart: {opens}"
    else:
        # Bodies stand upright and are grasped from above, so their height does not count as a width.
        narrowest, height = shape.breadth(widest=False), shape.size[2]
        if narrowest > able.opening:
            yield f"{words(entity)} is {narrowest * 1000:.0f} mm wide, but {opens}"
        if height < lowest_body() - ROUNDING:
            least = f"{gripper} holds only bodies that are at least {lowest_body() * 1000:.3g} mm high"
            yield f"{words(entity)} is {height * 1000:.3g} mm high, but {least}"
    if heavy > able.payload:
        yield f"{words(entity)} weighs {heavy:.3g} kg, but {gripper} carries at most {able.payload:g} kg"


def _holding_excludes(scene: Scene, arguments: Arguments, other: Predicate, others: Arguments) -> str | None:
    """Return the reason if the gripper would hold two objects, or hold one while it is open; otherwise None."""
    robot, entity = arguments
    if others[0] != robot:
        return None
    if other.gripper is Gripper.HOLDS and others[1] != entity:
        return f"{gripper_words(scene, robot)} cannot hold {words(entity)} and {words(others[1])} at once"
    if other.gripper is Gripper.OPEN:
        return f"{gripper_words(scene, robot)} cannot be open while it holds {words(entity)}"
    return None


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
    # The tool may be anywhere over the body, because a long body can be held at its end.
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
