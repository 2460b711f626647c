"""Which bodies collide: bounding boxes first, then the closest points that the simulator finds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from prag_asp.physics.geometry import Vector
from prag_asp.physics.robot import Joints
from prag_asp.physics.situation import Situation, Standing
from prag_asp.physics.world.simulator import COLLISION, Simulator

Box = tuple[Vector, Vector]
BASE_LINK = -1


class ArmCollision(NamedTuple):
    """What the arm collides with, and whether the hand does: then no other arm configuration helps."""

    other: str
    by_hand: bool


def box(situation: Situation, entity: str) -> Box:
    """Return the bounding box of a body: its centre and its half sides in metres."""
    body = situation.body(entity)
    return body.centre, body.half


def boxes_meet(one: Box, two: Box) -> bool:
    """Tell whether two bounding boxes overlap."""
    (ax, ay, az), (ahx, ahy, ahz) = one
    (bx, by, bz), (bhx, bhy, bhz) = two
    return abs(ax - bx) < ahx + bhx and abs(ay - by) < ahy + bhy and abs(az - bz) < ahz + bhz + COLLISION


def colliding(
    simulator: Simulator, situation: Situation, moved: Iterable[str], objects: Iterable[str]
) -> tuple[str, str] | None:
    """Return a moved object and another, or the table, that it collides with; None where none do."""
    simulator.place(situation.poses, situation.openings)
    boxes, done = {entity: box(situation, entity) for entity in objects}, set[str]()
    for one in moved:
        done.add(one)
        if situation.bottom(one) < 0.0 and simulator.overlap(simulator.body(one), simulator.table) < COLLISION:
            return one, "the table"
        for two, other in boxes.items():
            if two in done or not boxes_meet(boxes[one], other):
                continue
            if simulator.overlap(simulator.body(one), simulator.body(two)) < COLLISION:
                return one, two
    return None


def arm_collision(
    simulator: Simulator, situation: Situation, joints: Joints, width: float, touched: str | None
) -> ArmCollision | None:
    """Return what the arm collides with, None where it is free; its fingers may touch `touched`.

    Where other arms stand around, neither the objects nor this arm may meet them.
    """
    simulator.place(situation.poses, situation.openings)
    simulator.turn_to(situation.acting)
    simulator.pose_arm(joints, width)
    robot = simulator.robot
    links = simulator.link_boxes()
    if any(low[2] < 0.0 for low, _ in links[1:]):
        for link, gap in simulator.arm_contacts(simulator.table):
            if gap < COLLISION and link > BASE_LINK:
                return ArmCollision("the table", link > robot.flange_link)
    bodies = [(entity, situation.body(entity)) for entity in situation.poses]
    highest = max([body.high[2] for _, body in bodies], default=0.0)
    low_links = [corners for corners in links if corners[0][2] <= highest]
    for entity, body in bodies:
        if not _touches_one((body.low, body.high), low_links):
            continue
        for link, gap in simulator.arm_contacts(simulator.body(entity)):
            if gap < COLLISION and not (entity == touched and link in robot.finger_links):
                return ArmCollision(entity, link > robot.flange_link)
    if simulator.self_overlap() < COLLISION:
        return ArmCollision("itself", False)
    for name, standing in situation.others.items():
        hit = _meets_standing(simulator, situation, name, standing)
        if hit is not None:
            return hit
    return None


def _meets_standing(simulator: Simulator, situation: Situation, name: str, standing: Standing) -> ArmCollision | None:
    """Return that the arm that acts, or an object, collides with an arm that stands still; None where none does."""
    other = simulator.arms[name]
    other.pose(standing.joints, standing.width)
    boxes = other.link_boxes()
    for entity in situation.poses:
        body = situation.body(entity)
        if not _touches_one((body.low, body.high), boxes):
            continue
        for link, gap in other.contacts(simulator.body(entity)):
            if gap < COLLISION and not (entity == standing.held and link in other.robot.finger_links):
                return ArmCollision(name, False)
    if any(_touches_one(box, boxes) for box in simulator.link_boxes()):
        for link, gap in simulator.arm_contacts(other.body):
            if gap < COLLISION:
                return ArmCollision(name, link > simulator.robot.flange_link)
    return None


def _touches_one(body: Box, links: Iterable[Box]) -> bool:
    """Tell whether a bounding box has a point in common with one of others, all as lowest and highest corner."""
    (ax, ay, az), (bx, by, bz) = body
    for (cx, cy, cz), (dx, dy, dz) in links:
        if ax <= dx and cx <= bx and ay <= dy and cy <= by and az <= dz and cz <= bz:
            return True
    return False
