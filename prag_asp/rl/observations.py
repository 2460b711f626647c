"""What an agent sees: its arms, the bodies that its subgoal speaks of, the skill that is asked for.

A skill is an action without the bodies that it names: ``place(panda,_,left_of,_)``. The bodies have places of their
own, in the order of the action's arguments, so a policy for one cube is one for all.
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
"""What is told of a body, or of its part that moves; metres, radians; dx is from the tool of the arm that acts.

The turn is twice the angle about the vertical from that tool to the body, for a gripper that is turned by half
a circle grips alike.
"""

ARM = (*(f"joint {i}" for i in range(1, 8)), *"xyz", "vx", "vy", "vz", "cos yaw", "sin yaw", "width", "asked width")
"""What is told of an arm: joints in radians, where its tool is and how fast, how far the gripper is open; metres."""


@dataclass(frozen=True)
class Layout:
    """What stands where in an observation: each robot, each argument of the action that is a body, the skills.

    `bodies` are more bodies that are told of beside those of the action.
    """

    robots: tuple[str, ...]
    skills: Mapping[str, int]
    arguments: int
    bodies: tuple[str, ...] = ()

    @classmethod
    def of(cls, scene: Scene, actions: Iterable[Atom], *, everything: bool = False) -> Layout:
        """Return the layout for the actions of a domain; with `everything`, all bodies of the scene are told of.

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
        """What each number of an observation is."""
        arms = [f"{robot}: {what}" for robot in self.robots for what in ARM]
        bodies = [f"body {i + 1}: {what}" for i in range(self.arguments) for what in BODY]
        others = [f"{entity}: {what}" for entity in self.bodies for what in BODY]
        return (*arms, *bodies, *others, *self.skills)


def skill(action: Atom, scene: Scene) -> str:
    """Return an action with blanks for the bodies that it names."""
    blank = ["_" if _is_body(scene, argument) else argument for argument in action.arguments]
    return str(Atom(action.name, tuple(blank)))


def named_bodies(action: Atom, scene: Scene) -> list[str]:
    """Return the bodies, and surfaces, that an action names, in the order of its arguments."""
    return [argument for argument in action.arguments if _is_body(scene, argument)]


def _is_body(scene: Scene, entity: str) -> bool:
    """Tell whether an entity is something that stands somewhere."""
    return entity in scene.shapes and entity not in scene.robots


def observe(
    layout: Layout, situation: Situation, action: Atom, speeds: Mapping[str, Vector], asked: Mapping[str, float]
) -> NDArray[np.float32]:
    """Return what an agent sees that pursues an action, shape ``(len(layout.names),)``.

    `speeds` are those of the tools in metres a second, `asked` the openings in metres to which the grippers are told to
    go.
    """
    scene = situation.scene
    acting = next((name for name in action.arguments if name in scene.robots), layout.robots[0])
    found: list[float] = []
    for robot in layout.robots:
        (at, quaternion), arm = situation.tool(robot), situation.arm(robot)
        found += [*arm.joints, *at, *speeds[robot], *_direction(yaw_of(quaternion)), arm.width, asked[robot]]
    tool = situation.tool(acting)
    named = named_bodies(action, scene)
    for entity in named:
        found += _body(situation, entity, tool)
    found += [0.0] * (len(BODY) * (layout.arguments - len(named)))
    for entity in layout.bodies:
        found += _body(situation, entity, tool)
    one_hot = [0.0] * len(layout.skills)
    one_hot[layout.skills[skill(action, scene)]] = 1.0
    return np.array(found + one_hot, dtype=np.float32)


def _body(situation: Situation, entity: str, tool: Pose) -> Sequence[float]:
    """Return what is told of a body; all zeros where it does not take part."""
    if situation.shape(entity).traits.body and entity not in situation.poses:
        return [0.0] * len(BODY)
    at, quaternion = situation.part(entity)
    (x, y, z), (tx, ty, tz), yaw = at, tool.position, yaw_of(quaternion)
    turned = (*_direction(yaw), *_direction(2.0 * (yaw - yaw_of(tool.quaternion))))
    up = rotate(quaternion, (0.0, 0.0, 1.0))[2]
    half = situation.half(entity) if situation.is_table(entity) else situation.shape(entity).half
    return [1.0, x, y, z, x - tx, y - ty, z - tz, *turned, up, *half, situation.opening(entity)]


def _direction(yaw: float) -> tuple[float, float]:
    """Return the cosine and the sine of a yaw in radians."""
    return math.cos(yaw), math.sin(yaw)
