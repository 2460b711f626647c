"""The KUKA LBR iiwa 14 R820 with a custom gripper: a palm and two fingers of boxes.

The joint limits and speeds are KUKA's ("LBR iiwa 7 R800, LBR iiwa 14 R820: specification", axis data of the R820); the
URDF in the PyBullet wheel has the same limits. The arm consists of a shoulder, an elbow and a wrist: the axes of joints
1 to 3 meet in one point, and the axes of joints 5 to 7 in another. Its inverse kinematics is therefore that of Shimizu,
Kakuya, Yoon, Kitagaki and Kosuge ("Analytical inverse kinematic computation for 7-DOF redundant manipulators with joint
limits", 2008): for any flange pose, the elbow may turn about the line from the shoulder to the wrist. The angle of this
rotation is the arm angle; for a fixed arm angle, each of the three has two configurations.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.footprint import Footprint
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots.robot import FINGER_BOXES, Hand, Joints, Robot
from prag_asp.scene.scene import Shape

Floats = NDArray[np.float64]

SHOULDER, UPPER, FOREARM, WRIST = 0.36, 0.42, 0.40, 0.081
"""The link lengths in metres: base to shoulder, shoulder to elbow, elbow to wrist, wrist to flange link."""

FACE = 0.045
"""The distance from the frame of the flange link to the face of the flange, in metres."""

PALM = (0.07, 0.14, 0.06)
TOOL_OFFSET = FACE + PALM[2] + 0.045
TURN = math.pi
"""The mounting angle of the gripper in radians: if the arm bends in a vertical plane and joint 7 is at 0, the tool's x
axis points away from the base."""

LOW, HIGH = -1.0, 1.0
SIGNS = np.array([(two, four, six) for two in (LOW, HIGH) for four in (LOW, HIGH) for six in (LOW, HIGH)])
AROUND = (0.0, 0.3, -0.3)
COARSE = tuple(np.linspace(-math.pi, math.pi, 13)[:-1].tolist())
FINE = tuple(np.linspace(-math.pi, math.pi, 73)[:-1].tolist())
NARROW = tuple(np.linspace(-0.4, 0.4, 9).tolist())
TINY = 1e-9


class KukaSolver:
    """The kinematics of the iiwa; its redundancy is the arm angle, which is 0 when the elbow points up."""

    last_resort: tuple[float, ...] = FINE
    weights: Joints = (1.0, 1.0, 1.5, 1.0, 1.0, 0.7, 0.3)

    def forward(self, joints: Sequence[float] | Floats) -> Floats:
        """Return the pose of the tool as a homogeneous matrix."""
        one, two, three, four, five, six, seven = np.asarray(joints).tolist()
        upper = _z(one) @ _y(two)
        forearm = upper @ _z(three) @ _y(-four)
        flange = forearm @ _z(five) @ _y(six) @ _z(seven)
        pose = np.eye(4)
        pose[:3, :3] = flange @ _z(TURN)
        pose[:3, 3] = UPPER * upper[:, 2] + FOREARM * forearm[:, 2] + (WRIST + TOOL_OFFSET) * flange[:, 2]
        pose[2, 3] += SHOULDER
        return pose

    def solutions(self, flange: Floats, near: Joints, angles: Sequence[float]) -> Iterator[Sequence[float]]:
        """Yield joint angles for a pose of the flange: eight solutions for each arm angle, or none beyond reach."""
        wrist = flange[:3, 3] - WRIST * flange[:3, 2] - (0.0, 0.0, SHOULDER)
        length = float(np.linalg.norm(wrist))
        if not UPPER - FOREARM + TINY < length < UPPER + FOREARM + TINY:
            return
        along, up, side = _frame(wrist / length)
        cosine = min((UPPER**2 + length**2 - FOREARM**2) / (2 * UPPER * length), 1.0)
        turn = np.repeat(np.asarray(angles), len(SIGNS))
        round_ = np.cos(turn)[:, None] * up + np.sin(turn)[:, None] * side
        elbow = cosine * along + math.sqrt(1.0 - cosine**2) * round_
        forearm = (wrist - UPPER * elbow) / FOREARM
        yield from _joints(elbow, forearm, flange[:3, :3], np.tile(SIGNS, (len(angles), 1)), near).tolist()

    def sweeps(self, tool: Pose, near: Joints | None) -> Iterator[tuple[float, ...]]:
        """Yield the arm angles to try, most promising first."""
        if near is None:
            yield AROUND
            yield COARSE
            return
        upper = _z(near[0]) @ _y(near[1])
        elbow = UPPER * upper[:, 2]
        wrist = elbow + FOREARM * (upper @ _z(near[2]) @ _y(-near[3]))[:, 2]
        _, up, side = _frame(wrist / np.linalg.norm(wrist))
        angle = math.atan2(elbow @ side, elbow @ up)
        yield (angle,)
        yield tuple(angle + turn for turn in NARROW)


def _joints(elbow: Floats, forearm: Floats, flange: Floats, signs: Floats, near: Joints) -> Floats:
    """Return joint angles (n, 7) for unit vectors along upper arm and forearm, a flange rotation, and signs (n, 3)."""
    two = signs[:, 0] * np.arccos(np.clip(elbow[:, 2], -1.0, 1.0))
    one = _direction(signs[:, 0] * elbow[:, 1], signs[:, 0] * elbow[:, 0], near[0])
    upper = _z(one) @ _y(two)
    x, y, z = np.einsum("nji,nj->in", upper, forearm)
    four = signs[:, 1] * np.arccos(np.clip(z, -1.0, 1.0))
    three = _direction(-signs[:, 1] * y, -signs[:, 1] * x, near[2])
    rest = np.einsum("nji,jk->nik", upper @ _z(three) @ _y(-four), flange)
    six = signs[:, 2] * np.arccos(np.clip(rest[:, 2, 2], -1.0, 1.0))
    five = _direction(signs[:, 2] * rest[:, 1, 2], signs[:, 2] * rest[:, 0, 2], near[4])
    last = np.einsum("nji,njk->nik", _z(five) @ _y(six), rest)
    seven = np.arctan2(last[:, 1, 0], last[:, 0, 0])
    return np.column_stack([one, two, three, four, five, six, seven])


def _direction(y: Floats, x: Floats, otherwise: float) -> Floats:
    """Return the angles of directions in a plane, or `otherwise` where undefined, as for a straight joint."""
    return np.where(np.hypot(x, y) > TINY, np.arctan2(y, x), otherwise)


def _frame(along: Floats) -> tuple[Floats, Floats, Floats]:
    """Return a direction, the most upright direction perpendicular to it, and the direction perpendicular to both."""
    reference = np.array((0.0, 0.0, 1.0)) if abs(along[2]) < 1.0 - TINY else np.array((1.0, 0.0, 0.0))
    up = reference - (reference @ along) * along
    up /= np.linalg.norm(up)
    return along, up, np.cross(along, up)


def _z(angle: float | Floats) -> Floats:
    """Return rotations about z, shape (..., 3, 3)."""
    return _rotation(angle, 0, 1, 2)


def _y(angle: float | Floats) -> Floats:
    """Return rotations about y, shape (..., 3, 3)."""
    return _rotation(angle, 2, 0, 1)


def _rotation(angle: float | Floats, from_: int, to: int, axis: int) -> Floats:
    """Return rotations about `axis` that turn the axis `from_` towards the axis `to`, shape (..., 3, 3)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    matrix = np.zeros((*np.shape(angle), 3, 3))
    matrix[..., from_, from_] = matrix[..., to, to] = cosine
    matrix[..., from_, to], matrix[..., to, from_] = -sine, sine
    matrix[..., axis, axis] = 1.0
    return matrix


