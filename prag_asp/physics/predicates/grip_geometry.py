"""How a gripper fits around a body: the opening with which it holds the body, and the heights of a grasp."""

from __future__ import annotations

import math

from prag_asp.physics.grasps.between_pads import PadWindow, width_between
from prag_asp.physics.grasps.body_grasps import pad_contact
from prag_asp.physics.grasps.pads import PadContact, ParallelGripper
from prag_asp.physics.predicates.gaps import ROUNDING
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Pose, compose, invert
from prag_asp.scene.robots import Robot

GRIP_TOLERANCE = 0.002
"""The tolerance in metres between the opening of a gripper and the width of the body that it holds."""

CLEARANCE = 0.006
"""The smallest difference between the opening of a gripper and the width of an object that it grasps, in metres."""

TIP_ROOM = 0.002
"""The clearance of the fingertips above the bottom of a grasped object that is not flat, in metres."""

FLAT_TIP_ROOM = 0.0005
"""The clearance of the fingertips above the bottom of a flat object, in metres: more than the positioning error of
arms."""

PAD_OVERLAP = 0.002
"""The minimum height of the part of an object between the pads, in metres."""


def grip_width(situation: Situation, entity: str, robot: str, tool: Pose | None = None) -> float:
    """Return the width in metres of the material between the pads of a gripper when they close on an object.

    The width is 0 if there is nothing between them. For a body without a model, `tool` replaces the pose of the tool.
    """
    shape = situation.shape(entity)
    if shape.model is not None:
        contact = contact_at(situation, entity, robot)
        return 0.0 if contact is None else contact.width
    window = PadWindow.of(situation.robot(robot))
    return width_between(shape, situation.pose(entity), window, tool or situation.tool(robot))


def contact_at(situation: Situation, entity: str, robot: str) -> PadContact | None:
    """Return the contact of a gripper's pads when they close on a body, or None if there is nothing between them."""
    tool = compose(invert(situation.pose(entity)), situation.tool(robot))
    return pad_contact(situation.shape(entity), ParallelGripper.of(situation.robot(robot)), tool)


def lowest_grip(robot: Robot, height: float) -> float:
    """Return the minimum height of the tool above the bottom of a grasped object, in metres.

    An object that is lower than the fingers usually reach counts as flat: the fingers then close on its edges just
    above its support.
    """
    return robot.fingertip + (FLAT_TIP_ROOM if is_flat(robot, height) else TIP_ROOM)


def is_flat(robot: Robot, height: float) -> bool:
    """Return whether an object of a given height in metres is lower than the fingers of a robot usually reach."""
    return height < robot.fingertip + TIP_ROOM - ROUNDING


def rise_over_flat(robot: Robot, height: float) -> float:
    """Return the maximum height in metres of the tool above the top of a grasped object, or 0 if it is not flat."""
    rise = TIP_ROOM + robot.fingertip - height
    return min(rise, robot.fingertip - PAD_OVERLAP) if rise > 0.0 else 0.0


def lowest_body() -> float:
    """Return the minimum height of a held object, in metres."""
    return FLAT_TIP_ROOM + PAD_OVERLAP


def pad_reach(robot: Robot) -> float:
    """Return the maximum distance in metres of the tool from the bounding box of a held body with a model.

    Both contacts are in the box, and so is their midpoint, whose offset from the tool is at most the reach of a pad
    perpendicular to the axis of the fingers, and at most `GRIP_TOLERANCE` along it.
    """
    gripper = ParallelGripper.of(robot)
    return math.hypot(gripper.half_x, max(-gripper.low_z, gripper.high_z)) + GRIP_TOLERANCE
