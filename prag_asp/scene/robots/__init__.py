"""The robots, one per file; they all have the same kind of description, which the rest of physics uses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

from prag_asp.errors import SceneError
from prag_asp.scene.geometry import Pose, yaw_quaternion
from prag_asp.scene.robots.kuka import KUKA
from prag_asp.scene.robots.panda import PANDA
from prag_asp.scene.robots.robot import Hand, Joints, KinematicsSolver, Robot
from prag_asp.scene.scene import Mount, Scene

ROBOTS: Mapping[str, Robot] = {"panda": PANDA, "kuka": KUKA}
"""The robots by the names that they have in scenes. A new robot needs a row here, and its own file."""


def robot_of(scene: Scene, name: str) -> Robot:
    """Return the robot in a scene whose entity has a given name.

    Raises:
        SceneError: the scene has no robot with that name.
    """
    mount = scene.robots.get(name)
    if mount is None:
        raise SceneError(f"there is no robot {name}; the scene has {', '.join(scene.robots)}")
    return _mounted(mount)


@cache
def _mounted(mount: Mount) -> Robot:
    """Return a robot with its base at a mount."""
    base = Pose((mount.x, mount.y, 0.0), yaw_quaternion(mount.yaw))
    return ROBOTS[mount.kind] if base == Pose((0.0, 0.0, 0.0)) else replace(ROBOTS[mount.kind], base=base)


__all__ = ["KUKA", "PANDA", "ROBOTS", "Hand", "Joints", "KinematicsSolver", "Robot", "robot_of"]
