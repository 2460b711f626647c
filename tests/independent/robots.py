"""The two arms by their makers' own numbers, with the convex hulls of their links.

Panda: Denavit-Hartenberg parameters (Craig) and joint limits by Franka, https://frankaemika.github.io/docs/
control_parameters.html. Iiwa 14: dimensions and limits by KUKA, "LBR iiwa 7 R800, LBR iiwa 14 R820: specification".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from tests.independent.frames import Array, Frame, moved, turned
from tests.independent.hulls import Hull, box_hull, mesh_hull
from tests.independent.tolerances import ROUNDING, SPACING

HALF, QUARTER = np.pi, np.pi / 2

LEFT, RIGHT = -2, -1
"""The links that are fingers; the one before them is the hand."""


@dataclass(frozen=True, eq=False)
class Robot:
    """An arm of seven joints with a gripper.

    `steps` say where each joint stands on the link before it, its axis along z; `hand` and `fingers` where these stand
    on the last link and on the hand, `tool` how far from the hand the point between the finger tips is. `hulls` make
    those of base, links, hand and both fingers; `apart` are those that are no neighbours, and can meet. `reach` is from
    where to where, seen from above, the gripper gets to and above everything from above, up to `highest`.
    """

    steps: tuple[Frame, ...]
    lower: Array
    upper: Array
    hand: Frame
    fingers: float
    tool: float
    hulls: Callable[[], tuple[tuple[Hull, ...], ...]]
    apart: tuple[tuple[int, int], ...]
    reach: tuple[float, float]
    opening: float = 0.08
    highest: float = 0.35

    @cached_property
    def links(self) -> tuple[tuple[Hull, ...], ...]:
        """The hulls of base, links, hand and both fingers; those of meshes take a while."""
        return self.hulls()


def _mesh(path: str, spacing: float = SPACING) -> tuple[Hull, ...]:
    return (mesh_hull(path, spacing),)


def _craig(a: float, d: float, alpha: float) -> Frame:
    """Return where a joint stands by Craig's parameters."""
    tilt = turned(alpha, "x")
    return Frame(tilt, np.array([a, 0.0, 0.0]) + tilt[:, 2] * d)


def _tilted(y: float, z: float, yaw: float) -> Frame:
    """Return where a joint stands whose axis is square to the one before."""
    return Frame(turned(yaw, "z") @ turned(QUARTER, "x"), np.array([0.0, y, z]))


_PANDA = "franka_panda/meshes/collision/"
PANDA = Robot(
    steps=(
        _craig(0.0, 0.333, 0.0),
        _craig(0.0, 0.0, -QUARTER),
        _craig(0.0, 0.316, QUARTER),
        _craig(0.0825, 0.0, QUARTER),
        _craig(-0.0825, 0.384, -QUARTER),
        _craig(0.0, 0.0, QUARTER),
        _craig(0.088, 0.0, QUARTER),
    ),
    lower=np.array([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973]),
    upper=np.array([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]),
    hand=Frame(turned(-np.pi / 4, "z"), np.array([0.0, 0.0, 0.107])),
    fingers=0.0584,
    tool=0.1034,
    hulls=lambda: (
        *(_mesh(f"{_PANDA}link{k}.obj") for k in range(8)),
        _mesh(f"{_PANDA}hand.obj", SPACING / 3),
        *(_mesh(f"{_PANDA}finger.obj", SPACING / 3),) * 2,
    ),
    apart=tuple((low, high) for low in range(5) for high in range(5, 11) if min(high, 7) - low > 2),
    reach=(0.28, 0.76),
)

_PALM = box_hull((0.0, 0.0, 0.03), (0.07, 0.14, 0.06), SPACING / 3)
_FINGER = (
    box_hull((0.0, 0.0071, 0.045), (0.0176, 0.0142, 0.0176), SPACING / 3),
    box_hull((0.0, 0.0172, 0.018), (0.0208, 0.0166, 0.036), SPACING / 3),
)
_DEGREES = np.array([170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0])
KUKA = Robot(
    # Shoulder, elbow and wrist are 0.36, 0.42 and 0.40 m from each other; the meshes stand partly on the way.
    steps=(
        moved(0.0, 0.0, 0.1575),
        _tilted(0.0, 0.36 - 0.1575, HALF),
        _tilted(0.2045, 0.0, HALF),
        _tilted(0.0, 0.42 - 0.2045, 0.0),
        _tilted(0.1845, 0.0, HALF),
        _tilted(0.0, 0.40 - 0.1845, 0.0),
        _tilted(0.081, 0.0, HALF),
    ),
    lower=-np.radians(_DEGREES),
    upper=np.radians(_DEGREES),
    # A palm of 6 cm on the face of the flange, and fingers whose tips reach 4.5 cm beyond it.
    hand=Frame(turned(HALF, "z"), np.array([0.0, 0.0, 0.045])),
    fingers=0.06,
    tool=0.06 + 0.045,
    hulls=lambda: (*(_mesh(f"kuka_iiwa/meshes/link_{k}.stl") for k in range(8)), (_PALM,), _FINGER, _FINGER),
    apart=tuple((low, high) for low in (0, 1) for high in range(5, 11)),
    reach=(0.42, 0.74),
)

ROBOTS = {"panda": PANDA, "kuka": KUKA}
"""By the name that a scene has for them."""


@dataclass(frozen=True, eq=False)
class Mounted:
    """A robot that stands somewhere."""

    robot: Robot
    base: Frame

    @lru_cache(maxsize=1 << 10)  # noqa: B019 - there are two or three of them, for all of a run
    def frames(self, joints: tuple[float, ...], width: float) -> list[Frame]:
        """Return the frames of the `links` of the robot."""
        found = [self.base]
        for step, angle in zip(self.robot.steps, joints, strict=True):
            found.append(found[-1] @ step @ Frame(turned(angle, "z"), np.zeros(3)))
        hand = found[-1] @ self.robot.hand
        left = hand @ moved(0.0, width / 2, self.robot.fingers)
        right = hand @ Frame(turned(HALF, "z"), np.array([0.0, -width / 2, self.robot.fingers]))
        return [*found, hand, left, right]

    def tool(self, joints: tuple[float, ...]) -> Frame:
        """Return the frame between the finger tips: z where they point, y along which they open."""
        return self.frames(joints, 0.0)[LEFT - 1] @ moved(0.0, 0.0, self.robot.tool)

    def fits(self, joints: tuple[float, ...], width: float) -> bool:
        """Tell whether joints and gripper are within their limits; what is not a number is not."""
        angles = np.array(joints, dtype=float)
        if angles.shape != self.robot.lower.shape:
            return False
        within = (angles >= self.robot.lower - ROUNDING) & (angles <= self.robot.upper + ROUNDING)
        return bool(within.all() and -ROUNDING <= width <= self.robot.opening + ROUNDING)
