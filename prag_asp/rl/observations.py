"""Observations: the arms, the current action's skill and bodies, and the distances of the facts in the subgoal.

A skill is an action without its bodies: ``place(panda,_,left_of,_)``. The features of bodies are in the order of the
action's arguments, so a policy for one cube works for all cubes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import itemgetter
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.physics.situation import Situation
from prag_asp.rl.goals import BROUGHT
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import rotate, yaw_of
from prag_asp.scene.scene import Scene

ObservationKind = Literal["relative", "poses"]
OBSERVATIONS: tuple[ObservationKind, ...] = get_args(ObservationKind)
"""The kinds of observations: `relative` holds the features on which a skill depends, scaled to about 1; `poses` has all
features, in metres and radians."""

BODY = (
    "is there", *"xyz", "dx", "dy", "dz", "cos yaw", "sin yaw", "cos turn", "sin turn", "up", "half x", "half y",
    "half z", "opening",
)  # fmt: skip
"""The features of a body, or of its moving part, in metres and radians.

The position dx, dy, dz is relative to the tool of the acting arm. The turn is twice the yaw of the
body relative to that tool, because a gripper is symmetric under half a turn.
"""

ARM = (*(f"joint {i}" for i in range(1, 8)), *"xyz", "vx", "vy", "vz", "cos yaw", "sin yaw", "width", "asked width")
"""The features of an arm: the joint angles in radians; the position of the tool in metres, and its velocity in metres
per second; the cosine and sine of its yaw; and the actual and commanded opening in metres.
"""

FACTS = (*(f"fact {i + 1}" for i in range(BROUGHT)), "other facts")
"""The signed distances of the facts in the current subgoal, in metres or radians: one for each fact that the action
achieves, and the largest distance of all other facts. A fact holds if its distance is at most 0.
"""

JOINT_SCALES = {f"joint {i}": 0.5 for i in range(1, 8)}
ARM_SCALES = {
    "z": 10.0, "vx": 2.0, "vy": 2.0, "vz": 2.0, "cos yaw": 1.0,
    "sin yaw": 1.0, "width": 25.0, "asked width": 25.0,
}  # fmt: skip
BODY_SCALES = {
    "is there": 1.0, "dx": 10.0, "dy": 10.0, "dz": 10.0, "cos turn": 1.0, "sin turn": 1.0, "up": 1.0, "half x": 20.0,
    "half y": 20.0, "half z": 20.0, "opening": 1.0,
}  # fmt: skip
"""The features of a body in a relative observation, with the factors that scale them to about 1 within the reach of an
arm and the width of a gripper.
"""

FACT_SCALE, FACT_BOUNDS = 10.0, (-0.1, 0.5)
"""The factor for the distance of a fact, and the bounds in metres or radians to which the distance is clipped before
scaling."""


@dataclass(frozen=True)
class Layout:
    """The layout of an observation: robots, the maximum number of bodies in an action, further `bodies`, and skills."""

    robots: tuple[str, ...]
    skills: Mapping[str, int]
    arguments: int
    bodies: tuple[str, ...] = ()
    kind: ObservationKind = "relative"
    joints: bool = False

    @classmethod
    def of(
        cls,
        scene: Scene,
        actions: Iterable[Atom],
        *,
        everything: bool = False,
        kind: ObservationKind = "relative",
        joints: bool = False,
    ) -> Layout:
        """Return the layout for the actions of a domain.

        With `everything`, the layout includes all bodies of the scene; with `joints`, it includes the joints even in a
        `relative` observation.

        Raises:
            QueryError: there are no actions.
        """
        actions = list(actions)
        if not actions:
            raise QueryError("there is nothing to learn: the domain has no action")
        skills = sorted({skill(action, scene) for action in actions})
        bodies = tuple(entity for entity, shape in scene.shapes.items() if shape.traits.body) if everything else ()
        most = max(len(named_bodies(action, scene)) for action in actions)
        return cls(tuple(scene.robots), {name: i for i, name in enumerate(skills)}, most, bodies, kind, joints)

    @property
    def scales(self) -> Mapping[str, float]:
        """The scale factor of each feature of an observation, by name; for `poses`, in metres and radians, it is 1."""
        return {name: scale for name, scale in self._all_scales if scale}

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the features of an observation, in order."""
        return tuple(self.scales)

    def arranged(self, values: Sequence[float]) -> NDArray[np.float32]:
        """Assemble an observation from the values of all features."""
        choose, scales = self._columns
        chosen = np.empty(len(scales), dtype=np.float32)
        np.multiply(choose(values), scales, out=chosen)
        return chosen

    @cached_property
    def _columns(self) -> tuple[itemgetter[Any], NDArray[np.float64]]:
        """A function that chooses the observed features from all features, and their scale factors."""
        scales = np.array([scale for _, scale in self._all_scales])
        places = np.flatnonzero(scales)
        return itemgetter(*places.tolist()), scales[places]

    def words_of(self, action: Atom, scene: Scene) -> tuple[list[str], list[float]]:
        """Return the bodies and surfaces that an action names, and its skill as a one-hot vector."""
        words = self._words.get(action)
        if words is None:
            one_hot = [0.0] * len(self.skills)
            one_hot[self.skills[skill(action, scene)]] = 1.0
            words = self._words[action] = named_bodies(action, scene), one_hot
        return words

    @cached_property
    def _words(self) -> dict[Atom, tuple[list[str], list[float]]]:
        """The results of `words_of` for the actions so far."""
        return {}

    @property
    def _all_scales(self) -> list[tuple[str, float]]:
        """The names and scale factors of all features; a feature that is not observed has factor 0."""
        relative = self.kind == "relative"
        arm = {**(JOINT_SCALES if self.joints else {}), **ARM_SCALES}
        owners = [(robot, ARM, arm) for robot in self.robots]
        named = [f"body {i + 1}" for i in range(self.arguments)]
        owners += [(body, BODY, BODY_SCALES) for body in (*named, *self.bodies)]
        result = [
            (f"{owner}: {what}", scales.get(what, 0.0) if relative else 1.0)
            for owner, features, scales in owners
            for what in features
        ]
        result += [(fact, FACT_SCALE if relative else 1.0) for fact in FACTS]
        return [*result, *((name, 1.0) for name in self.skills)]


