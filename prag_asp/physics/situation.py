"""What a spatial predicate can see of one moment: where everything is, and what the gripper does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from prag_asp.errors import SceneError
from prag_asp.physics.robot import Joints, Robot, robot_of
from prag_asp.scene.boxes import Corners, Vector, box_of, corners_of
from prag_asp.scene.furniture import bounds, cavity_pose, part_pose
from prag_asp.scene.geometry import Pose, extents, finite, raised, yaw_quaternion
from prag_asp.scene.model import Scene, Shape

TABLE_THICKNESS = 0.04


class Body(NamedTuple):
    """An object's pose, half the sides of its bounding box as it is turned, its corners and its centre; metres."""

    pose: Pose
    half: Vector
    low: Vector
    high: Vector
    centre: Vector


class Standing(NamedTuple):
    """An arm that stands still while another one acts: its joints, its tool, how far it is open, what it holds.

    `grasp` is the pose of the `held` object in the frame of the tool, `above` the configuration straight above the
    gripper's place, kept while the gripper is down at an object.
    """

    joints: Joints
    tool: Pose
    width: float
    held: str | None = None
    grasp: Pose | None = None
    above: Joints | None = None


@dataclass(frozen=True)
class Situation:
    """The poses of the objects, the pose of the point between the finger tips, the opening of the gripper in metres.

    `openings` say how far furniture is open, in metres or radians, where it is.

    `measured` remembers the boxes of poses already seen; situations made from one another share it. Where there are
    several robots the tool and the opening are those of the `acting` one, and the `others` stand still.
    """

    scene: Scene
    poses: Mapping[str, Pose]
    tool: Pose
    width: float
    measured: dict[str, Body] = field(default_factory=dict, repr=False, compare=False)
    openings: Mapping[str, float] = field(default_factory=dict)
    acting: str = ""
    others: Mapping[str, Standing] = field(default_factory=dict)

    def hand(self, robot: str) -> tuple[Pose, float]:
        """Return the tool and the opening of a robot; those of the acting one where no other has that name."""
        other = self.others.get(robot)
        return (self.tool, self.width) if other is None else (other.tool, other.width)

    def robot(self, name: str) -> Robot:
        """Return a robot by its name, the acting one where there is none of that name."""
        return robot_of(self.scene, name if name in self.others else self.acting)

    def shape(self, entity: str) -> Shape:
        """Return the shape of an entity.

        Raises:
            SceneError: the scene gives its class no shape.
        """
        shape = self.scene.shapes.get(entity)
        if shape is None:
            raise SceneError(f"{entity} has no shape; give its class one under [scene.shapes]")
        return shape

    def is_table(self, entity: str) -> bool:
        """Tell whether an entity is the table."""
        return self.shape(entity).kind == "table"

    def is_surface(self, entity: str) -> bool:
        """Tell whether an entity is the table, or a zone, which is a part of its top."""
        return self.shape(entity).traits.surface

    def pose(self, entity: str) -> Pose:
        """Return the pose of an object or a zone; the table's is the centre of its top.

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
        """Return the pose and the bounding box of an object, a zone, or the table's top.

        Raises:
            SceneError: the entity has no shape, does not take part in this situation, or its pose is not finite.
        """
        known = self.measured.get(entity)
        pose = self.poses.get(entity)
        if known is not None and known[0] is pose:
            return known
        if pose is None and self.shape(entity).kind == "zone":
            pose = self.pose(entity)
        if pose is None:
            return _box(self.pose(entity), (self.scene.table.size[0] / 2, self.scene.table.size[1] / 2, 0.0))
        if not finite(pose):
            raise SceneError(f"{entity} has the pose {pose}, which is not a finite position and rotation")
        shape = self.scene.shapes[entity]
        if shape.traits.furniture:
            body = _between(pose, bounds(shape, pose, self.opening(entity)))
        else:
            body = _box(pose, extents(shape, pose.quaternion))
        self.measured[entity] = body
        return body

    @cached_property
    def bodies(self) -> tuple[tuple[str, Body], ...]:
        """The objects with their poses and bounding boxes."""
        return tuple([(entity, self.body(entity)) for entity in self.poses])

    def opening(self, entity: str) -> float:
        """Return how far furniture is open, in metres or radians."""
        return self.openings.get(entity, 0.0)

    def part(self, entity: str) -> Pose:
        """Return the pose of the moving part of furniture, and of other bodies their own."""
        shape, pose = self.shape(entity), self.pose(entity)
        return part_pose(shape, pose, self.opening(entity)) if shape.traits.furniture else pose

    def floor(self, entity: str) -> Pose:
        """Return the pose of the middle of the floor of something hollow."""
        shape, pose = self.shape(entity), self.pose(entity)
        if shape.traits.furniture:
            return cavity_pose(shape, pose, self.opening(entity))
        return raised(pose, shape.wall - self.half(entity)[2])

    def half(self, entity: str) -> Vector:
        """Return half the sides of the bounding box of an entity as it is turned, in metres."""
        return self.body(entity).half

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
        """Return the situation with other poses of the objects."""
        return Situation(
            self.scene, poses, self.tool, self.width, self.measured, self.openings, self.acting, self.others
        )

    def with_tool(self, tool: Pose, width: float) -> Situation:
        """Return the situation with the gripper elsewhere or open otherwise."""
        return Situation(self.scene, self.poses, tool, width, self.measured, self.openings, self.acting, self.others)

    def with_opening(self, entity: str, opening: float) -> Situation:
        """Return the situation with furniture open otherwise; what is in it stays where it is."""
        measured = {other: body for other, body in self.measured.items() if other != entity}
        openings = {**self.openings, entity: opening}
        return Situation(self.scene, self.poses, self.tool, self.width, measured, openings, self.acting, self.others)


def fixed_pose(scene: Scene, entity: str) -> Pose:
    """Return the pose of a body that never moves, as the scene has it."""
    x, y, yaw = scene.fixed[entity]
    return Pose((x, y, scene.shapes[entity].half[2]), yaw_quaternion(yaw))


def _box(pose: Pose, half: Vector) -> Body:
    """Return a pose with a bounding box around it."""
    low, high = corners_of((pose.position, half))
    return Body(pose, half, low, high, pose.position)


def _between(pose: Pose, corners: Corners) -> Body:
    """Return a pose with the bounding box between two corners."""
    (centre, half), (low, high) = box_of(corners), corners
    return Body(pose, half, low, high, centre)
