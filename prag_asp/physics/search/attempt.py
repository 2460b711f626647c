"""What the search for a witness carries along, and how it says that an attempt failed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from prag_asp.physics.robot import Joints, Robot
from prag_asp.physics.search.foresight import Foresight
from prag_asp.physics.search.spans import Spans
from prag_asp.physics.situation import Situation, Standing
from prag_asp.physics.witness import ArmState, Moment
from prag_asp.physics.world.simulator import Simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.model import Scene

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
    LOST,
    NOT_REACHED,
)
"""Every cause of a failed attempt, cheapest check first."""


class Failure(Exception):
    """One attempt of the search failed; its argument is one of `CAUSES`. It never leaves the validator."""


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
    """One state of the search: the situation, the arm, what it holds.

    `above` is the configuration straight above the gripper's place, kept while the gripper is down at an
    object.
    """

    situation: Situation
    joints: Joints
    held: str | None = None
    grasp: Pose | None = None
    above: Joints | None = None

    def moment(self) -> Moment:
        """Return the snapshot as a moment of a witness."""
        situation = self.situation
        others = {name: ArmState(arm.joints, arm.width, arm.held, arm.grasp) for name, arm in situation.others.items()}
        return Moment(
            dict(situation.poses),
            self.joints,
            situation.width,
            self.held,
            self.grasp,
            dict(situation.openings),
            situation.acting,
            others,
        )

    def turned_to(self, robot: str) -> Snapshot:
        """Return the snapshot with another robot as the one that acts; with no name it stays the same one."""
        situation = self.situation
        if robot in ("", situation.acting):
            return self
        others = dict(situation.others)
        other = others.pop(robot)
        others[situation.acting] = Standing(
            self.joints, situation.tool, situation.width, self.held, self.grasp, self.above
        )
        turned = replace(situation, tool=other.tool, width=other.width, acting=robot, others=others)
        return Snapshot(turned, other.joints, other.held, other.grasp, other.above)
