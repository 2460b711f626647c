"""Collision checks: bounding boxes first, then the closest points that the simulator finds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.simulator import COLLISION, Simulator
from prag_asp.scene.boxes import Box, Corners, widened
from prag_asp.scene.robots import Joints

BASE_LINK = -1
ARMS_APART = 0.01
"""The distance in metres that arms keep from each other, because arms that barely miss press on each other in motion.
"""


class ArmCollision(NamedTuple):
    """The body with which the arm collides, and whether the hand collides.

    If the hand collides, no other configuration for the tool pose helps.
    """

    other: str
    by_hand: bool


def box(situation: Situation, entity: str) -> Box:
    """Return the bounding box of a body: its centre and half-extents in metres."""
    body = situation.body(entity)
    return body.centre, body.half


def boxes_meet(one: Box, two: Box) -> bool:
    """Return whether two bounding boxes overlap."""
    (ax, ay, az), (ahx, ahy, ahz) = one
    (bx, by, bz), (bhx, bhy, bhz) = two
    return abs(ax - bx) < ahx + bhx and abs(ay - by) < ahy + bhy and abs(az - bz) < ahz + bhz + COLLISION


def colliding(
    simulator: Simulator, situation: Situation, changed: Iterable[str], objects: Iterable[str]
) -> tuple[str, str] | None:
    """Return a moved object and the object or table with which it collides, or None if there is no collision."""
    boxes, done = {entity: box(situation, entity) for entity in objects}, set[str]()
    for one in changed:
        done.add(one)
        if situation.bottom(one) < 0.0:
            simulator.place(situation.poses, situation.openings)
            if simulator.overlap(simulator.body(one), simulator.table) < COLLISION:
                return one, "the table"
        for two, other in boxes.items():
            if two in done or not boxes_meet(boxes[one], other):
                continue
            simulator.place(situation.poses, situation.openings)
            if simulator.overlap(simulator.body(one), simulator.body(two)) < COLLISION:
                return one, two
    return None


def overlap_depth(simulator: Simulator, situation: Situation, one: str, two: str) -> float:
    """Return the penetration depth of two objects in metres; the second may be the table."""
    simulator.place(situation.poses, situation.openings)
    other = simulator.bodies.get(two, simulator.table)
    return -simulator.overlap(simulator.body(one), other)


def arm_collision(
    simulator: Simulator, situation: Situation, joints: Joints, width: float, touched: str | None
) -> ArmCollision | None:
    """Return the acting arm's collision at given joint angles, or None; its fingers may touch the object `touched`.

    The other arms are as in the situation; they must not collide with the objects or with this arm.
    """
    arm, flange = simulator.arm, simulator.robot.flange_link
    boxes = arm.link_boxes(joints, width)
    for link, (low, _) in zip(arm.robot.links, boxes, strict=True):
        if low[2] < 0.0 and link > BASE_LINK:
            arm.pose(joints, width)
            if _deep(arm.contacts(simulator.table, [link])) is not None:
                return ArmCollision("the table", link > flange)
    hit = _meets_object(simulator, situation, simulator.acting, Arm(joints, width, touched))
    if hit is not None:
        entity, link = hit
        return ArmCollision(entity, link > flange)
    if arm.self_overlap(joints, width) < COLLISION:
        return ArmCollision("itself", False)
    for name, other in situation.arms.items():
        if name == simulator.acting:
            continue
        if _meets_object(simulator, situation, name, other) is not None:
            return ArmCollision(name, False)
        met = _meets_arm(simulator, name, other, joints, width)
        if met is not None:
            return ArmCollision(name, met > flange)
    return None


def _meets_object(simulator: Simulator, situation: Situation, name: str, arm: Arm) -> tuple[str, int] | None:
    """Return an object and an arm link that collide, or None if there are none; fingers may touch a held object."""
    simulated = simulator.arms[name]
    robot = simulated.robot
    bodies = situation.bodies
    highest = max([body.high[2] for _, body in bodies], default=0.0)
    boxes = zip(robot.links, simulated.link_boxes(arm.joints, arm.width), strict=True)
    low_links = [(link, corners) for link, corners in boxes if corners[0][2] <= highest]
    for entity, body in bodies:
        links = _touching((body.low, body.high), low_links)
        if entity == arm.held:
            links = [link for link in links if link not in robot.finger_links]
        if links:
            simulator.place(situation.poses, situation.openings)
            simulated.pose(arm.joints, arm.width)
            link = _deep(simulated.contacts(simulator.body(entity), links))
            if link is not None:
                return entity, link
    return None


def _meets_arm(simulator: Simulator, name: str, arm: Arm, joints: Joints, width: float) -> int | None:
    """Return a link of the acting arm that is closer than `ARMS_APART` to another arm, or None if there is none."""
    acting, other = simulator.arm, simulator.arms[name]
    boxes = [*zip(other.robot.links, other.link_boxes(arm.joints, arm.width), strict=True)]
    links = zip(acting.robot.links, acting.link_boxes(joints, width), strict=True)
    near = [link for link, corners in links if _touching(widened(corners, ARMS_APART), boxes)]
    if not near:
        return None
    acting.pose(joints, width)
    other.pose(arm.joints, arm.width)
    return next((link for link, _ in acting.contacts(other.body, near, ARMS_APART)), None)


def _deep(contacts: Iterable[tuple[int, float]]) -> int | None:
    """Return a link whose contact is a collision, or None if there is none."""
    return next((link for link, gap in contacts if gap < COLLISION), None)


def _touching(body: Corners, links: Iterable[tuple[int, Corners]]) -> list[int]:
    """Return the links whose bounding boxes intersect another box."""
    (ax, ay, az), (bx, by, bz) = body
    return [
        link
        for link, ((cx, cy, cz), (dx, dy, dz)) in links
        if ax <= dx and cx <= bx and ay <= dy and cy <= by and az <= dz and cz <= bz
    ]
