"""Judge a recording by its numbers alone: how fast joints turn, and what presses on what. NumPy, and no limit read.

The rule for contacts is cruder than that of the package, so that it is another one: an arm touches nothing at all, a
finger only what is named in an action up to then or held at the beginning, and what a finger touches presses only on
what is named in the task or said to be somewhere in its first state.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from tests.independent.frames import Frame
from tests.independent.frames import frame as frame_of
from tests.independent.robots import Mounted

LIMITS: Mapping[str, tuple[Sequence[float], Sequence[float]]] = {
    "panda": ((2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61), (15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0)),
    "kuka": ((1.4835, 1.4835, 1.7453, 1.3089, 2.2689, 2.3561, 2.3561), (10.0,) * 7),
}
"""Of each joint, the speed and acceleration that its maker allows: radians a second and a second squared."""

SECONDS = 0.05
AT_HAND = ("holding(", "at(")
"""How fluents begin that say what a gripper is at."""

LOOSE, LOOSE_DEGREES = 0.005, 5.0
"""Metres and degrees by which a held body may be elsewhere in the hand."""

HARD, TIMES = 20.0, 10.0
"""Newtons of a contact of what is moved, and how many times its weight come on top."""

MOST = 1.0
"""Newtons of a contact that nobody asked for."""


def above_limits(joints: np.ndarray, kinds: Sequence[str]) -> Iterator[str]:
    """Yield which joints of a recording, shape (frames, robots, 7), are faster than their maker allows, and when."""
    speeds = np.diff(joints.astype(float), axis=0) / SECONDS
    accelerations = np.diff(speeds, axis=0) / SECONDS
    for i, kind in enumerate(kinds):
        for what, values, most in zip(("speed", "acceleration"), (speeds, accelerations), LIMITS[kind], strict=True):
            for frame, joint in np.argwhere(np.abs(values[:, i]) > most).tolist():
                yield f"frame {frame}: {what} {values[frame, i, joint]:.2f} of joint {joint + 1} of robot {i + 1}"


def unwanted(shown: Any, actions: Sequence[str], known: Sequence[str], kilograms: Mapping[str, float]) -> Iterator[str]:
    """Yield contacts of a recording for which the actions of a task do not ask; `known` holds in its first state.

    Where no finger is part of a contact, the weight of what a finger touches is allowed: what it rests on bears it.
    """
    named = [set(_words(text)) for text in actions]
    begun = {word for fluent in known if fluent.startswith(AT_HAND) for word in _words(fluent)}
    every = {word for fluent in known for word in _words(fluent)}.union(*named)
    ends = shown.ends.tolist()
    frames: dict[int, list[tuple[str, str, float]]] = {}
    for (frame, one, two), force in zip(shown.contacts.tolist(), shown.forces.tolist(), strict=True):
        frames.setdefault(frame, []).append((shown.bodies[one], shown.bodies[two], force))
    for frame, touches in frames.items():
        done = sum(frame > end for end in ends)
        usual = begun.union(*named[:done])
        fingered = {two for pair in touches for one, two in (pair[:2], pair[1::-1]) if " finger of " in one}
        for one, two, force in touches:
            touched = set() if " finger of " in one + two else fingered.intersection((one, two))
            borne = 9.81 * max((kilograms.get(body, 0.0) for body in touched), default=0.0)
            if force > MOST + borne and not _may_touch(one, two, usual, every, fingered):
                yield f"frame {frame}: {one} and {two}, {force:.1f} N"


def loosened(shown: Any, arms: Mapping[str, Mounted]) -> Iterator[str]:
    """Yield what is elsewhere in a hand after a time in the air, where nothing else touches it, than before.

    How far it is off is that of its point which was between the finger tips; how it turns is judged apart.
    """
    bodies = list(shown.bodies)
    partners: dict[tuple[int, int], set[int]] = {}
    for at, one, two in shown.contacts.tolist():
        partners.setdefault((one, at), set()).add(two)
        partners.setdefault((two, at), set()).add(one)
    for i, robot in enumerate(shown.robots):
        fingers = {bodies.index(f"{side} finger of {robot}") for side in ("left", "right")}
        for k, entity in enumerate(shown.objects):
            if entity in shown.furniture:
                continue  # A gripper slides along on a handle.
            first: Frame | None = None
            for at in range(len(shown.times)):
                if partners.get((bodies.index(entity), at)) != fingers:
                    first = None
                    continue
                x, y, z, *quaternion = shown.poses[at, k].astype(float).tolist()
                tool = arms[robot].tool(tuple(shown.joints[at, i].astype(float).tolist()))
                now = tool.inverse() @ frame_of(((x, y, z), quaternion))
                first = now if first is None else first
                far = float(np.linalg.norm(now.turn @ first.inverse().at + now.at))
                turn = first.offset(now)[1]
                if far > LOOSE or turn > np.radians(LOOSE_DEGREES):
                    yield f"frame {at}: {entity} is off by {1000 * far:.1f} mm, {np.degrees(turn):.1f} degrees"


def overloaded(shown: Any, kilograms: Mapping[str, float]) -> Iterator[str]:
    """Yield contacts of what fingers touch in the same frame that are stronger than the weight explains."""
    names = [[shown.bodies[one], shown.bodies[two]] for _, one, two in shown.contacts.tolist()]
    fingered: dict[int, set[str]] = {}
    for (at, *_), (one, two) in zip(shown.contacts.tolist(), names, strict=True):
        if " finger of " in one:
            fingered.setdefault(at, set()).add(two)
    for (at, *_), both, force in zip(shown.contacts.tolist(), names, shown.forces.tolist(), strict=True):
        touched = fingered.get(at, set()).intersection(both)
        if touched and force > HARD + TIMES * 9.81 * max(kilograms[each] for each in touched):
            yield f"frame {at}: {both[0]} and {both[1]}, {force:.1f} N"


def _may_touch(one: str, two: str, usual: set[str], every: set[str], fingered: set[str]) -> bool:
    """Tell whether two bodies may press on each other."""
    for body, other in ((one, two), (two, one)):
        if body.startswith("arm of "):
            return False
        if " finger of " in body:
            return other in usual
    return not {one, two} & fingered or {one, two} <= every | {"table"}


def _words(text: str) -> list[str]:
    """Return the arguments of an atom as it is written."""
    return text.replace("(", ",").replace(")", "").split(",")[1:]
