"""One arm in a kinematic simulator: set its configuration, and query the contacts of its links."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.robot.robot_files import robot_file, wheel_file
from prag_asp.physics.temporary_files import temporary_folder
from prag_asp.scene.boxes import Corners, around, touch
from prag_asp.scene.geometry import Pose, rotate
from prag_asp.scene.robots import Joints, Robot

REMEMBERED = 256


@dataclass
class _Posture:
    """Cached properties of an arm configuration: the bounding boxes of the links at an opening, and self-overlap."""

    width: float
    boxes: list[Corners]
    overlap: float | None = None


class SimulatedArm:
    """The PyBullet body of an arm, with cached properties of its configurations."""

    def __init__(self, client: int, robot: Robot, visual: bool):
        self.client = client
        self.robot = robot
        if robot.hand is None:
            self.body = load_robot(client, wheel_file(robot), robot.base, visual=visual)
        else:
            self.body = load_robot_files(client, {"robot.urdf": robot_file(robot)}, robot.base, visual=visual)
        self._trunk, self._wrist = (sorted(set(links)) for links in zip(*robot.self_pairs, strict=True))
        self._at: tuple[Joints, float] | None = None
        self._known: dict[Joints, _Posture] = {}
        sides = zip(robot.finger_links, robot.finger_names, strict=True)
        self._fingers = [(robot.links.index(link), side) for link, (_, side) in sides]

    def pose(self, joints: Joints, width: float) -> None:
        """Set the seven joint angles in radians, and the opening of the gripper in metres.

        Raises:
            SceneError: a number is not finite, or there are not seven joints.
        """
        if self._at == (joints, width):
            return
        if len(joints) != len(self.robot.lower) or not all(map(math.isfinite, (*joints, width))):
            raise SceneError(f"the arm cannot take the joint angles {joints} with the opening {width}")
        set_joints(self.client, self.body, self.robot, joints, width)
        self._at = joints, width

    def contacts(self, body: int, links: Iterable[int], within: float = 0.0) -> list[tuple[int, float]]:
        """Return the links of the arm that are at most `within` metres from a body, with their distances in metres."""
        contacts = []
        for link in links:
            points = pybullet.getClosestPoints(self.body, body, within, linkIndexA=link, physicsClientId=self.client)
            contacts += [(link, point[8]) for point in points]
        return contacts

    def link_boxes(self, joints: Joints, width: float) -> list[Corners]:
        """Return the bounding box of each link of the robot, given joint angles in radians and an opening in metres.

        The arm is moved only if the boxes are not cached.

        Raises:
            SceneError: a number is not finite, or there are not seven joints.
        """
        posture = self._known.get(joints)
        if posture is None:
            self.pose(joints, width)
            read, body, client = pybullet.getAABB, self.body, self.client
            posture = _Posture(width, [read(body, link, client) for link in self.robot.links])
            if len(self._known) >= REMEMBERED:
                self._known.clear()
            self._known[joints] = posture
        if posture.width == width:
            return posture.boxes
        # The fingers slide along the y axis of the tool.
        axis = rotate(tool_pose(self.robot, joints).quaternion, (0.0, 1.0, 0.0))
        boxes = list(posture.boxes)
        for i, side in self._fingers:
            shift = side * (width - posture.width) / 2
            dx, dy, dz = axis[0] * shift, axis[1] * shift, axis[2] * shift
            (ax, ay, az), (bx, by, bz) = boxes[i]
            boxes[i] = (ax + dx, ay + dy, az + dz), (bx + dx, by + dy, bz + dz)
        return boxes

    def self_overlap(self, joints: Joints, width: float) -> float:
        """Return the negated maximum penetration depth between links of the arm in metres, or 0 if no two touch."""
        boxes = dict(zip(self.robot.links, self.link_boxes(joints, width), strict=True))
        posture = self._known[joints]
        if posture.overlap is None:
            posture.overlap = 0.0
            trunk = around([boxes[link] for link in self._trunk])
            near = {link for link in self._wrist if touch(boxes[link], trunk)}
            for low, high in self.robot.self_pairs:
                if high in near and touch(boxes[low], boxes[high]):
                    self.pose(joints, width)
                    points = pybullet.getClosestPoints(
                        self.body, self.body, 0.0, linkIndexA=low, linkIndexB=high, physicsClientId=self.client
                    )
                    posture.overlap = min([posture.overlap, *(point[8] for point in points)])
        return posture.overlap

    def flange(self) -> Pose:
        """Return the pose of the flange, which the simulator computes by forward kinematics."""
        return read_flange(self.client, self.body, self.robot)


def load_robot(client: int, path: Path, base: Pose, *, visual: bool = False, solid: bool = False) -> int:
    """Load an arm from a file, with its base at a pose; `solid` enables self-collisions.

    Raises:
        SceneError: PyBullet cannot load it.
    """
    flags = 0 if visual else pybullet.URDF_IGNORE_VISUAL_SHAPES
    if solid:
        flags |= pybullet.URDF_USE_SELF_COLLISION
    try:
        return int(pybullet.loadURDF(str(path), *base, useFixedBase=True, flags=flags, physicsClientId=client))
    except pybullet.error as error:
        raise SceneError(f"{path}: the robot cannot be loaded: {error}") from error


def load_robot_files(
    client: int, files: Mapping[str, bytes], base: Pose, *, visual: bool = False, solid: bool = False
) -> int:
    """Load an arm like `load_robot`, from the contents of files, the first of which is the URDF.

    Raises:
        SceneError: PyBullet cannot load it.
    """
    with temporary_folder(files) as folder:
        return load_robot(client, folder / next(iter(files)), base, visual=visual, solid=solid)


def set_joints(client: int, body: int, robot: Robot, joints: Joints, width: float) -> None:
    """Set the seven joint angles of an arm in radians, and the opening of its gripper in metres."""
    values = [[angle] for angle in (*joints, width / 2, width / 2)]
    pybullet.resetJointStatesMultiDof(body, robot.driven, values, physicsClientId=client)


def read_flange(client: int, arm: int, robot: Robot) -> Pose:
    """Return the pose of an arm's flange, which the simulator computes by forward kinematics.

    The quaternion is normalized, because the rounded angles of the URDF make it deviate by up to 1e-7.
    """
    state = pybullet.getLinkState(arm, robot.flange_link, computeForwardKinematics=True, physicsClientId=client)
    length = math.hypot(*state[5])
    x, y, z, w = (part / length for part in state[5])
    return Pose(tuple(state[4]), (x, y, z, w))
