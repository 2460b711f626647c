"""The Franka Emika Panda with its hand.

The limits of joint angles, speeds and accelerations are Franka's
(https://frankaemika.github.io/docs/control_parameters.html); they are narrower than those of PyBullet's URDF. The
inverse kinematics is the analytic solution of He and Liu ("Analytical inverse kinematics for Franka Emika Panda",
2021), which fixes joint 7 and finds up to four configurations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from prag_asp.missing import needed
from prag_asp.scene.footprint import Footprint
from prag_asp.scene.geometry import Pose, wrap, yaw_of
from prag_asp.scene.robots.robot import FINGER_BOXES, Joints, Robot
from prag_asp.scene.scene import Shape

POSTURE = (0.0, 0.2, 0.0, -2.2, 0.0, 2.4, math.pi / 4)
WRIST_LIMIT = 2.8973
AROUND = (0.0, 0.25, -0.25)
COARSE = tuple(np.linspace(-2.8, 2.8, 13).tolist())
FINE = tuple(np.linspace(-2.8, 2.8, 49).tolist())
NARROW = tuple(np.linspace(-0.4, 0.4, 9).tolist())


@cache
def _frankik() -> ModuleType:
    """Return the kinematics package, imported lazily because the robot's dimensions do not need it."""
    return needed("frankik")


@cache
def _forward_kinematics() -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Return the function that computes the pose of the tool."""
    fk: Callable[[NDArray[np.float64]], NDArray[np.float64]] = _frankik().fk
    return fk


class PandaSolver:
    """The kinematics of the Panda; the free parameter is the angle of joint 7."""

    last_resort: tuple[float, ...] = FINE
    weights: Joints = (1.0, 1.0, 1.5, 1.0, 1.0, 0.7, 0.3)

    def forward(self, joints: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the pose of the tool as a homogeneous matrix."""
        pose: NDArray[np.float64] = _forward_kinematics()(np.asarray(joints))
        return pose

    def solutions(
        self, flange: NDArray[np.float64], near: Joints, angles: Sequence[float]
    ) -> Iterator[Sequence[float]]:
        """Yield joint angles for a pose of the flange, or NaN for a branch without a solution."""
        actual, ik_full = np.array(near), _frankik().ik_full
        for angle in angles:
            yield from ik_full(flange, actual, angle).tolist()

    def sweeps(self, tool: Pose, near: Joints | None) -> Iterator[tuple[float, ...]]:
        """Yield the angles of joint 7 to try, most promising first."""
        if near is not None:
            yield (near[6],)
            yield tuple(near[6] + angle for angle in NARROW)
            return
        # With joints 3 and 5 at 0, the arm bends in a plane, and only joint 7 turns the tool out of it.
        heading = math.atan2(tool.position[1], tool.position[0])
        planar = wrap(POSTURE[6] + heading - yaw_of(tool.quaternion))
        yield tuple(min(max(planar + angle, -WRIST_LIMIT), WRIST_LIMIT) for angle in AROUND)
        yield COARSE


PANDA = Robot(
    urdf="franka_panda/panda.urdf",
    solver=PandaSolver(),
    # Measured on the hull of the base's mesh, which is up to 12 mm wider in places.
    footprint=(
        Footprint(Shape("cylinder", (0.142, 0.142, 0.0))),
        Footprint(Shape("box", (0.198, 0.084, 0.0)), (-0.049, 0.0, 0.0)),
        Footprint(Shape("box", (0.161, 0.137, 0.0)), (-0.0505, 0.0, 0.0)),
        Footprint(Shape("box", (0.038, 0.177, 0.0)), (-0.011, 0.0, 0.0)),
    ),
    lower=(-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -WRIST_LIMIT),
    upper=(2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, WRIST_LIMIT),
    torques=(87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0),
    speeds=(2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61),
    accelerations=(15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0),
    home=(0.0, -0.3, 0.0, -2.5, 0.0, 2.2, math.pi / 4),
    posture=POSTURE,
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
    payload=3.0,
    grip_force=12.0,
    # Pairs of links that can collide, except neighbours and pairs that the joint limits keep apart.
    self_pairs=tuple((low, high) for low in range(-1, 4) for high in (4, 5, 6, 8) if high - low > 2),
    finger_names=(("panda_leftfinger", 1.0), ("panda_rightfinger", -1.0)),
    finger_boxes=FINGER_BOXES,
)
