"""Witnesses as they stand in files: what each field of JSON has to be, today and in the form before."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from prag_asp.errors import QueryError
from prag_asp.tables.json_fields import Number, read
from prag_asp.tables.report import shown

VERSION = 2
"""The form in which witnesses and recordings are written; the one before has no number.

There a single robot has no name. A moment of a witness holds the fields of the arm that has acted, the name of its
`robot` and the `others` beside them. In a recording a single robot has no axis.
"""

PARTS = ("arm", "left finger", "right finger")
"""What a recording tells of the touch of robots: each of them `of` a robot."""

Triple = tuple[Number, Number, Number]
PoseForm = tuple[Triple, tuple[Number, Number, Number, Number]]
"""A position, and a quaternion x, y, z, w."""

JointsForm = tuple[Number, Number, Number, Number, Number, Number, Number]


class ArmForm(msgspec.Struct):
    """An arm: joint angles in radians, how far its gripper is open in metres, what it holds and how."""

    joints: JointsForm
    width: Number
    held: str | None
    grasp: PoseForm | None


class MomentForm(msgspec.Struct):
    """A state: the poses of objects, the arms by the names of their robots, how far furniture is open."""

    poses: dict[str, PoseForm]
    arms: dict[str, ArmForm]
    openings: dict[str, Number] | None = None


class WaypointForm(msgspec.Struct):
    """A configuration that the arm of a robot passes; `opening` is that of furniture that it holds."""

    name: str
    robot: str
    joints: JointsForm
    width: Number
    held: str | None
    opening: Number | None = None


class WitnessForm(msgspec.Struct):
    """A witness: moments, the waypoints from each to the next, the sizes that were drawn."""

    moments: list[MomentForm]
    motions: list[list[WaypointForm]]
    sizes: dict[str, Triple] | None = None


class _OldMoment(ArmForm):
    """A state in the form before: the arm that has acted, and the others."""

    poses: dict[str, PoseForm]
    robot: str | None = None
    others: dict[str, ArmForm] | None = None
    openings: dict[str, Number] | None = None


class _OldWaypoint(msgspec.Struct):
    """A waypoint in the form before; that of a single robot has no name."""

    name: str
    joints: JointsForm
    width: Number
    held: str | None
    opening: Number | None = None
    robot: str | None = None


class _OldWitness(msgspec.Struct):
    """A witness in the form before."""

    moments: list[_OldMoment]
    motions: list[list[_OldWaypoint]]
    sizes: dict[str, Triple] | None = None


def witness_form(data: object, name: str, robot: str) -> WitnessForm:
    """Return the parts of a witness, `robot` the name of the only one of the form before; `name` begins paths.

    Raises:
        QueryError: the data are of another form; the message names the field by its path.
    """
    version = data.get("version") if isinstance(data, Mapping) else None
    if version is None:
        return _upgraded(read(data, _OldWitness, name), robot)
    if type(version) is not int or version != VERSION:
        raise QueryError(f"{name}.version: needs {VERSION}; got {shown(version)}")
    return read(data, WitnessForm, name)


def _upgraded(old: _OldWitness, robot: str) -> WitnessForm:
    """Return a witness of the form before in that of today."""
    moments = [
        MomentForm(
            each.poses,
            {each.robot or robot: ArmForm(each.joints, each.width, each.held, each.grasp), **(each.others or {})},
            each.openings,
        )
        for each in old.moments
    ]
    motions = [
        [WaypointForm(at.name, at.robot or robot, at.joints, at.width, at.held, at.opening) for at in motion]
        for motion in old.motions
    ]
    return WitnessForm(moments, motions, old.sizes)
