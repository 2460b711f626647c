"""A witness: an execution of a task, as values that can be converted to JSON and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from prag_asp.errors import QueryError
from prag_asp.scene.geometry import Pose
from prag_asp.tables.json_fields import Number, read, require_complete
from prag_asp.tables.report import shown

if TYPE_CHECKING:
    from prag_asp.scene.robots import Joints

VERSION = 2
"""The version of the format of witnesses and episodes."""

ROBOT_PARTS = ("arm", "left finger", "right finger")
"""The bodies of a robot whose contacts an episode records, named like ``arm of panda``."""

TRANSIT = "transit"
"""The name of waypoints on the collision-free path between two waypoints of an action."""

if TYPE_CHECKING:
    JointAngles = Joints
else:  # the type that msgspec checks
    JointAngles = tuple[Number, Number, Number, Number, Number, Number, Number]

BoxSize = tuple[Number, Number, Number]
"""The dimensions of a bounding box in metres."""


@dataclass(frozen=True)
class Arm:
    """The state of an arm: its joint angles, the opening of its gripper in metres, the held object and its grasp.

    `grasp` is the pose of the `held` object in the frame of the tool.
    """

    joints: JointAngles
    width: Number
    held: str | None = None
    grasp: Pose | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the arm as JSON-compatible data."""
        grasp = None if self.grasp is None else _pose_json(self.grasp)
        return {"joints": list(self.joints), "width": self.width, "held": self.held, "grasp": grasp}


@dataclass(frozen=True)
class Moment:
    """One state of a witness.

    `poses` are the poses of all objects, `arms` are the arms by robot name, and `openings` are the openings of
    furniture, in metres or radians.
    """

    poses: Mapping[str, Pose]
    arms: Mapping[str, Arm]
    openings: Mapping[str, Number] = field(default_factory=dict)

    @property
    def held(self) -> frozenset[str]:
        """Every object that an arm holds."""
        return frozenset(arm.held for arm in self.arms.values() if arm.held is not None)

    def to_json(self) -> dict[str, Any]:
        """Return the moment as JSON-compatible data, without `openings` if no furniture takes part."""
        data: dict[str, Any] = {
            "poses": {entity: _pose_json(pose) for entity, pose in self.poses.items()},
            "arms": {name: arm.to_json() for name, arm in self.arms.items()},
        }
        if self.openings:
            data["openings"] = dict(self.openings)
        return data


@dataclass(frozen=True)
class Waypoint:
    """A joint configuration that the arm of a `robot` passes during an action.

    `name` is ``approach`` (above the object), ``at``, ``lift``, ``carry``, ``pull``, ``retreat``, ``move`` (with an
    empty gripper) or ``stay``, or ``transit`` on the path to one of these waypoints. `held` is the body in the gripper;
    if the gripper holds the handle of furniture, `opening` is the opening of the furniture, in metres or radians.
    """

    name: str
    robot: str
    joints: JointAngles
    width: Number
    held: str | None = None
    opening: Number | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the waypoint as JSON-compatible data, without `opening` if it holds no furniture."""
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
    """An execution of a task: a moment for every state, and the waypoints from each moment to the next.

    `sizes` holds the sizes of those objects whose sizes were sampled.
    """

    moments: tuple[Moment, ...]
    motions: tuple[tuple[Waypoint, ...], ...]
    sizes: Mapping[str, BoxSize] = field(default_factory=dict)

    @property
    def has_transit(self) -> bool:
        """Whether the witness contains the paths of the arm between the waypoints of actions."""
        return any(waypoint.name == TRANSIT for motion in self.motions for waypoint in motion)

    def to_json(self) -> dict[str, Any]:
        """Return the witness as JSON-compatible data, without `sizes` if none was sampled."""
        data: dict[str, Any] = {
            "version": VERSION,
            "moments": [moment.to_json() for moment in self.moments],
            "motions": [[waypoint.to_json() for waypoint in motion] for motion in self.motions],
        }
        if self.sizes:
            data["sizes"] = {entity: list(size) for entity, size in self.sizes.items()}
        return data

    @classmethod
    def from_json(cls, data: object, name: str = "witness") -> Witness:
        """Return the witness that `to_json` wrote; the paths of fields in messages begin with `name`.

        Raises:
            QueryError: the data have a wrong format; the message gives the path of the field.
        """
        if isinstance(data, Mapping) and "version" not in data:
            raise QueryError(f"{name}.version: is missing")
        if isinstance(data, Mapping) and (type(data["version"]) is not int or data["version"] != VERSION):
            raise QueryError(f"{name}.version: needs {VERSION}; got {shown(data['version'])}")
        witness = read(data, cls, name)
        require_complete(data, witness.to_json(), name)
        return witness


def _pose_json(pose: Pose) -> list[list[float]]:
    """Return a pose as its position and its quaternion (x, y, z, w)."""
    return [list(pose.position), list(pose.quaternion)]
