"""One arm in a simulator without forces: put it anywhere, and ask what its links touch."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.robot.robot_files import robot_file, wheel_file
from prag_asp.physics.temporary_files import lent
from prag_asp.scene.boxes import Corners, around, touch
from prag_asp.scene.geometry import Pose, rotate
from prag_asp.scene.robots import Joints, Robot

REMEMBERED = 256


@dataclass
class _Posture:
    """What is known of an arm at joint angles: its links' bounding boxes at an opening, and how links overlap."""

    width: float
    boxes: list[Corners]
    overlap: float | None = None


class SimulatedArm:
    """The body of an arm, and what is known of it where it is."""

    def __init__(self, client: int, robot: Robot, visual: bool):
        self.client = client
        self.robot = robot
        self.body = _load_with_hand(client, robot, visual)
        self._trunk, self._wrist = (sorted(set(links)) for links in zip(*robot.self_pairs, strict=True))
        self._at: tuple[Joints, float] | None = None
        self._known: dict[Joints, _Posture] = {}
        self._joints = [*robot.arm_links, *robot.finger_joints]
        sides = zip(robot.finger_links, robot.finger_names, strict=True)
        self._fingers = [(robot.links.index(link), side) for link, (_, side) in sides]

    def pose(self, joints: Joints, width: float) -> None:
        """Put the arm at seven joint angles in radians, the gripper at an opening in metres.

        Raises:
            SceneError: a number is not finite, or there are not seven joints.
        """
        if self._at == (joints, width):
            return
        if len(joints) != len(self.robot.lower) or not all(map(math.isfinite, (*joints, width))):
            raise SceneError(f"the arm cannot take the joint angles {joints} with the opening {width}")
        values = [[angle] for angle in (*joints, width / 2, width / 2)]
        pybullet.resetJointStatesMultiDof(self.body, self._joints, values, physicsClientId=self.client)
        self._at = joints, width

    def contacts(self, body: int, links: Iterable[int], within: float = 0.0) -> list[tuple[int, float]]:
        """Return which of some links of the arm touch a body, where both are now, with the distance in metres.

        So do those that are `within` a distance of it, in metres.
        """
        found = []
        for link in links:
            points = pybullet.getClosestPoints(self.body, body, within, linkIndexA=link, physicsClientId=self.client)
            found += [(link, point[8]) for point in points]
        return found

    def link_boxes(self, joints: Joints, width: float) -> list[Corners]:
        """Return the bounding box of each of the robot's links at joint angles in radians and an opening in metres.

        The arm itself is moved only where they are not known.

        Raises:
            SceneError: a number is not finite, or there are not seven joints.
        """
        known = self._known.get(joints)
        if known is None:
            self.pose(joints, width)
            read, body, client = pybullet.getAABB, self.body, self.client
            known = _Posture(width, [read(body, link, client) for link in self.robot.links])
            if len(self._known) >= REMEMBERED:
                self._known.clear()
            self._known[joints] = known
        return known.boxes if known.width == width else self._opened(joints, known, width)

    def _opened(self, joints: Joints, known: _Posture, width: float) -> list[Corners]:
        """Return bounding boxes with the gripper open otherwise: the fingers slide along the y axis of the tool."""
        axis = rotate(tool_pose(self.robot, joints).quaternion, (0.0, 1.0, 0.0))
        boxes = list(known.boxes)
        for i, side in self._fingers:
            shift = side * (width - known.width) / 2
            dx, dy, dz = axis[0] * shift, axis[1] * shift, axis[2] * shift
            (ax, ay, az), (bx, by, bz) = boxes[i]
            boxes[i] = (ax + dx, ay + dy, az + dz), (bx + dx, by + dy, bz + dz)
        return boxes

    def self_overlap(self, joints: Joints, width: float) -> float:
        """Return the smallest distance of two links of the arm that touch in metres, 0 where none do."""
        boxes = self.link_boxes(joints, width)
        known = self._known[joints]
        if known.overlap is None:
            known.overlap = min([0.0, *self._overlaps(joints, width, dict(zip(self.robot.links, boxes, strict=True)))])
        return known.overlap

    def _overlaps(self, joints: Joints, width: float, boxes: Mapping[int, Corners]) -> Iterator[float]:
        """Yield the distances of the links that touch in metres, of those whose bounding boxes do."""
        trunk = around([boxes[link] for link in self._trunk])
        near = {link for link in self._wrist if touch(boxes[link], trunk)}
        for low, high in self.robot.self_pairs:
            if high in near and touch(boxes[low], boxes[high]):
                self.pose(joints, width)
                points = pybullet.getClosestPoints(
                    self.body, self.body, 0.0, linkIndexA=low, linkIndexB=high, physicsClientId=self.client
                )
                yield from (point[8] for point in points)

    def flange(self) -> Pose:
        """Return the pose of the flange as the simulator's own kinematics has it."""
        return read_flange(self.client, self.body, self.robot)


def load_robot(client: int, path: Path, base: Pose, *, visual: bool = False, solid: bool = False) -> int:
    """Load an arm from a file, its base at a pose; one that is `solid` is pushed by its own links as by other bodies.

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


def load_written(
    client: int, files: Mapping[str, bytes], base: Pose, *, visual: bool = False, solid: bool = False
) -> int:
    """Load an arm as `load_robot` does, from a URDF that is the first of some files.

    Raises:
        SceneError: PyBullet cannot load it.
    """
    with lent(files) as folder:
        return load_robot(client, folder / next(iter(files)), base, visual=visual, solid=solid)


def _load_with_hand(client: int, robot: Robot, visual: bool) -> int:
    """Load an arm with its gripper where it stands.

    Raises:
        SceneError: PyBullet cannot load it.
    """
    if robot.hand is None:
        return load_robot(client, wheel_file(robot), robot.base, visual=visual)
    return load_written(client, {"robot.urdf": robot_file(robot)}, robot.base, visual=visual)


def read_flange(client: int, arm: int, robot: Robot) -> Pose:
    """Return the pose of an arm's flange as the simulator's own kinematics has it.

    Its quaternion is off unit length by up to 1e-7, for the URDF's angles are rounded; it is made one.
    """
    state = pybullet.getLinkState(arm, robot.flange_link, computeForwardKinematics=True, physicsClientId=client)
    length = math.hypot(*state[5])
    x, y, z, w = (part / length for part in state[5])
    return Pose(tuple(state[4]), (x, y, z, w))
