"""Check how an arm grasps and releases: where the object is, and that it approaches and retreats straight above.

The names of waypoints are not trusted except for `TRANSIT`, and on its way an arm neither takes, lets go nor
stays.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from typing import NamedTuple

from prag_asp.physics.checks.states import POSITION_TOLERANCE, near, situation_of
from prag_asp.physics.predicates import Gripper
from prag_asp.physics.search.grasping import LIFT
from prag_asp.physics.symbolic_facts import Fact, of_robot
from prag_asp.physics.witness import TRANSIT, Moment, Waypoint
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import contacts
from prag_asp.scene.geometry import Pose, compose
from prag_asp.scene.robots import Joints


class Stop(NamedTuple):
    """A stop of an arm: its joints and tool, whether it is at an object there, whether it pulls a handle."""

    joints: Joints
    tool: Pose
    down: bool
    pulls: bool = False


class End(NamedTuple):
    """A state at an end of a motion, with its facts."""

    moment: Moment
    facts: Sequence[Fact]


def approach_problems(
    motion: Sequence[Waypoint], tools: Sequence[Pose], before: End, after: End, simulator: Simulator
) -> Iterator[str]:
    """Yield grasps and releases of objects that are elsewhere, and motions that are not straight above an object.

    `tools` are the poses of the tool at the waypoints.
    """
    for robot, arm in before.moment.arms.items():
        own = [each for each in zip(motion, tools, strict=True) if each[0].robot == robot]
        if own and own[-1][0].name == TRANSIT:
            yield "it ends on its way"
            return
        stops = [_end(before, robot, simulator)]
        held, joints = arm.held, arm.joints
        for waypoint, tool in own:
            changes = waypoint.held != held
            if changes and (waypoint.joints != joints or waypoint.name == TRANSIT):
                yield f"{waypoint.name}: it takes or lets go of {waypoint.held or held} on its way"
                return
            if changes:
                yield from _misplaced(waypoint, tool, held, before.moment, after.moment)
            if _loose(waypoint, before.moment, after.moment):
                yield f"{waypoint.name}: the gripper does not close around {waypoint.held}"
            if waypoint.name != TRANSIT:
                stops.append(Stop(waypoint.joints, tool, changes, waypoint.opening is not None))
            held, joints = waypoint.held, waypoint.joints
        yield from _not_above([*stops, _end(after, robot, simulator)])


def _end(end: End, robot: str, simulator: Simulator) -> Stop:
    """Return the stop of an arm in a state; it is down at an object by a fact, or with a held object on a support."""
    situation = situation_of(simulator, end.moment.poses, end.moment.openings, end.moment.arms)
    arm = end.moment.arms[robot]
    if arm.held is not None:
        down = bool(contacts(situation, arm.held, end.moment.poses))
    else:
        down = any(fact.value and fact.predicate.gripper is Gripper.AT for fact in of_robot(end.facts, robot))
    return Stop(arm.joints, situation.tool(robot), down)


def _misplaced(waypoint: Waypoint, tool: Pose, held: str | None, before: Moment, after: Moment) -> Iterator[str]:
    """Yield that an object is not where it is grasped, or does not end where it is released; handles are left out."""
    taking = waypoint.held is not None
    entity, arm = (waypoint.held, after.arms[waypoint.robot]) if taking else (held, before.arms[waypoint.robot])
    if waypoint.opening is not None or entity is None or arm.held != entity or arm.grasp is None:
        return
    if not near(compose(tool, arm.grasp), (before if taking else after).poses[entity]):
        yield f"{waypoint.name}: {entity} is not where the gripper {'takes it' if taking else 'lets it go'}"


def _loose(waypoint: Waypoint, before: Moment, after: Moment) -> bool:
    """Return whether the opening of the gripper differs from that in the states in which it holds the same object."""
    arms = [moment.arms[waypoint.robot] for moment in (before, after)]
    widths = [arm.width for arm in arms if arm.held is not None and arm.held == waypoint.held]
    return bool(widths) and min(abs(waypoint.width - width) for width in widths) > POSITION_TOLERANCE


def _not_above(passed: Sequence[Stop]) -> Iterator[str]:
    """Yield the stops before and after one at an object that are not straight above it, except along a handle."""
    stops = []
    for _, same in groupby(passed, key=lambda stop: stop.joints):
        together = list(same)
        down, pulls = (any(getattr(stop, name) for stop in together) for name in ("down", "pulls"))
        stops.append(together[0]._replace(down=down, pulls=pulls))
    for one, two in pairwise(stops):
        if one.pulls and two.pulls:
            continue
        if one.down and not _straight_above(two.tool, one.tool):
            yield f"it does not leave by {LIFT * 100:.0f} cm straight up"
        if two.down and not _straight_above(one.tool, two.tool):
            yield f"it does not come down by {LIFT * 100:.0f} cm straight onto the object"


def _straight_above(high: Pose, low: Pose) -> bool:
    """Return whether one pose of the tool is `LIFT` straight above another."""
    x, y, z = low.position
    return near(high, Pose((x, y, z + LIFT), low.quaternion))
