"""Check how an arm grasps and releases: the object is at the gripper, and the approach and retreat are straight.

Names of waypoints are not trusted, except for `TRANSIT`: in transit, an arm must not grasp, release or stop.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from typing import NamedTuple

from prag_asp.physics.checks.states import POSITION_TOLERANCE, near, situation_of
from prag_asp.physics.predicates import Gripper
from prag_asp.physics.search.grasping import LIFT, backed
from prag_asp.physics.symbolic_facts import Fact, of_robot
from prag_asp.physics.witness import TRANSIT, Moment, Waypoint
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import contacts
from prag_asp.scene.geometry import Pose, compose, raised
from prag_asp.scene.robots import Joints


class Stop(NamedTuple):
    """A stop of an arm: its joints, the pose of its tool, whether it is at an object, and whether it pulls a handle."""

    joints: Joints
    tool: Pose
    down: bool
    pulls: bool = False


class End(NamedTuple):
    """The state before or after a motion, with its facts."""

    moment: Moment
    facts: Sequence[Fact]


def approach_problems(
    motion: Sequence[Waypoint], tools: Sequence[Pose], before: End, after: End, simulator: Simulator
) -> Iterator[str]:
    """Yield grasps and releases of objects that are not at the gripper, and curved motions to or from an object.

    `tools` are the poses of the tool at the waypoints. `handling_problems` checks how handles are gripped.
    """
    for robot, arm in before.moment.arms.items():
        arms = (arm, after.moment.arms[robot])
        own = [each for each in zip(motion, tools, strict=True) if each[0].robot == robot]
        if own and own[-1][0].name == TRANSIT:
            yield "it ends in transit"
            return
        stops = [_end(before, robot, simulator)]
        held, joints = arm.held, arm.joints
        for waypoint, tool in own:
            changes, taking = waypoint.held != held, waypoint.held is not None
            entity = waypoint.held if taking else held
            if changes and (waypoint.joints != joints or waypoint.name == TRANSIT):
                yield f"{waypoint.name}: it grasps or releases {entity} in transit"
                return
            owner = arms[1] if taking else arms[0]
            if changes and waypoint.opening is None and entity is not None and owner.held == entity and owner.grasp:
                poses = before.moment.poses if taking else after.moment.poses
                if not near(compose(tool, owner.grasp), poses[entity]):
                    does = "takes it" if taking else "lets it go"
                    yield f"{waypoint.name}: {entity} is not where the gripper {does}"
            widths = [each.width for each in arms if each.held is not None and each.held == waypoint.held]
            if widths and min(abs(waypoint.width - width) for width in widths) > POSITION_TOLERANCE:
                yield f"{waypoint.name}: the gripper does not close around {waypoint.held}"
            if waypoint.name != TRANSIT:
                stops.append(Stop(waypoint.joints, tool, changes, waypoint.opening is not None))
            held, joints = waypoint.held, waypoint.joints
        yield from _not_above([*stops, _end(after, robot, simulator)])


def _end(end: End, robot: str, simulator: Simulator) -> Stop:
    """Return the stop of an arm in a state.

    The arm is at an object if a fact says so, or if the object that it holds is supported.
    """
    situation = situation_of(simulator, end.moment.poses, end.moment.openings, end.moment.arms)
    arm = end.moment.arms[robot]
    if arm.held is not None:
        down = bool(contacts(situation, arm.held, end.moment.poses))
    else:
        down = any(fact.value and fact.predicate.gripper is Gripper.AT for fact in of_robot(end.facts, robot))
    return Stop(arm.joints, situation.tool(robot), down)


def _not_above(passed: Sequence[Stop]) -> Iterator[str]:
    """Yield approaches to an object and retreats from it that are not straight, except while a handle is pulled."""
    stops = []
    for _, same in groupby(passed, key=lambda stop: stop.joints):
        together = list(same)
        down, pulls = (any(getattr(stop, name) for stop in together) for name in ("down", "pulls"))
        stops.append(together[0]._replace(down=down, pulls=pulls))
    for one, two in pairwise(stops):
        if one.pulls and two.pulls:
            continue
        if one.down and not _straight_off(two.tool, one.tool):
            yield f"it does not retreat straight by {LIFT * 100:.0f} cm"
        if two.down and not _straight_off(one.tool, two.tool):
            yield f"it does not approach the object straight by {LIFT * 100:.0f} cm"


def _straight_off(off: Pose, low: Pose) -> bool:
    """Return whether a tool pose is `LIFT` metres straight above another, or that far behind it along the fingers."""
    return near(off, raised(low, LIFT)) or near(off, backed(low))
