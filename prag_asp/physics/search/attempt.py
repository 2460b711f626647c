"""What the search for a witness carries along, and how it says that an attempt failed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from prag_asp.physics.search.foresight import Foresight
from prag_asp.physics.search.spans import Spans
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.physics.witness import Arm, Moment
from prag_asp.physics.world.simulator import Simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import Joints, Robot
from prag_asp.scene.scene import Scene

EMPTY_VOLUME = "no room where the relations want the object"
RELATION = "a relation of the state does not hold"
OBJECTS_COLLIDE = "objects collide"
UNSUPPORTED = "an object would fall"
NO_GRASP = "no grasp fits the object"
NO_KINEMATICS_AT = "no arm configuration at the object"
NO_KINEMATICS_ABOVE = "no arm configuration above the object"
ARM_COLLIDES = "the arm collides"
UNSTABLE = "an object tips, slides or rolls"
UNSETTLED = "a relation does not hold once the objects have settled"
NO_PATH = "the arm finds no free path"
PRESSED = "bodies press on each other though the task does not ask for it"
LOST = "the gripper does not hold its object"
NOT_REACHED = "a relation does not hold after the robot's motion"

CAUSES = (
    EMPTY_VOLUME,
    RELATION,
    OBJECTS_COLLIDE,
    UNSUPPORTED,
    NO_GRASP,
    NO_KINEMATICS_AT,
    NO_KINEMATICS_ABOVE,
    ARM_COLLIDES,
    UNSTABLE,
    UNSETTLED,
    NO_PATH,
    PRESSED,
    LOST,
    NOT_REACHED,
)
"""Every cause of a failed attempt, cheapest check first."""


class Fault(NamedTuple):
    """What went wrong: one of `CAUSES`, the bodies concerned, and the fact that does not hold or other words on it."""

    cause: str
    entities: tuple[str, ...] = ()
    fact: Fact | None = None
    text: str = ""


class Failure(Exception):
    """One attempt of the search failed: one of `CAUSES`, and of what. It never leaves the validator."""

    def __init__(self, cause: str, *entities: str, fact: Fact | None = None):
        super().__init__(cause)
        self.fault = Fault(cause, entities or (() if fact is None else fact.arguments), fact)


class Exhausted(Exception):
    """Nothing of this action is drawn at random, so nothing is left to attempt. It stays in the validator."""


@dataclass(frozen=True)
class Search:
    """The simulator, the objects of the task, the generator of random numbers of this task, what comes later in it."""

    simulator: Simulator
    objects: tuple[str, ...]
    rng: np.random.Generator
    foresight: Foresight
    spans: Spans = field(default_factory=dict)

    @property
    def scene(self) -> Scene:
        """The scene of the simulator."""
        return self.simulator.scene

    @property
    def robot(self) -> Robot:
        """The robot that acts in the simulator."""
        return self.simulator.robot

    def uniform(self, low: float, high: float) -> float:
        """Draw a number between two bounds."""
        return low + (high - low) * self.rng.random()


@dataclass(frozen=True)
class Snapshot:
    """One state of the search: the situation, the robot that acts, and which grippers are down at an object.

    `lowered` holds for each of these the joint angles straight above its place.
    """

    situation: Situation
    acting: str
    lowered: Mapping[str, Joints] = field(default_factory=dict)

    @property
    def arm(self) -> Arm:
        """The arm that acts."""
        return self.situation.arms[self.acting]

    @property
    def tool(self) -> Pose:
        """The pose of the tool of the arm that acts."""
        return self.situation.tool(self.acting)

    @property
    def above(self) -> Joints | None:
        """The joint angles straight above the gripper that acts, None where it is not down at an object."""
        return self.lowered.get(self.acting)

    def moment(self) -> Moment:
        """Return the snapshot as a moment of a witness."""
        situation = self.situation
        return Moment(dict(situation.poses), dict(situation.arms), dict(situation.openings))

    def turned_to(self, robot: str | None) -> Snapshot:
        """Return the snapshot with another robot as the one that acts; with None it stays the same one."""
        return self if robot is None else replace(self, acting=robot)

    def with_arm(self, arm: Arm, above: Joints | None = None) -> Snapshot:
        """Return the snapshot with the arm that acts elsewhere; `above` is where it was lowered from to be there."""
        lowered = {robot: joints for robot, joints in self.lowered.items() if robot != self.acting}
        if above is not None:
            lowered[self.acting] = above
        return Snapshot(self.situation.with_arm(self.acting, arm), self.acting, lowered)

    def with_poses(self, poses: Mapping[str, Pose]) -> Snapshot:
        """Return the snapshot with other poses of the objects."""
        return replace(self, situation=self.situation.with_poses(poses))
