"""Observations: the arms, the bodies of the current action, and its skill.

A skill is an action without the bodies that it names: ``place(panda,_,left_of,_)``. The features of bodies are in the
order of the action's arguments, so a policy for one cube fits all cubes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Pose, rotate, yaw_of
from prag_asp.scene.scene import Scene

BODY = (
    "is there", *"xyz", "dx", "dy", "dz", "cos yaw", "sin yaw", "cos turn", "sin turn", "up", "half x", "half y",
    "half z", "opening",
)  # fmt: skip
"""The features of a body, or of its moving part, in metres and radians; dx is relative to the tool of the acting arm.

The turn is twice the angle about the vertical from that tool to the body, because a gripper is symmetric under half a
turn.
"""

ARM = (*(f"joint {i}" for i in range(1, 8)), *"xyz", "vx", "vy", "vz", "cos yaw", "sin yaw", "width", "asked width")
"""The features of an arm: joints in radians; position and velocity of its tool, and actual and commanded opening, in
metres."""


@dataclass(frozen=True)
class Layout:
    """The layout of an observation: robots, the action's arguments that are bodies, additional `bodies`, and skills."""

    robots: tuple[str, ...]
    skills: Mapping[str, int]
    arguments: int
    bodies: tuple[str, ...] = ()

    @classmethod
    def of(cls, scene: Scene, actions: Iterable[Atom], *, everything: bool = False) -> Layout:
        """Return the layout for the actions of a domain; with `everything`, it includes all bodies of the scene.

        Raises:
            QueryError: there are no actions.
        """
        actions = list(actions)
        if not actions:
            raise QueryError("there is nothing to learn: the domain has no action")
        skills = sorted({skill(action, scene) for action in actions})
        bodies = tuple(entity for entity, shape in scene.shapes.items() if shape.traits.body) if everything else ()
        most = max(len(named_bodies(action, scene)) for action in actions)
        return cls(tuple(scene.robots), {name: i for i, name in enumerate(skills)}, most, bodies)

    @property
    def names(self) -> tuple[str, ...]:
        """The name of each number of an observation."""
        arms = [f"{robot}: {what}" for robot in self.robots for what in ARM]
        bodies = [f"body {i + 1}: {what}" for i in range(self.arguments) for what in BODY]
        others = [f"{entity}: {what}" for entity in self.bodies for what in BODY]
        return (*arms, *bodies, *others, *self.skills)


def skill(action: Atom, scene: Scene) -> str:
    """Return the skill of an action: its text with ``_`` for each body that it names."""
    blank = ["_" if _is_body(scene, argument) else argument for argument in action.arguments]
    return str(Atom(action.name, tuple(blank)))


def named_bodies(action: Atom, scene: Scene) -> list[str]:
    """Return the bodies and surfaces that an action names, in the order of its arguments."""
    return [argument for argument in action.arguments if _is_body(scene, argument)]


def _is_body(scene: Scene, entity: str) -> bool:
    """Return whether an entity is a body or a surface."""
    return entity in scene.shapes and entity not in scene.robots


def observe(
    layout: Layout, situation: Situation, action: Atom, speeds: Mapping[str, Vector], commanded: Mapping[str, float]
) -> NDArray[np.float32]:
    """Return the observation of an agent that pursues an action, shape ``(len(layout.names),)``.

    `speeds` are the velocities of the tools in metres a second, `commanded` the openings of the grippers in metres.
    """
    scene = situation.scene
    acting = next((name for name in action.arguments if name in scene.robots), layout.robots[0])
    values: list[float] = []
    for robot in layout.robots:
        (at, quaternion), arm = situation.tool(robot), situation.arm(robot)
        values += [*arm.joints, *at, *speeds[robot], *_direction(yaw_of(quaternion)), arm.width, commanded[robot]]
    tool = situation.tool(acting)
    named = named_bodies(action, scene)
    for entity in named:
        values += _body(situation, entity, tool)
    values += [0.0] * (len(BODY) * (layout.arguments - len(named)))
    for entity in layout.bodies:
        values += _body(situation, entity, tool)
    one_hot = [0.0] * len(layout.skills)
    one_hot[layout.skills[skill(action, scene)]] = 1.0
    return np.array(values + one_hot, dtype=np.float32)


def _body(situation: Situation, entity: str, tool: Pose) -> Sequence[float]:
    """Return the features of a body, or zeros if it is not in the situation."""
    if situation.shape(entity).traits.body and entity not in situation.poses:
        return [0.0] * len(BODY)
    at, quaternion = situation.part(entity)
    (x, y, z), (tx, ty, tz), yaw = at, tool.position, yaw_of(quaternion)
    turned = (*_direction(yaw), *_direction(2.0 * (yaw - yaw_of(tool.quaternion))))
    up = rotate(quaternion, (0.0, 0.0, 1.0))[2]
    half = situation.half(entity) if situation.is_table(entity) else situation.shape(entity).half
    return [1.0, x, y, z, x - tx, y - ty, z - tz, *turned, up, *half, situation.opening(entity)]


def _direction(yaw: float) -> tuple[float, float]:
    """Return the cosine and sine of a yaw in radians."""
    return math.cos(yaw), math.sin(yaw)
