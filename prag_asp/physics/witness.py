"""A witness: how a task can be done, as values that round-trip to JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from prag_asp.physics.witness_json import VERSION, ArmForm, PoseForm, witness_form
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import Joints
from prag_asp.scene.scene import Size

TRANSIT = "transit"
"""The name of waypoints between those where something happens."""


class Arm(NamedTuple):
    """An arm at a moment: joint angles in radians, how far its gripper is open in metres, what it holds and how.

    `grasp` is the pose of the `held` object in the frame of the tool.
    """

    joints: Joints
    width: float
    held: str | None = None
    grasp: Pose | None = None


@dataclass(frozen=True)
class Moment:
    """One state of a witness.

    `poses` are those of all objects, `arms` the arms by the names of their robots, `openings` how far furniture is
    open, in metres or radians.
    """

    poses: Mapping[str, Pose]
    arms: Mapping[str, Arm]
    openings: Mapping[str, float] = field(default_factory=dict)

    @property
    def held(self) -> frozenset[str]:
        """Every object that an arm holds."""
        return frozenset(arm.held for arm in self.arms.values() if arm.held is not None)

    def to_json(self) -> dict[str, Any]:
        """Return the moment as JSON-able data, without `openings` where no furniture takes part."""
        data: dict[str, Any] = {
            "poses": {entity: _pose_json(pose) for entity, pose in self.poses.items()},
            "arms": {name: _arm_json(arm) for name, arm in self.arms.items()},
        }
        if self.openings:
            data["openings"] = dict(self.openings)
        return data


@dataclass(frozen=True)
class Waypoint:
    """A configuration that the arm of a `robot` passes during an action.

    `name` is approach (above the object), at, lift, carry, pull, retreat, move (empty) or stay; transit on the way
    there. `held` is what the gripper holds there; where that is the handle of furniture, `opening` is how far it is
    open, in metres or radians.
    """

    name: str
    robot: str
    joints: Joints
    width: float
    held: str | None = None
    opening: float | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the waypoint as JSON-able data, without `opening` where it holds no furniture."""
        data = {
            "name": self.name,
            "robot": self.robot,
            "joints": list(self.joints),
            "width": self.width,
            "held": self.held,
        }
        return data if self.opening is None else {**data, "opening": self.opening}


@dataclass(frozen=True)
class Witness:
    """How a task can be done: a moment for every state, and waypoints from each to the next.

    `sizes` are the sides in metres of the bounding boxes of the objects whose size was drawn.
    """

    moments: tuple[Moment, ...]
    motions: tuple[tuple[Waypoint, ...], ...]
    sizes: Mapping[str, Size] = field(default_factory=dict)

    @property
    def travels(self) -> bool:
        """Whether it shows the ways of the arm between the waypoints."""
        return any(waypoint.name == TRANSIT for motion in self.motions for waypoint in motion)

    def to_json(self) -> dict[str, Any]:
        """Return the witness as JSON-able data, without `sizes` where none was drawn."""
        data: dict[str, Any] = {
            "version": VERSION,
            "moments": [moment.to_json() for moment in self.moments],
            "motions": [[waypoint.to_json() for waypoint in motion] for motion in self.motions],
        }
        if self.sizes:
            data["sizes"] = {entity: list(size) for entity, size in self.sizes.items()}
        return data

    @classmethod
    def from_json(cls, data: Mapping[str, Any], robot: str = "panda") -> Witness:
        """Return the witness that `to_json` wrote, now or in the form before, in which a single `robot` had no name.

        Raises:
            QueryError: the data are of another form; the message names the field by its path.
        """
        return witness_of(data, "witness", robot)


def _pose_json(pose: Pose) -> list[list[float]]:
    """Return a pose as its position and its quaternion (x, y, z, w)."""
    return [list(pose.position), list(pose.quaternion)]


def _arm_json(arm: Arm) -> dict[str, Any]:
    """Return an arm as JSON-able data."""
    grasp = None if arm.grasp is None else _pose_json(arm.grasp)
    return {"joints": list(arm.joints), "width": arm.width, "held": arm.held, "grasp": grasp}


def witness_of(data: object, name: str, robot: str) -> Witness:
    """Return the witness that `Witness.to_json` wrote; `name` begins the paths of fields in messages.

    Raises:
        QueryError: the data are of another form.
    """
    form = witness_form(data, name, robot)
    moments = (
        Moment(
            {entity: _pose(pose) for entity, pose in each.poses.items()},
            {name: _arm(arm) for name, arm in each.arms.items()},
            each.openings or {},
        )
        for each in form.moments
    )
    motions = (
        tuple(Waypoint(at.name, at.robot, at.joints, at.width, at.held, at.opening) for at in motion)
        for motion in form.motions
    )
    return Witness(tuple(moments), tuple(motions), form.sizes or {})


def _pose(form: PoseForm) -> Pose:
    """Return the pose that `_pose_json` wrote."""
    position, quaternion = form
    return Pose(position, quaternion)


def _arm(form: ArmForm) -> Arm:
    """Return the arm that `_arm_json` wrote."""
    return Arm(form.joints, form.width, form.held, None if form.grasp is None else _pose(form.grasp))
