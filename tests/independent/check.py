"""Say what is wrong with the witness of a task, both as they stand in a file of JSON lines."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, pairwise
from typing import Any, NamedTuple

import numpy as np

from tests.independent import panda
from tests.independent.convex import clearance, depth
from tests.independent.relations import Seen, holds
from tests.independent.statics import falling, riders
from tests.independent.world import Array, Frame, World, box, frame, sound

DEEPEST = 0.00155
"""Metres by which bodies may be in each other: PyBullet's own margins make up what is beyond 1.5 mm."""

MOVED, TURNED = 1e-4, 1e-3
"""Metres and radians by which a body may be off the place where it has to be."""

ABOVE = 0.10
ROUNDING = 1e-9


class Moment(NamedTuple):
    """One state of a witness, or the arm and the bodies at one of its waypoints."""

    poses: Mapping[str, Frame]
    joints: tuple[float, ...]
    width: float
    held: str | None
    grasp: Frame | None = None


def problems(task: Mapping[str, Any], witness: Mapping[str, Any], world: World) -> list[str]:
    """Return what is wrong with a witness, nothing where it passes."""
    states = [task["initial"], *task["states"]]
    if len(witness["moments"]) != len(states) or len(witness["motions"]) != len(task["actions"]):
        return ["states or motions are missing"]
    named = {name for state in states for fluent in state for name in _terms(fluent)[1:] if name in world.parts}
    for data in witness["moments"]:
        broken = list(_broken(data, named, world))
        if broken:
            return broken
    for motion in witness["motions"]:
        if not motion or any(not _arm_fits(waypoint) for waypoint in motion):
            return ["a motion is empty, or beyond the limits of the arm"]
    moments = [_moment(data) for data in witness["moments"]]
    found = [f"state {k}: {text}" for k in range(len(states)) for text in _state(states[k], moments, k, world)]
    for k, motion in enumerate(witness["motions"]):
        found += [f"action {k + 1}: {text}" for text in _motion(motion, moments[k], moments[k + 1], world)]
    return found


def _terms(fluent: str) -> list[str]:
    """Return the name of a fluent and its arguments."""
    name, _, inner = fluent.partition("(")
    return [name, *re.findall(r"[^,()]+(?:\([^()]*\))?", inner[:-1])]


def _broken(data: Mapping[str, Any], named: set[str], world: World) -> Iterator[str]:
    """Yield what cannot even be computed with."""
    if not named <= set(data["poses"]) <= set(world.parts):
        yield "a body is missing, or is not in the scene"
    if not all(sound(pose) for pose in data["poses"].values()):
        yield "a pose is not a finite place and rotation"
    if not _arm_fits(data):
        yield "the arm or the gripper is beyond its limits"
    if (data["held"] is None) != (data["grasp"] is None) or (data["held"] or next(iter(named), "")) not in data[
        "poses"
    ]:
        yield "the held body and its grasp do not go together"
    elif data["grasp"] is not None and not sound(data["grasp"]):
        yield "the grasp is not a finite place and rotation"


def _arm_fits(data: Mapping[str, Any]) -> bool:
    """Tell whether joints and gripper are within their limits; what is no number is not."""
    joints, width = np.array(data["joints"], dtype=float), float(data["width"])
    if joints.shape != (7,):
        return False
    within = (joints >= panda.LOWER - ROUNDING) & (joints <= panda.UPPER + ROUNDING)
    return bool(within.all() and -ROUNDING <= width <= panda.OPENING + ROUNDING)


def _moment(data: Mapping[str, Any]) -> Moment:
    poses = {name: frame(pose) for name, pose in data["poses"].items()}
    grasp = None if data["grasp"] is None else frame(data["grasp"])
    return Moment(poses, tuple(data["joints"]), data["width"], data["held"], grasp)


