"""The Franka Emika Panda with its hand: what the rest of physics needs to know of a robot.

The tool is the point between the finger tips, its z axis the direction in which the fingers point, its y axis
the one along which they open. Joint limits are Franka's own
(https://frankaemika.github.io/docs/control_parameters.html), which are narrower than those of PyBullet's
URDF.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from prag_asp.physics.geometry import Vector

Joints = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Robot:
    """An arm of seven joints with a parallel gripper; metres and radians.

    `torques` are the largest of the joints in newton metres, `home` is where the arm waits, `posture` what the
    inverse kinematics likes best, `tool_offset` how far the tool is in front of the flange, `tool_turn` how far it
    is turned about the flange's axis. `finger_depth`
    is how deep an object reaches between the fingers before it meets the palm, `fingertip` how far the tips
    extend past the tool. `finger_names` are the links of the fingers, each with the side on which it is;
    `finger_boxes` are centre and sizes of the boxes that make up the left one, in its frame.
    """

    urdf: str
    lower: Joints
    upper: Joints
    torques: Joints
    home: Joints
    posture: Joints
    links: tuple[int, ...]
    arm_links: tuple[int, ...]
    finger_joints: tuple[int, int]
    finger_links: tuple[int, ...]
    flange_link: int
    tool_offset: float
    tool_turn: float
    opening: float
    finger_depth: float
    fingertip: float
    reach: tuple[float, float]
    reach_height: float
    self_pairs: tuple[tuple[int, int], ...]
    finger_names: tuple[tuple[str, float], ...]
    finger_boxes: tuple[tuple[Vector, Vector], ...]

    def within_limits(self, joints: Sequence[float], tolerance: float = 0.0) -> bool:
        """Tell whether every joint is within its limits, widened by `tolerance` radians."""
        for low, joint, high in zip(self.lower, joints, self.upper, strict=True):
            if not low - tolerance <= joint <= high + tolerance:
                return False
        return True


PANDA = Robot(
    urdf="franka_panda/panda.urdf",
    lower=(-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973),
    upper=(2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973),
    torques=(87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0),
    home=(0.0, -0.3, 0.0, -2.5, 0.0, 2.2, math.pi / 4),
    posture=(0.0, 0.2, 0.0, -2.2, 0.0, 2.4, math.pi / 4),
    links=(-1, 0, 1, 2, 3, 4, 5, 6, 8, 9, 10),
    arm_links=(0, 1, 2, 3, 4, 5, 6),
    finger_joints=(9, 10),
    finger_links=(9, 10),
    flange_link=7,
    tool_offset=0.1034,
    tool_turn=-math.pi / 4,
    opening=0.08,
    finger_depth=0.033,
    fingertip=0.009,
    reach=(0.28, 0.76),
    reach_height=0.35,
    # Links that can meet; neighbours and pairs that the joint limits keep apart are left out.
    self_pairs=tuple((low, high) for low in range(-1, 4) for high in (4, 5, 6, 8) if high - low > 2),
    finger_names=(("panda_leftfinger", 1.0), ("panda_rightfinger", -1.0)),
    # The pad, then the shank, which stands back.
    finger_boxes=(
        ((0.0, 0.0071, 0.045), (0.0176, 0.0142, 0.0176)),
        ((0.0, 0.0172, 0.018), (0.0208, 0.0166, 0.036)),
    ),
)

ROBOTS = {"panda": PANDA}
