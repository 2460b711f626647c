"""Which bodies collide: bounding boxes first, then the closest points that the simulator finds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from prag_asp.physics.geometry import Pose, Vector, extents
from prag_asp.physics.robot import Joints
from prag_asp.physics.simulator import COLLISION, Simulator, boxes_touch
from prag_asp.physics.situation import Situation

Box = tuple[Vector, Vector]
BASE_LINK = -1


class ArmCollision(NamedTuple):
    """What the arm collides with, and whether the hand does: then no other arm configuration helps."""

    other: str
    by_hand: bool


def box(situation: Situation, entity: str) -> Box:
    """Return the bounding box of a body: its centre and its half sides in metres."""
    return situation.pose(entity).position, situation.half(entity)


def boxes_meet(one: Box, two: Box, spacing: float = 0.0) -> bool:
    """Tell whether two bounding boxes overlap, the first widened by `spacing` metres sideways."""
    (ax, ay, az), (ahx, ahy, ahz) = one
    (bx, by, bz), (bhx, bhy, bhz) = two
    return (
        abs(ax - bx) < ahx + bhx + spacing
        and abs(ay - by) < ahy + bhy + spacing
        and abs(az - bz) < ahz + bhz + COLLISION
    )


def _corners(centre: Vector, half: Vector) -> Box:
    """Return the lowest and the highest corner of a bounding box."""
    (x, y, z), (hx, hy, hz) = centre, half
    return (x - hx, y - hy, z - hz), (x + hx, y + hy, z + hz)


def colliding(
    simulator: Simulator, situation: Situation, moved: Iterable[str], objects: Iterable[str]
) -> tuple[str, str] | None:
    """Return a moved object and another, or the table, that it collides with; None where none do."""
    simulator.place(situation.poses)
    boxes, done = {entity: box(situation, entity) for entity in objects}, set[str]()
    for one in moved:
        done.add(one)
        if (
            situation.bottom(one) < 0.0
            and simulator.overlap(simulator.body(one), simulator.table) < COLLISION
        ):
            return one, "the table"
        for two, other in boxes.items():
            if two in done or not boxes_meet(boxes[one], other):
                continue
            if simulator.overlap(simulator.body(one), simulator.body(two)) < COLLISION:
                return one, two
    return None


def arm_collision(
    simulator: Simulator, poses: Mapping[str, Pose], joints: Joints, width: float, touched: str | None
) -> ArmCollision | None:
    """Return what the arm collides with, None where it is free; its fingers may touch `touched`."""
    simulator.place(poses)
    simulator.pose_arm(joints, width)
    robot = simulator.robot
    links = [simulator.link_box(link) for link in robot.links]
    if any(low[2] < 0.0 for low, _ in links[1:]):
        for link, gap in simulator.arm_contacts(simulator.table):
            if gap < COLLISION and link > BASE_LINK:
                return ArmCollision("the table", link > robot.flange_link)
    bodies = {
        entity: _corners(pose.position, extents(simulator.scene.shapes[entity], pose.quaternion))
        for entity, pose in poses.items()
    }
    highest = max((high[2] for _, high in bodies.values()), default=0.0)
    low_links = [corners for corners in links if corners[0][2] <= highest]
    for entity, body in bodies.items():
        if not any(boxes_touch(body, link_box) for link_box in low_links):
            continue
        for link, gap in simulator.arm_contacts(simulator.body(entity)):
            if gap < COLLISION and not (entity == touched and link in robot.finger_links):
                return ArmCollision(entity, link > robot.flange_link)
    if simulator.self_overlap() < COLLISION:
        return ArmCollision("itself", False)
    return None
