"""Follow the arms from one state of a witness to the next: bodies move only as grippers and handles take them along."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tests.independent.collisions import overlapping
from tests.independent.frames import Frame, moved
from tests.independent.moments import Hand, Moment, arm_problems, at_handle, same
from tests.independent.relations import holds
from tests.independent.statics import riders
from tests.independent.tolerances import ABOVE, FINE, HANDLE, MOVED, ROUNDING, RUNG, SLIDE, STRIDE, SWING
from tests.independent.world import World

Waypoint = Mapping[str, Any]
TRANSIT = "transit"

Stops = dict[str, tuple[str, Frame]]
"""The last waypoint of each robot, but for those on its ways, and where its tool is there."""


def unfit(motion: Sequence[Waypoint], world: World) -> bool:
    """Tell whether a motion is empty, or has a waypoint that no arm of the scene can take."""
    return not motion or not all(
        each["robot"] in world.robots and world.robots[each["robot"]].fits(each["joints"], float(each["width"]))
        for each in motion
    )


def motion_problems(
    motion: Sequence[Waypoint], before: Moment, after: Moment, stops: Stops, ways: bool
) -> Iterator[str]:
    """Yield what is wrong between two states, and note where the arms stop; `ways` are checked where they are given."""
    now = _loaded(before)
    for k, waypoint in enumerate(motion):
        robot, name = waypoint["robot"], waypoint["name"]
        last, here = stops.get(robot, ("", before.tool(robot)))
        found = list(_order(last, here, waypoint, now.world.robots[robot].tool(tuple(waypoint["joints"]))))
        steps = list(_steps(now, waypoint)) if ways else []
        found += _stride(now, waypoint) if ways and name != "pull" else []
        for step in steps:
            found += _touching(step, robot)
        reached = _moved(now, robot, waypoint)
        found += _handle(now, reached, robot, waypoint)
        now, more = _closed(now, reached, robot, waypoint)
        found += more
        if k < len(motion) - 1:
            found += _touching(now, robot)
        yield from (f"{name}: {text}" for text in dict.fromkeys(found))
        if name != TRANSIT:
            stops[robot] = name, now.tool(robot)
    yield from _end(now, after)


def _loaded(moment: Moment) -> Moment:
    """Return a moment with what goes along with what each arm holds."""
    hands = {
        name: hand if hand.held is None else replace(hand, load=_load(moment, hand.held, moment.tool(name)))
        for name, hand in moment.hands.items()
    }
    return replace(moment, hands=hands)


def _load(moment: Moment, carrier: str, frame: Frame) -> dict[str, Frame]:
    """Return the places in a frame of what goes along with a body."""
    inverse = frame.inverse()
    return {name: inverse @ moment.layout.poses[name] for name in riders(moment.layout, carrier)}


def _moved(now: Moment, robot: str, waypoint: Waypoint, share: float = 1.0) -> Moment:
    """Return a moment with an arm all or part of its way to a waypoint, and what it holds and pulls moved along."""
    hand, layout = now.hands[robot], now.layout
    goal = np.array(waypoint["joints"])
    joints = tuple((hand.joints + share * (goal - hand.joints)).tolist()) if share < 1.0 else tuple(waypoint["joints"])
    moved = replace(hand, joints=joints, width=waypoint["width"])
    if hand.held is not None and hand.held in now.world.furniture:
        if waypoint["held"] == hand.held:
            opening = layout.openings[hand.held] + share * (waypoint["opening"] - layout.openings[hand.held])
            layout = layout.opened(hand.held, opening, hand.load)
    elif hand.held is not None and hand.grip is not None:
        layout = layout.carried({**hand.load, hand.held: hand.grip}, now.world.robots[robot].tool(joints))
    return now.with_hand(robot, moved, layout)


def _closed(now: Moment, reached: Moment, robot: str, waypoint: Waypoint) -> tuple[Moment, list[str]]:
    """Return a moment after the gripper has taken or let go what the waypoint says, and what is wrong with that."""
    hand, held, found = reached.hands[robot], waypoint["held"], []
    if held == hand.held:
        if held is not None and hand.width != now.hands[robot].width:
            found.append(f"the gripper opens or closes around {held}")
        return reached, found
    if not same(now.tool(robot), reached.tool(robot)):
        found.append("the gripper closes or opens on the way")
    if held is None:
        return reached.with_hand(robot, Hand(hand.joints, hand.width)), found
    if held not in reached.layout.poses or hand.held is not None:
        return reached, [*found, f"the gripper takes {held} while it holds {hand.held}"]
    tool = reached.tool(robot)
    if held in reached.world.furniture:
        joint = reached.layout.joint(held)
        grip, load = joint.inverse() @ tool, _load(reached, held, joint)
    else:
        grip, load = tool.inverse() @ reached.layout.poses[held], _load(reached, held, tool)
        if not holds(reached.seen(), "holding", (robot, held), True):
            found.append(f"the gripper does not grip {held}")
    return reached.with_hand(robot, Hand(hand.joints, hand.width, held, grip, load)), found


def _handle(now: Moment, reached: Moment, robot: str, waypoint: Waypoint) -> Iterator[str]:
    """Yield what is wrong with the handle that a gripper holds, and that two hold what one of them moves."""
    hand, opening = now.hands[robot], waypoint.get("opening")
    moves = not same(now.tool(robot), reached.tool(robot))
    if (
        moves
        and hand.held is not None
        and hand.held in {now.hands[other].held for other in now.hands if other != robot}
    ):
        yield f"{hand.held} is held by two, and moves"
    name = waypoint["held"]
    if (name in now.world.furniture) != (opening is not None):
        yield "an opening goes with the handle of furniture"
        return
    if opening is None:
        return
    furniture = now.world.furniture[name]
    if not np.isfinite(opening) or at_handle(reached, robot) != name or abs(waypoint["width"] - 0.022) > HANDLE:
        yield f"the gripper does not hold the handle of {name}"
    far = abs(opening - now.layout.openings[name])
    if far > (0.0 if hand.held != name else SLIDE if furniture.slides else SWING) + ROUNDING:
        yield f"{name} leaps"
    grip = reached.layout.joint(name).inverse() @ reached.tool(robot)
    if hand.held == name and hand.grip is not None and hand.grip.offset(grip)[1] > HANDLE:
        yield f"the gripper turns on the handle of {name}"


def _order(last: str, here: Frame, waypoint: Waypoint, there: Frame) -> Iterator[str]:
    """Yield that a gripper does not come straight to where it acts, or straight from there: vertically or as it points.

    Whether it is down in the first state is not known: no waypoint has led there.
    """
    name, stays = waypoint["name"], same(here, there)
    if name == "at" and not stays and (last != "approach" or not _straight_off(here, there)):
        yield "it does not come from straight above"
    if name in ("lift", "retreat") and not _straight_off(there, here):
        yield "it does not leave straight up"
    if last == "at" and not stays and name not in ("lift", "retreat", "pull", TRANSIT):
        yield "it leaves to the side"


def _straight_off(off: Frame, low: Frame) -> bool:
    """Tell whether one place of a tool is straight above another, or as far back along its fingers."""
    return same(off, low.raised(ABOVE)) or same(off, low @ moved(0.0, 0.0, -ABOVE))


def _steps(now: Moment, waypoint: Waypoint) -> Iterator[Moment]:
    """Yield what is where on the straight way in joint space to a waypoint, without its ends."""
    robot = waypoint["robot"]
    far = np.abs(np.subtract(waypoint["joints"], now.hands[robot].joints)).max()
    count = int(np.ceil(far / FINE))
    for k in range(1, count):
        yield _moved(now, robot, waypoint, k / count)


def _stride(now: Moment, waypoint: Waypoint) -> Iterator[str]:
    """Yield that there is a gap in the way of an arm."""
    robot = waypoint["robot"]
    far = float(np.abs(np.subtract(waypoint["joints"], now.hands[robot].joints)).max())
    here, there = now.tool(robot), now.world.robots[robot].tool(tuple(waypoint["joints"]))
    up = abs(float(there.at[2] - here.at[2]))
    way = there.at - here.at
    aslant = np.linalg.norm(way - (way @ here.turn[:, 2]) * here.turn[:, 2]) <= 10 * MOVED
    straight = (np.abs(way)[:2].max() <= 10 * MOVED and up <= RUNG) or (aslant and np.linalg.norm(way) <= RUNG)
    if far > STRIDE and not straight:
        yield f"the way leaps by {far:.2f} rad"


def _touching(now: Moment, robot: str) -> list[str]:
    """Return what an arm that acts is in, and what that is in which it moves."""
    hand = now.hands[robot]
    found = list(arm_problems(now, robot))
    if hand.held is not None:
        moving = [hand.held, *sorted(hand.load)]
        found += overlapping(now.layout, moving)
        for name, other in now.hands.items():
            if name != robot:
                touched = () if other.held is None else (other.held,)
                hit = now.arm(name).in_bodies(now.layout, moving, touched, None)
                found += [f"{body} is in the arm of {name}" for body in hit]
    return found


def _end(now: Moment, after: Moment) -> Iterator[str]:
    """Yield what is otherwise in the next state than where the arms have brought it."""
    for name, hand in after.hands.items():
        own = now.hands[name]
        if (own.joints, own.width, own.held) != (hand.joints, hand.width, hand.held):
            yield "it does not end where the next state begins"
        elif own.grip is not None and hand.grip is not None and not same(own.grip, hand.grip):
            yield f"{hand.held} slips in the gripper"
    for name, pose in after.layout.poses.items():
        if not same(now.layout.poses[name], pose):
            yield f"{name} is not where it has been left"
    for name, opening in after.layout.openings.items():
        if abs(now.layout.openings[name] - opening) > ROUNDING:
            yield f"{name} is not open as it has been left"
