"""The state of the search for a witness, and the causes of failed attempts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from prag_asp.physics.search.foresight import Foresight, LaterPuts
from prag_asp.physics.search.spans import Spans
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.physics.witness import Arm, Moment, Waypoint
from prag_asp.physics.world.simulator import Simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import Joints, Robot
from prag_asp.scene.scene import Scene

EMPTY_VOLUME = "no room where the relations require the object"
RELATION = "a relation of the state does not hold"
OBJECTS_COLLIDE = "objects collide"
UNSUPPORTED = "an object would fall"
NO_GRASP = "no grasp fits the object"
NO_KINEMATICS_AT = "no arm configuration at the object"
NO_KINEMATICS_ABOVE = "no arm configuration above the object"
ARM_COLLIDES = "the arm collides"
TWISTS = "the gripper cannot resist the torque of the object's weight"
UNSTABLE = "an object tips, slides or rolls"
UNSETTLED = "a relation does not hold once the objects have settled"
NO_PATH = "the arm finds no free path"
PRESSED = "bodies press on each other although the task does not require this contact"
LOST = "the gripper does not hold its object"
OVERBEARING = "a contact that the task requires is too strong"
SLIPPED = "an object slips or turns in the gripper"
HASTY = "a joint accelerates beyond its limit"
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
    TWISTS,
    UNSTABLE,
    UNSETTLED,
    NO_PATH,
    PRESSED,
    OVERBEARING,
    SLIPPED,
    HASTY,
    LOST,
    NOT_REACHED,
)
"""The causes of failed attempts, in the order of the cost of their checks."""


class PhysicsFault(NamedTuple):
    """The reason why an attempt or a witness failed: the cause, the bodies, and the violated fact or a text.

    The cause is one of `CAUSES`, or a problem found when a witness is checked again.
    """

    cause: str
    entities: tuple[str, ...] = ()
    fact: Fact | None = None
    text: str = ""


class Failure(Exception):
    """An attempt of the search failed, with one of `CAUSES` as its cause; the search catches this exception.

    `missed` is the amount by which it failed, in metres (for a fact about a rotation, in radians), or 0 if it is
    unknown.
    """

    def __init__(self, cause: str, *entities: str, fact: Fact | None = None, missed: float = 0.0):
        super().__init__(cause)
        self.missed = missed
        self.fault = PhysicsFault(cause, entities or (() if fact is None else fact.arguments), fact)


class Exhausted(Exception):
    """An action has no random choices, so there are no further attempts; the validator catches this exception."""


@dataclass(frozen=True)
class Search:
    """The input of a search: the simulator, the task's objects and random generator, and the room for later actions.

    If `packs` is true, objects are placed tightly, for tasks that random placement does not solve. If `returns` is
    true, actions are undone, back to an action that may be the cause, when all attempts at an action fail. Of the
    grasps of bodies with a model, the best `passed_over` are tried last, because witnesses with these grasps failed a
    later check. Objects put on one body are placed so that the `later_puts` on it find room.
    """

    simulator: Simulator
    objects: tuple[str, ...]
    rng: np.random.Generator
    foresight: Foresight
    spans: Spans = field(default_factory=dict)
    packs: bool = False
    returns: bool = False
    passed_over: int = 0
    later_puts: LaterPuts = field(default_factory=dict)

    @property
    def scene(self) -> Scene:
        """The scene of the simulator."""
        return self.simulator.scene

    @property
    def robot(self) -> Robot:
        """The acting robot in the simulator."""
        return self.simulator.robot

    def uniform(self, low: float, high: float) -> float:
        """Return a uniformly distributed random number between two bounds."""
        return low + (high - low) * self.rng.random()


@dataclass(frozen=True)
class Snapshot:
    """A state of the search: the situation, the acting robot, and the grippers that are lowered to an object.

    `lowered` maps each of these grippers to the joint configuration straight above the object. `waypoints` are the
    waypoints of the current action.
    """

    situation: Situation
    acting: str
    lowered: Mapping[str, Joints] = field(default_factory=dict)
    waypoints: tuple[Waypoint, ...] = ()

    @property
    def arm(self) -> Arm:
        """The acting arm."""
        return self.situation.arms[self.acting]

    @property
    def tool(self) -> Pose:
        """The pose of the tool of the acting arm."""
        return self.situation.tool(self.acting)

    @property
    def above(self) -> Joints | None:
        """The joint configuration straight above the acting gripper, or None if it is not lowered to an object."""
        return self.lowered.get(self.acting)

    def moment(self) -> Moment:
        """Return the snapshot as a moment of a witness."""
        situation = self.situation
        return Moment(dict(situation.poses), dict(situation.arms), dict(situation.openings))

    def turned_to(self, robot: str | None) -> Snapshot:
        """Return the snapshot with another acting robot; None keeps the current robot."""
        return self if robot is None else replace(self, acting=robot)

    def with_arm(self, arm: Arm, above: Joints | None = None) -> Snapshot:
        """Return the snapshot with a new state of the acting arm, lowered from `above` if that is given."""
        lowered = {robot: joints for robot, joints in self.lowered.items() if robot != self.acting}
        if above is not None:
            lowered[self.acting] = above
        return replace(self, situation=self.situation.with_arm(self.acting, arm), lowered=lowered)

    def with_poses(self, poses: Mapping[str, Pose]) -> Snapshot:
        """Return the snapshot with new poses of the objects."""
        return replace(self, situation=self.situation.with_poses(poses))

    def with_waypoint(self, name: str) -> Snapshot:
        """Return the snapshot with a waypoint added, at the configuration of the acting arm."""
        arm = self.arm
        waypoint = Waypoint(name, self.acting, arm.joints, arm.width, arm.held)
        return replace(self, waypoints=(*self.waypoints, waypoint))