def skill(action: Atom, scene: Scene) -> str:
    """Return the skill of an action: its text with ``_`` in place of each body."""
    blank = ["_" if _is_body(scene, argument) else argument for argument in action.arguments]
    return str(Atom(action.name, tuple(blank)))


def named_bodies(action: Atom, scene: Scene) -> list[str]:
    """Return the bodies and surfaces among the arguments of an action, in order."""
    return [argument for argument in action.arguments if _is_body(scene, argument)]


def _is_body(scene: Scene, entity: str) -> bool:
    """Return whether an entity is a body or a surface."""
    return entity in scene.shapes and entity not in scene.robots


def observe(
    layout: Layout,
    situation: Situation,
    action: Atom,
    speeds: Mapping[str, Vector],
    commanded: Mapping[str, float],
    missed: NDArray[np.floating],
) -> NDArray[np.float32]:
    """Return the observation of an agent that pursues an action, shape ``(len(layout.names),)``.

    `speeds` holds the velocities of the tools in metres per second, `commanded` holds the commanded openings of the
    grippers in metres, and `missed` holds the distances of the facts in the subgoal, in the order of `FACTS`.
    """
    scene = situation.scene
    acting = next((name for name in action.arguments if name in scene.robots), layout.robots[0])
    values: list[float] = []
    for robot in layout.robots:
        (at, quaternion), arm = situation.tool(robot), situation.arm(robot)
        values += [*arm.joints, *at, *speeds[robot], *_direction(yaw_of(quaternion)), arm.width, commanded[robot]]
    position, quaternion = situation.tool(acting)
    yaw = yaw_of(quaternion)
    named, one_hot = layout.words_of(action, scene)
    for entity in named:
        values += _body(situation, entity, position, yaw)
    values += [0.0] * (len(BODY) * (layout.arguments - len(named)))
    for entity in layout.bodies:
        values += _body(situation, entity, position, yaw)
    if layout.kind == "relative":
        missed = np.minimum(np.maximum(missed, FACT_BOUNDS[0]), FACT_BOUNDS[1])
    values += missed.tolist()
    return layout.arranged(values + one_hot)


def _body(situation: Situation, entity: str, tool: Vector, tool_yaw: float) -> Sequence[float]:
    """Return the features of a body relative to a tool with a position and yaw, or zeros if the body is not there."""
    shape = situation.shape(entity)
    if shape.traits.body and entity not in situation.poses:
        return [0.0] * len(BODY)
    at, quaternion = situation.part(entity)
    (x, y, z), (tx, ty, tz), yaw = at, tool, yaw_of(quaternion)
    turned = (*_direction(yaw), *_direction(2.0 * (yaw - tool_yaw)))
    up = rotate(quaternion, (0.0, 0.0, 1.0))[2]
    half = situation.half(entity) if shape.kind == "table" else shape.half
    return [1.0, x, y, z, x - tx, y - ty, z - tz, *turned, up, *half, situation.opening(entity)]


def _direction(yaw: float) -> tuple[float, float]:
    """Return the cosine and sine of a yaw in radians."""
    return math.cos(yaw), math.sin(yaw)
