"""The counts of the two arms, by a simulation of all scenes that they may begin in, from the description in words."""

from __future__ import annotations

import itertools
from collections.abc import Hashable
from functools import cache
from typing import NamedTuple

import pytest

from prag_asp.program.paths import shipped_domains
from tests.known_counts import check_known_counts
from tests.simulation import Act, Simulation, Word

ARMS = {"left": "right", "right": "left"}
SIDE = {"left": "left_side", "right": "right_side"}
ZONES = ("left_side", "middle", "right_side")
BARS = ("bar_1", "bar_2")
OBJECTS = (*BARS, "plank_1")


class Scene(NamedTuple):
    """Over which zone each arm is, which ones are empty, and where each object lies or which arm holds it, if any."""

    over: tuple[str | None, ...]
    empty: tuple[bool, ...]
    objects: tuple[str | None, ...]


def scenes() -> frozenset[Scene]:
    """Return all scenes: an arm holds one object at most, and none if it is empty."""
    found = set()
    for left, right in itertools.product((None, "left_side", "middle"), (None, "middle", "right_side")):
        for objects in itertools.product((None, *ZONES, *ARMS), repeat=len(OBJECTS)):
            for empty in itertools.product((True, False), repeat=2):
                held = [objects.count(arm) for arm in ARMS]
                if all(number <= (0 if free else 1) for number, free in zip(held, empty, strict=True)):
                    found.add(Scene((left, right), empty, objects))
    return frozenset(found)


def changed(scene: Scene, action: Act) -> Scene | None:
    """Return a scene after an action, None where the arm cannot do it."""
    name, arm, *rest = action
    me = list(ARMS).index(arm)
    over, empty, objects = list(scene.over), list(scene.empty), list(scene.objects)
    if name == "move":
        if over[me] in (None, rest[0]):
            return None
        over[me] = rest[0]
    elif name == "give":
        other, thing = rest[0], OBJECTS.index(rest[1])
        if over != ["middle", "middle"] or objects[thing] != arm or not empty[1 - me]:
            return None
        objects[thing] = other
        empty[me], empty[1 - me] = True, False
    else:
        thing, zone = OBJECTS.index(rest[0]), rest[1]
        before, after = (zone, arm) if name == "pick" else (arm, zone)
        if over[me] != zone or objects[thing] != before or (name == "pick" and not empty[me]):
            return None
        objects[thing] = after
        empty[me] = name == "place"
    return Scene(tuple(over), tuple(empty), tuple(objects))


@cache
def numbers() -> dict[Scene, int]:
    """Return a number for each scene: sets of numbers are built faster than sets of scenes."""
    return {scene: number for number, scene in enumerate(sorted(scenes(), key=repr))}


@cache
def changes(action: Act) -> dict[int, int]:
    """Return the scene after an action for each scene in which the arm can do it."""
    after = ((number, changed(scene, action)) for scene, number in numbers().items())
    return {number: numbers()[scene] for number, scene in after if scene is not None}


@cache
def step(state: Hashable, action: Act) -> frozenset[int] | None:
    """Return the scenes that remain possible after an action, None where there are none."""
    assert isinstance(state, frozenset)
    after = changes(action)
    return frozenset(after[number] for number in state & after.keys()) or None


def reach(arm: str) -> tuple[str, str]:
    return (SIDE[arm], "middle")


def handover(arm: str, other: str, thing: str) -> Word:
    meet = (("move", arm, "middle"), ("move", other, "middle"), ("give", arm, other, thing))
    return (*meet, ("move", arm, SIDE[arm]), ("move", other, SIDE[other]))


@cache
def two_arms() -> Simulation:
    moves = [(("move", arm, zone),) for arm in ARMS for zone in reach(arm)]
    transfers = [
        (("pick", arm, thing, start), ("move", arm, end), ("place", arm, thing, end))
        for arm in ARMS
        for thing in OBJECTS
        for start, end in itertools.permutations(reach(arm))
    ]
    handovers = {(a, b, thing): handover(a, b, thing) for a, b in ARMS.items() for thing in OBJECTS}
    across = [(("pick", a, o, SIDE[a]), *word, ("place", b, o, SIDE[b])) for (a, b, o), word in handovers.items()]
    units = (*moves, *transfers, *handovers.values(), *across)
    return Simulation(
        frozenset(numbers().values()), tuple(sorted({action for unit in units for action in unit})), step, units
    )


@pytest.mark.parametrize("level", ["plan", "task", "skeleton", "flat.plan", "flat.task", "flat.skeleton"])
def test_the_known_counts_are_those_of_the_simulation(level: str) -> None:
    check_known_counts(shipped_domains()["two_arms"], two_arms(), level, BARS, (*ARMS, *SIDE.values()))