LIMITS = tuple(math.radians(degrees) for degrees in (170, 120, 170, 120, 170, 120, 175))

KUKA = Robot(
    urdf="kuka_iiwa/model.urdf",
    solver=KukaSolver(),
    # This was measured on the hull of the base's mesh, which is up to 12 mm wider in places.
    footprint=(
        Footprint(Shape("cylinder", (0.24, 0.24, 0.0))),
        Footprint(Shape("box", (0.135, 0.127, 0.0)), (-0.0675, 0.0, 0.0)),
    ),
    lower=tuple(-limit for limit in LIMITS),
    upper=LIMITS,
    torques=(320.0, 320.0, 176.0, 176.0, 110.0, 40.0, 40.0),
    speeds=tuple(math.radians(degrees) for degrees in (85, 85, 100, 75, 130, 135, 135)),
    # KUKA publishes no accelerations. These are the joint limits of the MoveIt configuration of the iiwa 14,
    # joint_limits.yaml of iiwa14_moveit_config in github.com/lbr-stack/lbr_fri_ros2_stack.
    accelerations=(10.0,) * 7,
    home=(0.0, 0.2, 0.0, -1.9, 0.0, math.pi - 2.1, 0.0),
    posture=(0.0, 0.4, 0.0, -1.6, 0.0, math.pi - 2.0, 0.0),
    links=(-1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9),
    arm_links=(0, 1, 2, 3, 4, 5, 6),
    finger_joints=(8, 9),
    finger_links=(8, 9),
    flange_link=6,
    tool_offset=TOOL_OFFSET,
    tool_turn=TURN,
    opening=0.08,
    finger_depth=0.038,
    fingertip=0.009,
    reach=(0.42, 0.74),
    reach_height=0.35,
    payload=14.0,
    grip_force=12.0,
    # Pairs of links that can collide; joint limits keep the other pairs apart, except for the convex hulls of 4 and 6.
    self_pairs=tuple((low, high) for low in (-1, 0) for high in (4, 5, 6, 7, 8, 9)),
    finger_names=(("left_finger", 1.0), ("right_finger", -1.0)),
    finger_boxes=FINGER_BOXES,
    hand=Hand(parent="lbr_iiwa_link_7", at=FACE, turn=TURN, palm=PALM),
)
