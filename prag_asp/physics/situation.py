"""What a spatial predicate can see of one moment: where everything is, and what the gripper does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from prag_asp.domain.scene import Scene, Shape
from prag_asp.errors import SceneError
from prag_asp.physics.geometry import Pose, Vector, extents

TABLE_THICKNESS = 0.04


@dataclass(frozen=True)
class Situation:
    """The poses of the objects, the pose of the point between the finger tips, the opening in metres."""

    scene: Scene
    poses: Mapping[str, Pose]
    tool: Pose
    width: float

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

    def pose(self, entity: str) -> Pose:
        """Return the pose of an object; the table's is the centre of its top.

        Raises:
            SceneError: the entity has no shape, or does not take part in this situation.
        """
        pose = self.poses.get(entity)
        if pose is not None:
            return pose
        if self.is_table(entity):
            x, y = self.scene.table.centre
            return Pose((x, y, 0.0))
        raise SceneError(
            f"{entity} is not in this situation; its objects are {', '.join(self.poses) or 'none'}"
        )

    def half(self, entity: str) -> Vector:
        """Return half the sides of the bounding box of an entity as it is turned, in metres."""
        pose = self.poses.get(entity)
        if pose is not None:
            return extents(self.scene.shapes[entity], pose.quaternion)
        if self.is_table(entity):
            x, y = self.scene.table.size
            return (x / 2, y / 2, 0.0)
        raise SceneError(
            f"{entity} is not in this situation; its objects are {', '.join(self.poses) or 'none'}"
        )

    def top(self, entity: str) -> float:
        """Return the height of the highest point of an entity in metres."""
        return self.pose(entity).position[2] + self.half(entity)[2]

    def bottom(self, entity: str) -> float:
        """Return the height of the lowest point of an entity in metres."""
        return self.pose(entity).position[2] - self.half(entity)[2]

    def with_pose(self, entity: str, pose: Pose) -> Situation:
        """Return the situation with one object moved."""
        return replace(self, poses={**self.poses, entity: pose})
