"""Check how an arm comes to where it takes an object or lets it go, and how it leaves: from straight above."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from typing import NamedTuple

from prag_asp.physics.geometry import Pose
from prag_asp.physics.robot import Joints
from prag_asp.physics.search.grasping import LIFT
from prag_asp.physics.verdict import TRANSIT, Moment, Waypoint
from prag_asp.physics.witness.states import near, situation_of, tool_in, visited
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import contacts


class Stop(NamedTuple):
    """Where an arm stands for a while: its tool, and whether it takes or lets go of something there."""

    tool: Pose
    handles: bool


def approach_problems(motion: Sequence[Waypoint], before: Moment, after: Moment, simulator: Simulator) -> Iterator[str]:
    """Yield where an arm takes or lets go on its way, and where it comes or goes otherwise than from straight above.

    Motions that open furniture are left out: they follow a handle.
    """
    if any(waypoint.opening is not None for waypoint in motion):
        return
    for robot, arm in before.arms().items():
        held, joints = arm.held, arm.joints
        passed = [(arm.joints, False)]
        for waypoint in motion:
            if waypoint.robot != robot or waypoint.name == TRANSIT:
                continue
            if waypoint.held != held and waypoint.joints != joints:
                yield f"{waypoint.name}: it takes or lets go of {waypoint.held or held} on its way"
                return
            passed.append((waypoint.joints, waypoint.held != held))
            held, joints = waypoint.held, waypoint.joints
        yield from _not_above(_stops(passed, robot, (before, after), simulator))


def _stops(
    passed: Sequence[tuple[Joints, bool]], robot: str, ends: tuple[Moment, Moment], simulator: Simulator
) -> list[Stop]:
    """Return the stops of an arm, one for all waypoints at the same joints; the ends may be at objects, too."""
    stops = []
    for joints, several in groupby(passed, key=lambda each: each[0]):
        simulator.turn_to(robot)
        simulator.pose_arm(joints, 0.0)
        stops.append(Stop(tool_in(simulator), any(handles for _, handles in several)))
    for k, moment in ((0, ends[0]), (-1, ends[1])):
        arms = moment.arms()
        own = situation_of(simulator, moment.poses, moment.openings, arms, robot)
        held = arms[robot].held
        down = visited(own) is not None if held is None else contacts(own, held, moment.poses)
        if down:
            stops[k] = stops[k]._replace(handles=True)
    return stops


def _not_above(stops: Sequence[Stop]) -> Iterator[str]:
    """Yield the stops next to one at an object that are not straight above it."""
    for one, two in pairwise(stops):
        if one.handles and not straight_above(two.tool, one.tool):
            yield f"it does not leave by {LIFT * 100:.0f} cm straight up"
        if two.handles and not straight_above(one.tool, two.tool):
            yield f"it does not come down by {LIFT * 100:.0f} cm straight onto the object"


def straight_above(high: Pose, low: Pose) -> bool:
    """Tell whether one pose of the tool is `LIFT` straight above another."""
    x, y, z = low.position
    return near(high, Pose((x, y, z + LIFT), low.quaternion))
