"""The outcome of a physical check, as values that round-trip to JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from prag_asp.errors import QueryError
from prag_asp.physics.demonstration import Demonstration
from prag_asp.physics.geometry import Pose
from prag_asp.physics.robot import Joints

Status = Literal["feasible", "not_found", "infeasible"]
Tier = Literal["kinematics", "settling", "transit", "demonstration"]
TIERS: tuple[Tier, ...] = get_args(Tier)
"""The tiers of checks, the cheapest first."""
TRANSIT = "transit"
"""The name of waypoints between those where something happens."""


@dataclass(frozen=True)
class Budget:
    """How hard to look for a witness, and what it has to pass.

    `restarts` are the first states tried for a task, `samples` the attempts at each action. `tier` is the
    dearest tier of checks; those before it in `TIERS` are included.

    Raises:
        QueryError: a number is not positive, or the tier is unknown.
    """

    restarts: int = 10
    samples: int = 10
    tier: Tier = "kinematics"

    def __post_init__(self) -> None:
        if self.restarts < 1 or self.samples < 1:
            raise QueryError(f"a budget needs at least 1 restart and 1 sample; got {self.restarts} x {self.samples}")
        if self.tier not in TIERS:
            raise QueryError(f"unknown tier of checks {self.tier!r}; known are {', '.join(TIERS)}")

    def __str__(self) -> str:
        return f"{self.restarts} x {self.samples}, {self.tier}"

    def includes(self, tier: Tier) -> bool:
        """Tell whether a tier of checks is asked for."""
        return TIERS.index(tier) <= TIERS.index(self.tier)

    def to_json(self) -> dict[str, Any]:
        """Return the budget as JSON-able data."""
        return {"restarts": self.restarts, "samples": self.samples, "tier": self.tier}


@dataclass(frozen=True)
class Moment:
    """One state of a witness.

    `poses` are those of all objects, `joints` the seven joint angles in radians, `width` the opening in
    metres, `grasp` the pose of the `held` object in the frame of the tool.
    """

    poses: Mapping[str, Pose]
    joints: Joints
    width: float
    held: str | None = None
    grasp: Pose | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the moment as JSON-able data."""
        return {
            "poses": {entity: _pose_json(pose) for entity, pose in self.poses.items()},
            "joints": list(self.joints),
            "width": self.width,
            "held": self.held,
            "grasp": None if self.grasp is None else _pose_json(self.grasp),
        }


@dataclass(frozen=True)
class Waypoint:
    """A configuration that the arm passes during an action.

    `name` is approach (above the object), at, lift, carry, retreat or stay; transit on the way there. `held` is
    what the gripper holds there.
    """

    name: str
    joints: Joints
    width: float
    held: str | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the waypoint as JSON-able data."""
        return {"name": self.name, "joints": list(self.joints), "width": self.width, "held": self.held}


@dataclass(frozen=True)
class Witness:
    """How a task can be done: a moment for every state, and waypoints from each to the next."""

    moments: tuple[Moment, ...]
    motions: tuple[tuple[Waypoint, ...], ...]

    @property
    def travels(self) -> bool:
        """Whether it shows the ways of the arm between the waypoints."""
        return any(waypoint.name == TRANSIT for motion in self.motions for waypoint in motion)

    def to_json(self) -> dict[str, Any]:
        """Return the witness as JSON-able data."""
        return {
            "moments": [moment.to_json() for moment in self.moments],
            "motions": [[waypoint.to_json() for waypoint in motion] for motion in self.motions],
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Witness:
        """Return the witness that `to_json` wrote.

        Raises:
            QueryError: the data are of another form.
        """
        try:
            return cls(
                tuple(_moment(moment) for moment in data["moments"]),
                tuple(tuple(_waypoint(waypoint) for waypoint in motion) for motion in data["motions"]),
            )
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise QueryError(f"this is not a witness: {error!r}") from error


@dataclass(frozen=True)
class Verdict:
    """What physics says of a task, and how hard it looked.

    `reason` says why a task is proved infeasible or could not be looked at; `causes` counts why attempts
    failed; `restarts` is how many first states were tried. `seed` and `index` together repeat the search.
    `demonstration` is there where the budget asks for one; it is too large for JSON, and has a file of its own.
    """

    status: Status
    budget: Budget
    seed: int
    index: int
    reason: str = ""
    causes: Mapping[str, int] = field(default_factory=dict)
    restarts: int = 0
    witness: Witness | None = None
    demonstration: Demonstration | None = None

    @property
    def feasible(self) -> bool:
        """Whether a witness was found."""
        return self.status == "feasible"

    def to_json(self) -> dict[str, Any]:
        """Return the verdict as JSON-able data."""
        return {
            "status": self.status,
            "budget": self.budget.to_json(),
            "seed": self.seed,
            "index": self.index,
            "reason": self.reason,
            "causes": dict(self.causes),
            "restarts": self.restarts,
            "witness": None if self.witness is None else self.witness.to_json(),
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Verdict:
        """Return the verdict that `to_json` wrote.

        Raises:
            QueryError: the data are of another form.
        """
        try:
            if data["status"] not in get_args(Status):
                raise ValueError(data["status"])
            return cls(
                status=data["status"],
                budget=Budget(data["budget"]["restarts"], data["budget"]["samples"], data["budget"]["tier"]),
                seed=int(data["seed"]),
                index=int(data["index"]),
                reason=str(data["reason"]),
                causes={str(cause): int(count) for cause, count in data["causes"].items()},
                restarts=int(data["restarts"]),
                witness=None if data["witness"] is None else Witness.from_json(data["witness"]),
            )
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise QueryError(f"this is not a verdict: {error!r}") from error


def _pose_json(pose: Pose) -> list[list[float]]:
    """Return a pose as its position and its quaternion (x, y, z, w)."""
    return [list(pose.position), list(pose.quaternion)]


def _pose(data: Any) -> Pose:
    """Return the pose that `_pose_json` wrote."""
    (x, y, z), (qx, qy, qz, qw) = data
    return Pose((float(x), float(y), float(z)), (float(qx), float(qy), float(qz), float(qw)))


def _moment(data: Mapping[str, Any]) -> Moment:
    """Return the moment that `Moment.to_json` wrote."""
    return Moment(
        poses={str(entity): _pose(pose) for entity, pose in data["poses"].items()},
        joints=tuple(map(float, data["joints"])),
        width=float(data["width"]),
        held=data["held"],
        grasp=None if data["grasp"] is None else _pose(data["grasp"]),
    )


def _waypoint(data: Mapping[str, Any]) -> Waypoint:
    """Return the waypoint that `Waypoint.to_json` wrote."""
    return Waypoint(str(data["name"]), tuple(map(float, data["joints"])), float(data["width"]), data["held"])
