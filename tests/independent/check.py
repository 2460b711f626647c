"""Say what is wrong with the witness of a task, both as they stand in a file of JSON lines."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from tests.independent.moments import Moment, broken, read, state_problems
from tests.independent.motions import TRANSIT, Stops, motion_problems, unfit
from tests.independent.relations import holds
from tests.independent.world import World


def problems(task: Mapping[str, Any], witness: Mapping[str, Any], world: World, ways: bool | None = None) -> list[str]:
    """Return what is wrong with a witness, nothing where it passes.

    The straight ways in joint space between waypoints are followed where `ways` is set, or where the witness has
    waypoints on the way. Without them a witness does not claim that they are free.
    """
    states = [task["initial"], *task["states"]]
    if len(witness["moments"]) != len(states) or len(witness["motions"]) != len(task["actions"]):
        return ["states or motions are missing"]
    named = {name for state in states for fluent in state for name in terms(fluent)[1:] if name in world.parts}
    for data in witness["moments"]:
        wrong = list(broken(data, named, world))
        if wrong:
            return wrong
    if any(unfit(motion, world) for motion in witness["motions"]):
        return ["a motion is empty, or beyond the limits of the arm"]
    moments = [read(data, world) for data in witness["moments"]]
    if any(moment.layout.poses.keys() != moments[0].layout.poses.keys() for moment in moments):
        return ["a body comes or goes"]
    if ways is None:
        ways = any(waypoint["name"] == TRANSIT for motion in witness["motions"] for waypoint in motion)
    found = []
    for k, moment in enumerate(moments):
        wrong = [*_facts(states[k], moment), *state_problems(moment, moments[k - 1] if k else None)]
        found += [f"state {k}: {text}" for text in wrong]
    stops: Stops = {}
    for k, motion in enumerate(witness["motions"]):
        wrong = list(motion_problems(motion, moments[k], moments[k + 1], stops, ways))
        found += [f"action {k + 1}: {text}" for text in wrong]
    return found


def terms(fluent: str) -> list[str]:
    """Return the name of a fluent and its arguments."""
    name, _, inner = fluent.partition("(")
    return [name, *re.findall(r"[^,()]+(?:\([^()]*\))?", inner[:-1])]


def _facts(state: Mapping[str, bool], moment: Moment) -> Iterator[str]:
    """Yield the fluents of a state that are otherwise."""
    seen, world = moment.seen(), moment.world
    for fluent, value in state.items():
        name, *arguments = terms(fluent)
        meaning = world.meaning(name)
        if meaning is not None and not holds(seen, meaning, arguments, value):
            yield f"{fluent} is not {str(value).lower()}"
        if meaning == "holding":
            held = moment.hands[arguments[0]].held
            if (held == arguments[1]) != value:
                yield f"{fluent} is {str(value).lower()}, and the gripper holds {held}"
