"""The URDF files of the robots: PyBullet's files, with grippers made of exact boxes.

In the URDF of the PyBullet wheel, each finger of the Panda is one convex hull, which fills the recess above the
fingertip and is 1 mm thicker than the finger. The boxes for the pad and the shank have the true dimensions of Franka's
finger, so the opening of the gripper is the distance between its pads. The contact stiffness and damping of the rubber
pads are kept. An arm without a gripper gets one whose fingers have the same stiffness.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import pybullet_data
from prag_asp.scene.boxes import Vector
from prag_asp.scene.robots.robot import Hand, Robot

PALM_MASS, FINGER_MASS, INERTIA = 0.8, 0.1, 0.01
STIFFNESS, DAMPING = 30000.0, 1000.0
"""Contact parameters of the rubber pads, in N/m and N s/m, as in the wheel's URDF for Franka's fingers."""

FORCE, SPEED = 20, 0.2
DARK = "0.25 0.27 0.3 1"


def wheel_file(robot: Robot) -> Path:
    """Return the path of the URDF that comes with PyBullet."""
    return Path(pybullet_data.getDataPath()) / robot.urdf


@lru_cache(maxsize=32)
def robot_file(robot: Robot) -> bytes:
    """Return the URDF of a robot with a gripper whose fingers are made of boxes.

    Raises:
        SceneError: the wheel's URDF cannot be read, or lacks a finger.
    """
    source = wheel_file(robot)
    try:
        root = ElementTree.parse(source).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise SceneError(f"{source}: the robot cannot be read: {error}") from error
    for mesh in root.iter("mesh"):
        mesh.set("filename", str(source.parent / mesh.get("filename", "").removeprefix("package://")))
    if robot.hand is not None:
        _mount(root, robot.hand, robot)
    for name, side in robot.finger_names:
        finger = root.find(f"link[@name='{name}']")
        if finger is None:
            raise SceneError(f"{source}: the robot has no link {name}")
        for collision in finger.findall("collision"):
            finger.remove(collision)
        _add_finger_boxes(finger, "collision", robot, side)
    return ElementTree.tostring(root)


def _mount(root: ElementTree.Element, hand: Hand, robot: Robot) -> None:
    """Add a gripper to an arm: a palm and two fingers that slide along its y axis."""
    middle = (0.0, 0.0, hand.palm[2] / 2)
    palm = _link(root, "hand", PALM_MASS, middle)
    for kind in ("visual", "collision"):
        _add_box(palm, kind, middle, hand.palm)
    _joint(root, "hand_joint", "fixed", (hand.parent, "hand"), hand.at, hand.turn)
    for name, side in robot.finger_names:
        finger = _link(root, name, FINGER_MASS, (0.0, side * 0.01, 0.02))
        contact = ElementTree.SubElement(finger, "contact")
        ElementTree.SubElement(contact, "stiffness", value=str(STIFFNESS))
        ElementTree.SubElement(contact, "damping", value=str(DAMPING))
        _add_finger_boxes(finger, "visual", robot, side)
        joint = _joint(root, f"{name}_joint", "prismatic", ("hand", name), hand.palm[2], 0.0)
        ElementTree.SubElement(joint, "axis", xyz=f"0 {side} 0")
        limits = {"lower": "0", "upper": str(robot.opening / 2), "effort": str(FORCE), "velocity": str(SPEED)}
        ElementTree.SubElement(joint, "limit", limits)


def _link(root: ElementTree.Element, name: str, mass: float, at: Vector) -> ElementTree.Element:
    """Add a link with a centre of mass."""
    link = ElementTree.SubElement(root, "link", name=name)
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "origin", xyz=" ".join(map(str, at)), rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=str(mass))
    axes = {axis: str(INERTIA) for axis in ("ixx", "iyy", "izz")} | dict.fromkeys(("ixy", "ixz", "iyz"), "0")
    ElementTree.SubElement(inertial, "inertia", axes)
    return link


def _joint(
    root: ElementTree.Element, name: str, kind: str, links: tuple[str, str], ahead: float, turn: float
) -> ElementTree.Element:
    """Add a joint from one link to another, offset and rotated along its z axis."""
    joint = ElementTree.SubElement(root, "joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=links[0])
    ElementTree.SubElement(joint, "child", link=links[1])
    ElementTree.SubElement(joint, "origin", xyz=f"0 0 {ahead}", rpy=f"0 0 {turn}")
    return joint


def _add_finger_boxes(finger: ElementTree.Element, kind: str, robot: Robot, side: float) -> None:
    """Add the boxes of a finger to its collision or visual geometry, mirrored if `side` is -1."""
    for solid in robot.finger_boxes:
        x, y, z = solid.at
        _add_box(finger, kind, (x, side * y, z), solid.size)


def _add_box(link: ElementTree.Element, kind: str, at: Vector, size: Vector) -> None:
    """Add a box to the collision or visual geometry of a link."""
    part = ElementTree.SubElement(link, kind)
    ElementTree.SubElement(part, "origin", xyz=" ".join(map(str, at)), rpy="0 0 0")
    geometry = ElementTree.SubElement(part, "geometry")
    ElementTree.SubElement(geometry, "box", size=" ".join(map(str, size)))
    if kind == "visual":
        material = ElementTree.SubElement(part, "material", name="dark")
        ElementTree.SubElement(material, "color", rgba=DARK)
