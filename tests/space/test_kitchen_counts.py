"""The counts of the kitchen, by a simulation of it from its description in words."""

from __future__ import annotations

from collections.abc import Hashable
from functools import cache
from typing import NamedTuple

import pytest

from prag_asp.program.paths import shipped_domains
from tests.known_counts import check_known_counts
from tests.simulation import Act, Simulation, Word

PLACES = ("drawer_1", "cupboard_1", "table_1", "bowl_1")
DOORS = ("drawer_1", "cupboard_1")
APPLES = ("apple_1", "apple_2")
ITEMS = (*APPLES, "cup_1")


class Kitchen(NamedTuple):
    """Which item the hand is at and whether it holds it, the open doors, and where the items are."""

    at: str | None
    holds: bool
    open: frozenset[str]
    located: tuple[str, ...]


START = Kitchen(None, False, frozenset(), ("drawer_1", "drawer_1", "cupboard_1"))


def step(state: Hashable, action: Act) -> Kitchen | None:
    """Return the kitchen after an action, None where the panda cannot do it."""
    assert isinstance(state, Kitchen)
    name, _, thing, *rest = action
    if name in ("open", "close"):
        fits = state.at is None and (thing in state.open) == (name == "close")
        return state._replace(open=state.open ^ {thing}) if fits else None
    item = ITEMS.index(thing)
    shut = bool(rest) and rest[0] in DOORS and rest[0] not in state.open
    if name == "approach":
        fits = state.at is None and not shut and state.located[item] == rest[0]
    else:
        fits = state.at == thing and state.holds == (name in ("move", "drop"))
    if name == "move":
        fits = fits and not shut and state.located[item] != rest[0]
        return state._replace(located=(*state.located[:item], rest[0], *state.located[item + 1 :])) if fits else None
    after = {
        "approach": state._replace(at=thing),
        "grasp": state._replace(holds=True),
        "drop": state._replace(holds=False),
        "withdraw": state._replace(at=None),
    }
    return after[name] if fits else None


def pick_and_place(item: str, start: str, end: str) -> Word:
    there, away = ("approach", "panda", item, start), ("withdraw", "panda", item)
    return (there, ("grasp", "panda", item), ("move", "panda", item, end), ("drop", "panda", item), away)


def behind_door(door: str, word: Word) -> Word:
    return (("open", "panda", door), *word, ("close", "panda", door))


@cache
def kitchen() -> Simulation:
    doors = [((name, "panda", door),) for door in DOORS for name in ("open", "close")]
    carried = {(i, p, q): pick_and_place(i, p, q) for i in ITEMS for p in PLACES for q in PLACES if p != q}
    fetched = [behind_door(p, word) for (_, p, _), word in carried.items() if p in DOORS]
    stored = [behind_door(q, word) for (_, _, q), word in carried.items() if q in DOORS]
    cup = behind_door("cupboard_1", pick_and_place("cup_1", "cupboard_1", "table_1"))
    served = [(*cup, *behind_door("drawer_1", pick_and_place(i, "drawer_1", "bowl_1"))) for i in APPLES]
    units = (*doors, *carried.values(), *fetched, *stored, *served)
    return Simulation(START, tuple(sorted({action for unit in units for action in unit})), step, units)


@pytest.mark.parametrize("level", ["plan", "task", "skeleton", "flat.plan", "flat.task", "flat.skeleton"])
def test_the_known_counts_are_those_of_the_simulation(level: str) -> None:
    check_known_counts(shipped_domains()["kitchen"], kitchen(), level, APPLES)
