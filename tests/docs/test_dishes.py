"""The example of the pages, examples/dishes, written again in Python from the definition of a valid plan.

Some complete initial state executes it. The set of all complete states that are still possible is carried along.
"""

from __future__ import annotations

import itertools

import pytest

from prag_asp import TaskSpace, load_domain
from tests.docs.pages import ROOT

DISHES = ROOT / "examples" / "dishes"
CUPS = ("cup_1", "cup_2")
SPOTS = ("table_1", "sink_1", "rack_1")
CAPACITY = 3
State = frozenset[tuple[str, ...]]
Plan = tuple[tuple[str, ...], ...]


def allowed(state: State) -> bool:
    """Tell whether a state satisfies the invariants."""
    for cup in CUPS:
        if sum((place, cup) in state for place in (*SPOTS, "held")) > 1:
            return False
        if ("rack_1", cup) in state and ("clean", cup) not in state:
            return False
    return not all(("held", cup) in state for cup in CUPS)


def first_states() -> set[State]:
    """Return all complete states that agree with what is said of the start."""
    fluents = [(place, cup) for place in (*SPOTS, "held", "clean") for cup in CUPS]
    subsets = itertools.chain.from_iterable(itertools.combinations(fluents, k) for k in range(len(fluents) + 1))
    states = set(map(frozenset, subsets))
    return {state for state in states if allowed(state) and not any(("held", cup) in state for cup in CUPS)}


def actions() -> list[tuple[str, ...]]:
    """Return all ground actions."""
    moves = itertools.product(("pick", "put"), CUPS, SPOTS)
    return [*moves, *(("wash", cup) for cup in CUPS), ("charge",)]


def results(state: State, action: tuple[str, ...]) -> list[State]:
    """Return the complete states that an action may lead to, none where its preconditions fail."""
    empty = not any(("held", cup) in state for cup in CUPS)
    name, *rest = action
    if name == "charge":
        return [state] if empty else []
    if name == "wash":
        ready = empty and ("sink_1", rest[0]) in state and ("clean", rest[0]) not in state
        return [state | {("clean", rest[0])}] if ready else []
    cup, spot = rest
    if name == "pick":
        after = state - {(spot, cup)} | {("held", cup)}
        return [after] if empty and (spot, cup) in state and allowed(after) else []
    if ("held", cup) not in state:
        return []
    after = state - {("held", cup)} | {(spot, cup)}
    options = [after] if spot != "table_1" else [after - {("clean", cup)}, after | {("clean", cup)}]
    return [option for option in options if allowed(option)]


def plans(length: int) -> list[Plan]:
    """Return all valid plans of a length."""
    found: list[tuple[Plan, set[State], int]] = [((), first_states(), CAPACITY)]
    for _ in range(length):
        longer = []
        for plan, states, battery in found:
            for action in actions():
                if battery == 0 and action != ("charge",):
                    continue
                after = {result for state in states for result in results(state, action)}
                if after:
                    longer.append(((*plan, action), after, CAPACITY if action == ("charge",) else battery - 1))
        found = longer
    return [plan for plan, states, _ in found if any(not any(("held", c) in s for c in CUPS) for s in states)]


def up_to_renaming(plan: Plan) -> Plan:
    """Return the same plan for plans that differ by swapping the two cups."""
    other = dict(zip(CUPS, reversed(CUPS), strict=True))
    return min(plan, tuple(tuple(other.get(part, part) for part in action) for action in plan))


def spelled(plan: Plan) -> tuple[str, ...]:
    return tuple(f"{name}({','.join(('panda', *rest))})" for name, *rest in plan)


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
def test_the_example_counts_as_the_definition_says(engine: str) -> None:
    space = TaskSpace(load_domain(DISHES), 0, engine=engine)
    for length in range(6):
        valid = plans(length)
        assert set(space.at(length).enumerate("plan")) == set(map(spelled, valid))
        assert space.at(length).count("plan") == len(valid)
        assert space.at(length).count("task") == len(set(map(up_to_renaming, valid)))
        assert space.at(length).count("skeleton") == len({tuple(name for name, *_ in plan) for plan in valid})