def _state(state: Mapping[str, bool], moments: Sequence[Moment], k: int, world: World) -> Iterator[str]:
    """Yield what is wrong with one state."""
    moment = moments[k]
    seen = Seen(world, moment.poses, panda.tool(moment.joints), moment.width)
    for fluent, value in state.items():
        name, *arguments = _terms(fluent)
        meaning = world.meaning(name)
        if meaning is not None and not holds(seen, meaning, arguments, value):
            yield f"{fluent} is not {str(value).lower()}"
        if meaning == "holding" and (moment.held == arguments[1]) != value:
            yield f"{fluent} is {str(value).lower()}, and the gripper holds {moment.held}"
    yield from _bodies(moment, moments[k - 1] if k else None, world)
    yield from _arm(moment, world, _visited(seen))
    if moment.held is not None and moment.grasp is not None:
        if not _same(seen.tool @ moment.grasp, moment.poses[moment.held]):
            yield f"{moment.held} is not where the gripper holds it"
        if not holds(seen, "holding", ("", moment.held), True):
            yield f"the gripper does not grip {moment.held}"


def _visited(seen: Seen) -> str | None:
    """Return the body that the gripper is at, and that its fingers may touch."""
    return next((name for name in seen.poses if holds(seen, "at", ("", name), True)), None)


def _same(one: Frame, two: Frame) -> bool:
    moved, turned = one.offset(two)
    return moved <= MOVED and turned <= TURNED


def _bodies(moment: Moment, before: Moment | None, world: World) -> Iterator[str]:
    """Yield bodies that are in each other or in the table, and one that falls; `before` is known to be told already."""
    poses = moment.poses
    if before is not None and before.held in (None, moment.held) and _all_same(before.poses, poses):
        return
    for one, two in combinations(poses, 2):
        if _overlap(one, two, poses, world):
            yield f"{one} and {two} are in each other"
    for name, pose in poses.items():
        if _in_table(name, pose, world):
            yield f"{name} is in the table"
    body = falling(world, poses, moment.held)
    if body is not None:
        yield f"{body} falls"


def _all_same(one: Mapping[str, Frame], two: Mapping[str, Frame]) -> bool:
    return all((one[name].at == two[name].at).all() and (one[name].turn == two[name].turn).all() for name in one)


def _overlap(one: str, two: str, poses: Mapping[str, Frame], world: World) -> bool:
    """Tell whether two bodies are deeper in each other than they may be."""
    first, second = poses[one], poses[two]
    apart = np.abs(first.at - second.at) - box(world, one, first.turn) - box(world, two, second.turn)
    if apart.max() > 0.0:
        return False
    pairs = ((a, b) for a in world.parts[one] for b in world.parts[two])
    return any(depth(a, first, b, second, DEEPEST) > DEEPEST for a, b in pairs)


def _in_table(name: str, pose: Frame, world: World) -> bool:
    """Tell whether a body over the table is lower than its top; its foot is taken to be all below its centre."""
    centre, half = world.table
    over = (np.abs(pose.at[:2] - centre) <= half).all()
    return bool(over and pose.at[2] - box(world, name, pose.turn)[2] < -DEEPEST)


def _arm(moment: Moment, world: World, visited: str | None) -> Iterator[str]:
    """Yield what the arm is in; its fingers may touch what it holds or visits."""
    centres = panda.balls(moment.joints, moment.width)
    moving = panda.OWNERS > 0
    low = moving & (centres[:, 2] - panda.RADII < -DEEPEST)
    middle, half = world.table
    if (low & (np.abs(centres[:, :2] - middle) <= half).all(axis=1)).any():
        yield "the arm is in the table"
    for name, pose in moment.poses.items():
        near = ((centres - pose.at) ** 2).sum(axis=1) <= (panda.RADII + np.linalg.norm(world.halves[name])) ** 2
        if name in (moment.held, visited):
            near &= panda.OWNERS <= panda.HAND
        if near.any() and _meets(world, name, pose, centres[near], panda.RADII[near]):
            yield f"the arm is in {name}"
    one, two = panda.APART
    if (((centres[one] - centres[two]) ** 2).sum(axis=1) < (panda.TOUCHING - DEEPEST) ** 2).any():
        yield "the arm is in itself"


def _meets(world: World, name: str, pose: Frame, centres: Array, radii: Array) -> bool:
    """Tell whether a ball is deeper in a body than it may be."""
    return any((clearance(part, pose, centres) - radii).min() < -DEEPEST for part in world.parts[name])


