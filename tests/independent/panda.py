"""The Franka Emika Panda by Franka's own numbers, and balls that lie wholly within its links.

Denavit-Hartenberg parameters (Craig) and joint limits: https://frankaemika.github.io/docs/control_parameters.html.
The capsules lie inside the link meshes of `franka_ros`, which a test checks: what meets one meets the robot.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from tests.independent.world import Array, Frame

LOWER = np.array([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973])
UPPER = np.array([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973])
OPENING = 0.08
QUARTER = np.pi / 2
DENAVIT_HARTENBERG = (
    (0.0, 0.333, 0.0),
    (0.0, 0.0, -QUARTER),
    (0.0, 0.316, QUARTER),
    (0.0825, 0.0, QUARTER),
    (-0.0825, 0.384, -QUARTER),
    (0.0, 0.0, QUARTER),
    (0.088, 0.0, QUARTER),
)
"""The a, d and alpha of each joint, in metres and radians."""

FLANGE, FINGERS, TOOL = 0.107, 0.0584, 0.1034
"""From joint 7 to the flange, from the flange to the fingers, from the flange to the point between their tips."""

Capsule = tuple[tuple[float, float, float], tuple[float, float, float], float]
CAPSULES: dict[str, tuple[Capsule, ...]] = {
    "link0": (((-0.025, 0.0, 0.069), (-0.009, 0.0, 0.069), 0.066),),
    "link1": (((0.0, -0.053, -0.002), (0.0, -0.008, -0.136), 0.053),),
    "link2": (((0.0, -0.139, 0.004), (0.0, -0.002, 0.056), 0.053),),
    "link3": (((0.010, 0.006, -0.067), (0.082, 0.056, -0.001), 0.052),),
    "link4": (((-0.073, 0.070, 0.006), (-0.002, 0.002, 0.053), 0.052),),
    "link5": (((0.0, 0.012, -0.211), (0.0, 0.077, -0.009), 0.048), ((0.0, 0.0, -0.211), (0.0, 0.053, 0.0), 0.047)),
    "link6": (((0.088, 0.035, 0.0), (0.012, -0.006, 0.014), 0.040),),
    "link7": (((-0.016, -0.016, 0.079), (0.031, 0.020, 0.079), 0.025),),
    "hand": (((0.0, -0.076, 0.0455), (0.0, 0.076, 0.0455), 0.020), ((0.0, -0.050, 0.019), (0.0, 0.050, 0.019), 0.024)),
    "finger": (
        ((-0.001, 0.007, 0.0465), (0.001, 0.007, 0.0465), 0.0068),
        ((0.0, 0.009, 0.041), (0.0, 0.013, 0.010), 0.0085),
    ),
}
SPACING = 0.012
"""Metres between the balls of a capsule."""

LINKS = ("link0", "link1", "link2", "link3", "link4", "link5", "link6", "link7", "hand", "left", "right")
HAND = LINKS.index("hand")


def _balls(capsules: Sequence[Capsule]) -> Array:
    rows = []
    for start, end, radius in capsules:
        one, two = np.array(start), np.array(end)
        for share in np.linspace(0, 1, 2 + int(np.linalg.norm(two - one) / SPACING)):
            rows.append([*(one + share * (two - one)), radius])
    return np.array(rows)


_BALLS = [_balls(CAPSULES["finger" if link in ("left", "right") else link]) for link in LINKS]
RADII = np.concatenate([balls[:, 3] for balls in _BALLS])
OWNERS = np.concatenate([np.full(len(balls), k) for k, balls in enumerate(_BALLS)])
"""The radius of each ball, and the number of the link in which it lies, shape (n,)."""

_ARM = np.minimum(OWNERS, 7)
APART = np.nonzero(_ARM[None, :] - _ARM[:, None] >= 3)
"""Pairs of balls of links that are no neighbours, two arrays of shape (m,)."""

TOUCHING = RADII[APART[0]] + RADII[APART[1]]
"""How far apart the centres of the balls of each such pair are where these touch, in metres."""


def _turned(angle: float, axis: str) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    if axis == "x":
        return np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    return np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])


_STEPS = [
    (_turned(alpha, "x"), np.array([a, 0, 0]) + _turned(alpha, "x")[:, 2] * d) for a, d, alpha in DENAVIT_HARTENBERG
]
_HAND = Frame(_turned(-np.pi / 4, "z"), np.array([0, 0, FLANGE]))


@lru_cache(maxsize=1 << 8)
def arm_frames(joints: tuple[float, ...]) -> list[Frame]:
    """Return the frames of the base, the seven links and the hand."""
    frames = [Frame(np.eye(3), np.zeros(3))]
    for (tilt, along), angle in zip(_STEPS, joints, strict=True):
        frames.append(frames[-1] @ Frame(tilt @ _turned(angle, "z"), along))
    return [*frames, frames[-1] @ _HAND]


def link_frames(joints: Sequence[float], width: float) -> list[Frame]:
    """Return the frames of the `LINKS`."""
    frames = arm_frames(tuple(joints))
    left = frames[-1] @ Frame(np.eye(3), np.array([0, width / 2, FINGERS]))
    right = frames[-1] @ Frame(_turned(np.pi, "z"), np.array([0, -width / 2, FINGERS]))
    return [*frames, left, right]


def tool(joints: Sequence[float]) -> Frame:
    """Return the frame between the finger tips: z where they point, y along which they open."""
    return arm_frames(tuple(joints))[HAND] @ Frame(np.eye(3), np.array([0.0, 0.0, TOOL]))


def balls(joints: Sequence[float], width: float) -> Array:
    """Return the centres of all balls, shape (n, 3)."""
    frames = link_frames(joints, width)
    return np.concatenate([local[:, :3] @ f.turn.T + f.at for local, f in zip(_BALLS, frames, strict=True)])
