"""The state of the world at one moment, as spatial predicates need it: poses, arms and openings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from prag_asp.errors import SceneError
from prag_asp.physics.extent import extent
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.witness import Arm
from prag_asp.scene.boxes import Box, Vector, box_of, corners_of
from prag_asp.scene.furniture import bounds, cavity_pose, part_pose
from prag_asp.scene.geometry import Pose, compose, finite, raised, yaw_quaternion
from prag_asp.scene.robots import Robot, robot_of
from prag_asp.scene.scene import Scene, Shape

TABLE_THICKNESS = 0.04


class Body(NamedTuple):
    """An object's pose, and the half-extents, corners and centre of its axis-aligned bounding box, in metres."""

    pose: Pose
    half: Vector
    low: Vector
    high: Vector
    centre: Vector


@dataclass(frozen=True)
class Situation:
    """The poses of the objects, and the arms by robot name.

    `openings` are the openings of furniture, in metres or radians; 0 by default. `tools` are the tool poses (those of
    the point between the fingertips) according to a simulator; missing poses are computed from the joint angles.

    `measured` caches the bounding boxes for poses, and is shared by situations that are made from one another.
    """

    scene: Scene
    poses: Mapping[str, Pose]
    arms: Mapping[str, Arm] = field(default_factory=dict)
    openings: Mapping[str, float] = field(default_factory=dict)
    tools: Mapping[str, Pose] = field(default_factory=dict)
    measured: dict[str, Body] = field(default_factory=dict, repr=False, compare=False)

    def arm(self, robot: str) -> Arm:
        """Return the arm of a robot.

        Raises:
            SceneError: the situation has no arm of that robot.
        """
        arm = self.arms.get(robot)
        if arm is None:
            raise SceneError(f"there is no arm of {robot} here; there are those of {', '.join(self.arms) or 'none'}")
        return arm

    def tool(self, robot: str) -> Pose:
        """Return the tool pose of a robot: the pose of the point between its fingertips.

        Raises:
            SceneError: the situation has no arm of that robot.
        """
        return self.tools.get(robot) or tool_pose(self.robot(robot), self.arm(robot).joints)

    def robot(self, name: str) -> Robot:
        """Return a robot by its name.

        Raises:
            SceneError: the scene has no robot with that name.
        """
        return robot_of(self.scene, name)

    def shape(self, entity: str) -> Shape:
        """Return the shape of an entity.

        Raises:
            SceneError: the scene assigns no shape to the entity's class.
        """
        shape = self.scene.shapes.get(entity)
        if shape is None:
            raise SceneError(f"{entity} has no shape; give its class one under [scene.shapes]")
        return shape

    def is_table(self, entity: str) -> bool:
        """Return whether an entity is the table."""
        return self.shape(entity).kind == "table"

    def is_surface(self, entity: str) -> bool:
        """Return whether an entity is the table or a zone, which is a part of the table top."""
        return self.shape(entity).traits.surface

    def pose(self, entity: str) -> Pose:
        """Return the pose of an object or a zone; for the table, the pose of the centre of its top.

        Raises:
            SceneError: the entity has no shape, or does not take part in this situation.
        """
        pose = self.poses.get(entity)
        if pose is not None:
            return pose
        if self.is_table(entity):
            x, y = self.scene.table.centre
            return Pose((x, y, 0.0))
        if self.shape(entity).kind == "zone":
            x, y, yaw = self.scene.fixed[entity]
            return Pose((x, y, 0.0), yaw_quaternion(yaw))
        raise SceneError(f"{entity} is not in this situation; its objects are {', '.join(self.poses) or 'none'}")

    def body(self, entity: str) -> Body:
        """Return the pose and the bounding box of an object, a zone, or the table top.

        Raises:
            SceneError: the entity has no shape, does not take part in this situation, or its pose is not finite.
        """
        cached = self.measured.get(entity)
        pose = self.poses.get(entity)
        if cached is not None and cached[0] is pose:
            return cached
        if pose is None and self.shape(entity).kind == "zone":
            pose = self.pose(entity)
        if pose is None:
            pose, (size_x, size_y) = self.pose(entity), self.scene.table.size
            return _boxed(pose, (pose.position, (size_x / 2, size_y / 2, 0.0)))
        if not finite(pose):
            raise SceneError(f"{entity} has the pose {pose}, which is not a finite position and rotation")
        shape = self.scene.shapes[entity]
        if shape.traits.furniture:
            corners = bounds(shape, pose, self.opening(entity))
            centre, half = box_of(corners)
            body = Body(pose, half, *corners, centre)
        else:
            offset, half = extent(shape, pose.quaternion)
            body = _boxed(pose, (_sum(pose.position, offset), half))
        self.measured[entity] = body
        return body

    @cached_property
    def bodies(self) -> tuple[tuple[str, Body], ...]:
        """The objects with their poses and bounding boxes."""
        return tuple([(entity, self.body(entity)) for entity in self.poses])

    def opening(self, entity: str) -> float:
        """Return the opening of furniture, in metres or radians."""
        return self.openings.get(entity, 0.0)

    def part(self, entity: str) -> Pose:
        """Return the pose of the moving part of furniture; for other bodies, their own pose."""
        shape, pose = self.shape(entity), self.pose(entity)
        return part_pose(shape, pose, self.opening(entity)) if shape.traits.furniture else pose

    def floor(self, entity: str) -> Pose:
        """Return the pose of the centre of the floor of a hollow body."""
        shape, pose = self.shape(entity), self.pose(entity)
        if shape.traits.furniture:
            return cavity_pose(shape, pose, self.opening(entity))
        if shape.model is not None and shape.model.cavity is not None:
            middle, _, yaw = shape.model.cavity
            return compose(pose, Pose(middle, yaw_quaternion(yaw)))
        return raised(pose, shape.wall - self.half(entity)[2])

    def half(self, entity: str) -> Vector:
        """Return the half-extents, in metres, of the axis-aligned bounding box of an entity."""
        return self.body(entity).half

    def own_half(self, entity: str) -> Vector:
        """Return the half-extents, in metres, of an entity in its own frame."""
        return self.half(entity) if self.is_table(entity) else self.shape(entity).half

    def top(self, entity: str) -> float:
        """Return the height of the highest point of an entity in metres."""
        return self.body(entity).high[2]

    def bottom(self, entity: str) -> float:
        """Return the height of the lowest point of an entity in metres."""
        return self.body(entity).low[2]

    def with_pose(self, entity: str, pose: Pose) -> Situation:
        """Return the situation with one object moved."""
        return self.with_poses({**self.poses, entity: pose})

    def with_poses(self, poses: Mapping[str, Pose]) -> Situation:
        """Return the situation with new poses of the objects."""
        return Situation(self.scene, poses, self.arms, self.openings, self.tools, self.measured)

    def with_arm(self, robot: str, arm: Arm) -> Situation:
        """Return the situation with a new state of an arm."""
        tools = {name: tool for name, tool in self.tools.items() if name != robot}
        return Situation(self.scene, self.poses, {**self.arms, robot: arm}, self.openings, tools, self.measured)

    def with_opening(self, entity: str, opening: float) -> Situation:
        """Return the situation with a different opening of furniture, whose contents do not move."""
        measured = {other: body for other, body in self.measured.items() if other != entity}
        openings = {**self.openings, entity: opening}
        return Situation(self.scene, self.poses, self.arms, openings, self.tools, measured)


def fixed_pose(scene: Scene, entity: str) -> Pose:
    """Return the pose of a fixed body of the scene."""
    x, y, yaw = scene.fixed[entity]
    return Pose((x, y, scene.shapes[entity].half[2]), yaw_quaternion(yaw))


def _boxed(pose: Pose, box: Box) -> Body:
    """Return a body, given its pose and its bounding box."""
    low, high = corners_of(box)
    return Body(pose, box[1], low, high, box[0])


def _sum(one: Vector, two: Vector) -> Vector:
    """Return the sum of two vectors."""
    return (one[0] + two[0], one[1] + two[1], one[2] + two[2])