def _motion(motion: Sequence[Mapping[str, Any]], before: Moment, after: Moment, world: World) -> Iterator[str]:
    """Yield what is wrong between two states."""
    last = motion[-1]
    if (tuple(last["joints"]), last["width"], last["held"]) != (after.joints, after.width, after.held):
        yield "it does not end where the next state begins"
    carriers = {name for name in (before.held, after.held) if name is not None}
    loads = {carrier: riders(world, before.poses, carrier) for carrier in carriers}
    yield from _strays(before, after, loads, world)
    yield from _hand_over(motion, before, after)
    for one, two in pairwise(motion):
        if (one["name"], two["name"]) == ("approach", "at") and not _straight_above(one, two):
            yield "it does not approach from straight above"
    for waypoint in motion[:-1]:
        name, shown = waypoint["name"], _on_the_way(waypoint, before, after, loads)
        seen = Seen(world, shown.poses, panda.tool(shown.joints), shown.width)
        yield from (f"{name}: {text}" for text in _arm(shown, world, _visited(seen)))
        if shown.held is not None:
            for other in shown.poses:
                if other != shown.held and _overlap(shown.held, other, shown.poses, world):
                    yield f"{name}: {shown.held} and {other} are in each other"


def _strays(before: Moment, after: Moment, loads: Mapping[str, set[str]], world: World) -> Iterator[str]:
    """Yield bodies that have moved though the gripper had neither them nor what they stand on."""
    for name in before.poses:
        if _same(before.poses[name], after.poses[name]):
            continue
        if name in world.fixed:
            yield f"{name} is fixed, and has moved"
        elif name not in loads and not any(
            name in load and _rides_along(name, carrier, before, after) for carrier, load in loads.items()
        ):
            yield f"{name} has moved by itself"


def _rides_along(name: str, carrier: str, before: Moment, after: Moment) -> bool:
    """Tell whether a body has moved as one with what carries it."""
    one, two = (moment.poses[carrier].inverse() @ moment.poses[name] for moment in (before, after))
    return _same(one, two)


def _hand_over(motion: Sequence[Mapping[str, Any]], before: Moment, after: Moment) -> Iterator[str]:
    """Yield what is wrong where the gripper takes, holds or lets go: a body never jumps into or out of it."""
    held = [before.held, *(waypoint["held"] for waypoint in motion)]
    for k, (one, two) in enumerate(pairwise(held)):
        if one == two:
            continue
        # The gripper closes and opens where it is: at this waypoint and at the one before.
        at = panda.tool(motion[k]["joints"])
        if k > 0 and not _same(at, panda.tool(motion[k - 1]["joints"])):
            yield "the gripper closes or opens on the way"
        if two is not None and (one is not None or two != after.held or after.grasp is None):
            yield f"the gripper takes {two} while it holds {one}"
        elif two is not None and after.grasp is not None and not _same(at @ after.grasp, before.poses[two]):
            yield f"{two} jumps into the gripper"
        elif one is not None and (before.grasp is None or not _same(at @ before.grasp, after.poses[one])):
            yield f"{one} jumps out of the gripper"
    if before.held is not None and set(held) == {before.held}:
        if before.grasp is None or after.grasp is None or not _same(before.grasp, after.grasp):
            yield f"{before.held} slips in the gripper"
        if len({before.width, *(waypoint["width"] for waypoint in motion)}) > 1:
            yield "the gripper opens or closes around what it holds"


def _straight_above(high: Mapping[str, Any], low: Mapping[str, Any]) -> bool:
    above, below = panda.tool(high["joints"]), panda.tool(low["joints"])
    return _same(above, Frame(below.turn, below.at + np.array([0.0, 0.0, ABOVE])))


def _on_the_way(waypoint: Mapping[str, Any], before: Moment, after: Moment, loads: Mapping[str, set[str]]) -> Moment:
    """Return what is where at a waypoint."""
    joints, held = tuple(waypoint["joints"]), waypoint["held"]
    poses = dict(after.poses if held is None and before.held is not None else before.poses)
    grasp = before.grasp if held == before.held else after.grasp
    if held is not None and grasp is not None:
        carried = panda.tool(joints) @ grasp
        shift = carried @ before.poses[held].inverse()
        for rider in loads[held]:
            poses[rider] = shift @ poses[rider]
        poses[held] = carried
    return Moment(poses, joints, waypoint["width"], held, grasp)
