"""The robot for worlds with forces: the wheel's URDF with fingers of exact boxes.

The wheel's fingers are one convex hull each, which fills the recess above the finger tips and is 1 mm thicker than
the finger. A pad and a shank of boxes have the true sizes of Franka's finger, so that the opening of the gripper
is the distance of its pads. The rubber of the pads is the wheel's: its contact stiffness and damping stay.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import pybullet_data
from prag_asp.physics.geometry import Vector
from prag_asp.physics.robot import Robot

Box = tuple[Vector, Vector]


def write_robot(robot: Robot, folder: Path) -> Path:
    """Write the URDF of a robot with fingers of boxes into a folder, and return its path.

    Raises:
        SceneError: the wheel's URDF cannot be read, or lacks a finger.
    """
    source = Path(pybullet_data.getDataPath()) / robot.urdf
    try:
        root = ElementTree.parse(source).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise SceneError(f"{source}: the robot cannot be read: {error}") from error
    for mesh in root.iter("mesh"):
        mesh.set("filename", str(source.parent / mesh.get("filename", "").removeprefix("package://")))
    for name, side in robot.finger_names:
        finger = root.find(f"link[@name='{name}']")
        if finger is None:
            raise SceneError(f"{source}: the robot has no link {name}")
        _give_boxes(finger, robot.finger_boxes, side)
    target = folder / source.name
    ElementTree.ElementTree(root).write(target)
    return target


def _give_boxes(finger: ElementTree.Element, boxes: tuple[Box, ...], side: float) -> None:
    """Replace what a finger collides with by boxes, mirrored where `side` is -1."""
    for collision in finger.findall("collision"):
        finger.remove(collision)
    for (x, y, z), size in boxes:
        collision = ElementTree.SubElement(finger, "collision")
        ElementTree.SubElement(collision, "origin", xyz=f"{x} {side * y} {z}", rpy="0 0 0")
        geometry = ElementTree.SubElement(collision, "geometry")
        ElementTree.SubElement(geometry, "box", size=" ".join(map(str, size)))
