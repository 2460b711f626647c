"""The description of a robot for the rest of physics: an arm with seven joints and a parallel gripper.

The tool is the point between the fingertips; the fingers point along its z axis and open along its y axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import le
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.boxes import Vector
from prag_asp.scene.footprint import Footprint
from prag_asp.scene.geometry import Pose
from prag_asp.scene.scene import Solid

Joints = tuple[float, ...]

ORIGIN = Pose((0.0, 0.0, 0.0))
FINGER_BOXES = (
    Solid("box", (0.0176, 0.0142, 0.0176), (0.0, 0.0071, 0.045)),
    Solid("box", (0.0208, 0.0166, 0.036), (0.0, 0.0172, 0.018)),
)
"""The left finger of the Panda's hand, in metres: the pad, then the shank, which is set back. The KUKA has the same
finger."""


class KinematicsSolver(Protocol):
    """The closed-form kinematics of an arm with seven degrees of freedom, one of which is a free angle.

    `last_resort` holds free angles to try if no others give a solution; `weights` holds the cost, in the inverse
    kinematics, of each joint's distance from the robot's posture.
    """

    last_resort: tuple[float, ...]
    weights: Joints

    def forward(self, joints: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the pose of the tool as a homogeneous matrix."""

    def solutions(
        self, flange: NDArray[np.float64], near: Joints, angles: Sequence[float]
    ) -> Iterator[Sequence[float]]:
        """Yield joint angles for a pose of the flange, a homogeneous matrix; some may be NaN.

        Joint limits are not checked. `angles` holds the free angles; joints that the pose leaves undetermined keep
        their angles in `near`.
        """

    def sweeps(self, tool: Pose, near: Joints | None) -> Iterator[tuple[float, ...]]:
        """Yield free angles to try for a tool pose, most promising first: around the joints `near`, if given."""


class Hand(NamedTuple):
    """A custom gripper for arms without one: a box as the palm, and sliding fingers.

    `parent` is the link of the arm that carries the hand, `at` is the distance in metres from that link's frame to the
    hand, `turn` is the rotation about that link's axis in radians, and `palm` holds the dimensions of the palm in
    metres.
    """

    parent: str
    at: float
    turn: float
    palm: Vector


@dataclass(frozen=True, eq=False)
class Robot:
    """An arm with seven joints and a parallel gripper; units are metres and radians.

    `footprint` is the area of the table under the base, as pieces that lie wholly within it, in the robot's frame.
    `torques`, `speeds` and `accelerations` are the limits of the joints, in N m, rad/s and rad/s². `home` is the joint
    configuration of an idle arm; the inverse kinematics prefers configurations near `posture`. `tool_offset` is the
    distance from the flange to the tool, and `tool_turn` is the rotation of the tool about the flange's axis.
    `finger_depth` is the distance from the palm to the tool, and `fingertip` is the distance from the tool to the
    fingertips. `reach` holds the inner and outer radii of a ring around the base, seen from above: in this ring, up to
    `reach_height`, the gripper can point straight down at an object, and above it, with any yaw. `payload` is the
    maximum mass that the arm may carry, in kilograms, and `grip_force` is the force of each finger, in newtons.
    `finger_names` are the links of the fingers, each with its side; `finger_boxes` make up the left finger, in its
    frame. `hand` is set if the gripper is custom-made. `base` is the pose of the robot.
    """

    urdf: str
    solver: KinematicsSolver
    footprint: tuple[Footprint, ...]
    lower: Joints
    upper: Joints
    torques: Joints
    speeds: Joints
    accelerations: Joints
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
    payload: float
    grip_force: float
    self_pairs: tuple[tuple[int, int], ...]
    finger_names: tuple[tuple[str, float], ...]
    finger_boxes: tuple[Solid, ...]
    hand: Hand | None = None
    base: Pose = ORIGIN

    @property
    def driven(self) -> list[int]:
        """The driven joints: seven in the arm, and two in the fingers."""
        return [*self.arm_links, *self.finger_joints]

    def within_limits(self, joints: Sequence[float], tolerance: float = 0.0) -> bool:
        """Return whether every joint is within its limits, widened by `tolerance` radians."""
        lower, upper = self.lower, self.upper
        if tolerance:
            lower, upper = tuple(low - tolerance for low in lower), tuple(high + tolerance for high in upper)
        return all(map(le, lower, joints)) and all(map(le, joints, upper))
