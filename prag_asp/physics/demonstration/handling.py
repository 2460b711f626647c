"""Check how an episode handles objects: held objects must not slip, and joints must stay within their limits.

An object is in the hand while both fingers press on it. Its pose in the hand should not change after the arm begins to
move; a turn or a slip shows that friction does not bear the load.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND, Demonstration, pose_of
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.search.attempt import HASTY, SLIPPED
from prag_asp.physics.witness import ROBOT_PARTS
from prag_asp.scene.geometry import Pose, compose, invert
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene

MOST_SLIP, MOST_TURN = 0.005, math.radians(5.0)
"""The maximum slip and rotation of an object in the hand, in metres and radians.

The slip is the distance that the point of the object between the fingertips moves, so a rotation about this point alone
is not a slip.
"""

STANDSTILL = 1e-6
"""The largest difference between two commands that counts as zero: in radians for a joint, in metres for the fingers.
"""


class HandlingFault(NamedTuple):
    """A fault in the handling of objects in an episode: the cause, one of `CAUSES`, and a sentence."""

    cause: str
    text: str


def handling_faults(episode: Demonstration, scene: Scene) -> Iterator[HandlingFault]:
    """Yield objects that slip or turn in a hand, and joints that accelerate beyond their limits."""
    for i, robot in enumerate(episode.robots):
        for first, last, entity in _in_hand(episode, robot):
            fault = _slip(episode, scene, i, (first, last), entity)
            if fault is not None:
                yield fault
        limits = np.array(robot_of(scene, robot).accelerations)
        shares = np.abs(np.diff(episode.joints[:, i].astype(float), 2, axis=0)) * FRAMES_A_SECOND**2 / limits
        if shares.size and shares.max() > 1.0:
            frame, joint = np.unravel_index(shares.argmax(), shares.shape)
            which = f"joint {joint + 1} of {robot} accelerates with {shares.max():.2f} of its limit"
            yield HandlingFault(HASTY, f"{which} at {episode.times[frame + 1]:.2f} s")


def _in_hand(episode: Demonstration, robot: str) -> Iterator[tuple[int, int, str]]:
    """Yield the periods in which both fingers of a robot press on an object: the first frame, last frame and object."""
    left, right = (episode.bodies.index(f"{part} of {robot}") for part in ROBOT_PARTS[1:])
    first_object = len(episode.bodies) - len(episode.objects)
    fingers: dict[tuple[int, int], set[int]] = {}
    for frame, one, two in episode.contacts.tolist():
        for part, body in ((one, two), (two, one)):
            if part in (left, right) and body >= first_object:
                fingers.setdefault((body, frame), set()).add(part)
    frames: dict[int, list[int]] = {}
    for (body, frame), parts in sorted(fingers.items()):
        if len(parts) == 2 and episode.bodies[body] not in episode.furniture:
            frames.setdefault(body, []).append(frame)
    for body, held in frames.items():
        breaks = [0, *(i for i in range(1, len(held)) if held[i] != held[i - 1] + 1), len(held)]
        for begin, end in pairwise(breaks):
            yield held[begin], held[end - 1], episode.bodies[body]


def _slip(episode: Demonstration, scene: Scene, arm: int, frames: tuple[int, int], entity: str) -> HandlingFault | None:
    """Return a fault if an object moves in the hand between the arm's first motion and the release, or else None."""
    first, last = frames
    commands: NDArray[np.float64] = np.abs(np.diff(episode.commands[first : last + 1, arm].astype(float), axis=0))
    moving = np.flatnonzero(commands[:, :7].max(axis=1, initial=0.0) > STANDSTILL)
    if not moving.size:
        return None
    start = int(moving[0])
    opening = np.flatnonzero(commands[start:, 7] > STANDSTILL)
    end = start + int(opening[0]) if opening.size else last - first
    grasped = _grasp(episode, scene, arm, first + start, entity)
    between_pads = Pose(invert(grasped).position)
    for frame in range(first + start + 1, first + end + 1):
        now = _grasp(episode, scene, arm, frame, entity)
        # The body's own origin may be far from the fingers, where a small turn moves it a lot.
        slip = math.hypot(*compose(now, between_pads).position)
        cosine = abs(sum(a * b for a, b in zip(grasped.quaternion, now.quaternion, strict=True)))
        turn = 2.0 * math.acos(min(1.0, cosine))
        if slip > MOST_SLIP or turn > MOST_TURN:
            moved = (
                f"slips by {1000 * slip:.1f} mm" if slip > MOST_SLIP else f"turns by {math.degrees(turn):.1f} degrees"
            )
            text = f"{words(entity)} {moved} in the hand of {episode.robots[arm]} at {episode.times[frame]:.2f} s"
            return HandlingFault(SLIPPED, text)
    return None


def _grasp(episode: Demonstration, scene: Scene, arm: int, frame: int, entity: str) -> Pose:
    """Return the pose of an object in the frame of a tool."""
    robot = robot_of(scene, episode.robots[arm])
    tool = tool_pose(robot, tuple(episode.joints[frame, arm].tolist()))
    return compose(invert(tool), pose_of(episode.poses[frame, episode.objects.index(entity)].tolist()))
