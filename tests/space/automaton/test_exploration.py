"""States are explored breadth-first, and their numbers depend on the domain alone."""

from __future__ import annotations

import numpy as np
import pytest

from prag_asp import load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.packed import unpack
from prag_asp.logic.step.transition import Transition
from prag_asp.space.automaton import exploration as exploring
from prag_asp.space.automaton.exploration import Exploration, Extent, explore
from prag_asp.stop_reason import StopKind, StopReason
from tests.chance import Chance
from tests.domains import domain_of

LAMPS = """
class(kind(1..K)). entity(lamp(I),kind(I)) :- class(kind(I)). fluent(lit(L)) :- entity(L,_).
initially(lit(L),false) :- entity(L,_). action((on(L);off(L))) :- entity(L,_).
precondition(on(L),lit(L),false) :- entity(L,_). postcondition(on(L),lit(L),true) :- entity(L,_).
precondition(off(L),lit(L),true) :- entity(L,_). postcondition(off(L),lit(L),false) :- entity(L,_).
"""


def lamps(number: int) -> Transition:
    return DomainLogic(domain_of(LAMPS.replace("K", str(number)))).transition(tasks=False)


def one_by_one(transition: Transition, length: int) -> tuple[list[tuple[int, ...]], list[tuple[int, int, int]]]:
    """Breadth-first search that expands one state at a time and numbers states in a dictionary."""
    states = {tuple(row): number for number, row in enumerate(transition.initial.tolist())}
    depths, edges = [0] * len(states), []
    for number, state in enumerate(iter_growing(states)):
        if depths[number] == length:
            continue
        for after in transition.expand(np.array([state], dtype=np.uint64)):
            target = states.setdefault(tuple(after.states[0].tolist()), len(states))
            if target == len(depths):
                depths.append(depths[number] + 1)
            edges.append((number, after.letter, target))
    return list(states), edges


def iter_growing(states: dict[tuple[int, ...], int]) -> list[tuple[int, ...]]:
    place = 0
    while place < len(states):
        yield list(states)[place]
        place += 1


@pytest.mark.parametrize("name", ["prag", "blocks", "hanoi"])
@pytest.mark.parametrize("tasks", [True, False])
def test_states_and_edges_come_in_the_order_of_a_plain_search(name: str, tasks: bool) -> None:
    transition = DomainLogic(load_domain(name)).transition(tasks=tasks)
    states, edges = one_by_one(transition, 4)
    automaton = explore(transition, 4).automaton
    found = zip(automaton.sources.tolist(), automaton.letters.tolist(), automaton.targets.tolist(), strict=True)
    assert list(found) == edges
    assert automaton.states == len(states)


def test_how_many_states_are_expanded_together_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    transition = DomainLogic(load_domain("blocks")).transition(tasks=False)
    whole = explore(transition, 20).automaton
    monkeypatch.setattr(exploring, "MOST", 3)
    monkeypatch.setattr(exploring, "FEWEST", 1)
    parts = explore(transition, 20).automaton
    for key in ("offsets", "letters", "targets", "accepting"):
        assert np.array_equal(getattr(whole, key), getattr(parts, key))
    assert parts.horizon is None


def test_independent_lamps_have_as_many_states_and_edges_as_they_should() -> None:
    explored = explore(lamps(12), 12)
    assert explored.automaton.states == 2**12
    assert len(explored.automaton.letters) == 12 * 2**12 - 12  # the state where all are lit is not left
    assert explore(lamps(12), 13).automaton.horizon is None
    assert explored.automaton.horizon == 12


ENOUGH = StopReason(StopKind.HALT)


def stopped_after(transition: Transition, states: int) -> tuple[Exploration, list[Extent]]:
    told: list[Extent] = []

    def watch(extent: Extent) -> StopReason | None:
        told.append(extent)
        return ENOUGH if extent.states >= states else None

    return explore(transition, 12, watch), told


def test_an_exploration_that_is_stopped_has_only_words_that_there_are() -> None:
    transition = lamps(12)
    whole = explore(transition, 12).automaton
    part, told = stopped_after(transition, 500)
    assert part.stop == ENOUGH and 500 <= part.automaton.states < whole.states
    edges = len(part.automaton.letters)
    assert np.array_equal(part.automaton.letters, whole.letters[:edges])
    assert np.array_equal(part.automaton.targets, whole.targets[:edges])
    assert np.array_equal(part.automaton.accepting, whole.accepting[: part.automaton.states])
    assert [extent.states for extent in told] == sorted(extent.states for extent in told)
    assert told[-1].edges == edges and told[-1].nbytes > 8 * edges


def test_a_domain_whose_state_is_empty_has_one_state() -> None:
    transition = DomainLogic(domain_of("fluent(f). action(a). action(b). postcondition(a,f,true).")).transition(
        tasks=False
    )
    assert not transition.variables
    automaton = explore(transition, 3).automaton
    assert automaton.states == 1 and automaton.letters.tolist() == [0, 1] and automaton.horizon is None


def test_states_are_packed_into_words_and_read_back(chance: Chance) -> None:
    from prag_asp.logic.step.packed import mask_of, pack

    columns = np.random.default_rng(chance.seed(0)).random((131, 7)) < 0.5
    rows = pack(columns)
    assert rows.shape == (7, 3) and rows.dtype == np.uint64
    assert np.array_equal(unpack(rows, 131), columns)
    assert unpack(mask_of([0, 64, 130], 3)[None], 131)[:, 0].nonzero()[0].tolist() == [0, 64, 130]
