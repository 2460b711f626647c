"""The symbolic engine answers as the others do, and counts where states are too many to list."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, factorial
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import LimitReached, Limits, TaskSpace
from prag_asp.space.automaton.exploration import Extent
from prag_asp.space.engines import LEVELS, Level
from prag_asp.space.engines.auto_engine import Growth
from prag_asp.space.engines.symbolic_engine import SymbolicEngine
from prag_asp.space.limits import limit_error
from prag_asp.stop_reason import StopKind, StopReason
from tests.chance import Chance, examples
from tests.domains import domain_of
from tests.spaces import with_engine
from tests.strategies import symmetric_texts

UNCACHED = Limits(cached=False)
ONE_SECOND = Limits(seconds=1, cached=False)

CARRIED = """
initially(F,false) :- fluent(F), not initially(F,true).
#const things = {things}.
#const places = {places}.
class(thing). class(place).
entity(thing(1..things), thing). entity(place(1..places), place).
fluent(free). fluent(held(O)) :- entity(O,thing). fluent(at(O,P)) :- entity(O,thing), entity(P,place).
initially(free, true). initially(at(thing(I),place(I)), true) :- entity(thing(I),thing).
goal(at(thing(I),place(I+1)), true) :- entity(thing(I),thing).
action((pick(O,P); put(O,P))) :- entity(O,thing), entity(P,place).
precondition(pick(O,P), (at(O,P); free), true) :- action(pick(O,P)).
postcondition(pick(O,P), (at(O,P); free), false) :- action(pick(O,P)).
postcondition(pick(O,P), held(O), true) :- action(pick(O,P)).
precondition(put(O,P), held(O), true) :- action(put(O,P)).
postcondition(put(O,P), (at(O,P); free), true) :- action(put(O,P)).
postcondition(put(O,P), held(O), false) :- action(put(O,P)).
"""
"""Things that a hand carries, each of which has to end at the place of the next; there are more places than things."""


def carried(things: int, places: int, steps: int) -> int:
    """Return the number of plans: sequences of a thing and a place, by exponential generating functions.

    A thing that is carried c times may be put anywhere but the last time, so in places^(c - 1) ways.
    """
    moves, odd = divmod(steps, 2)
    one = [Fraction(places ** (c - 1), factorial(c)) if c else Fraction(0) for c in range(moves + 1)]
    whole = [Fraction(1), *[Fraction(0)] * moves]
    for _ in range(things):
        whole = [sum((whole[i] * one[n - i] for i in range(n + 1)), Fraction(0)) for n in range(moves + 1)]
    return 0 if odd else int(whole[moves] * factorial(moves))


def compare(symbolic: TaskSpace, other: TaskSpace, by: Level) -> list[tuple[str, ...]]:
    """Check that two spaces of one level and length answer alike, and return their words."""
    words = list(other.enumerate(by))
    assert symbolic.count(by) == len(words)
    assert list(symbolic.enumerate(by)) == words
    engine = symbolic.engines.engine(by, symbolic.length)
    length = symbolic.length
    assert [engine.unrank(length, rank) for rank in range(len(words))] == words
    assert [engine.rank(word) for word in words] == list(range(len(words)))
    return words


@pytest.mark.slow
@settings(max_examples=examples(15), suppress_health_check=list(HealthCheck))
@given(symmetric_texts(), st.data())
def test_tasks_and_what_begins_with_a_prefix_are_those_of_clingo(text: str, data: st.DataObject) -> None:
    symbolic = TaskSpace(domain_of(text), 2, engine="symbolic")
    clingo = with_engine(symbolic, "clingo")
    plans, _ = compare(symbolic, clingo, "plan"), compare(symbolic, clingo, "task")
    letters = symbolic.engines.engine("plan", symbolic.length).letters
    letters = (*letters, *sorted({letter.partition("(")[0] for letter in letters}))
    prefix = tuple(data.draw(st.lists(st.sampled_from(letters), max_size=2)))
    begun = [word for word in plans if all(p in (a, a.partition("(")[0]) for p, a in zip(prefix, word, strict=False))]
    assert list(symbolic.enumerate("plan", prefix)) == begun
    assert symbolic.count("plan", prefix) == len(begun)


@pytest.mark.parametrize("weights", [{}, {"pick": 3, "thing_1": "1/2", "put>pick": "2/3", "pick(thing_2,place(1))": 5}])
def test_draws_of_a_seed_are_those_of_the_automaton(weights: dict[str, Any], chance: Chance) -> None:
    text = CARRIED.format(things=2, places=3).replace("thing(1..things)", "(thing_1; thing_2)")
    text = text.replace("thing(I)", "T").replace("T,place(I)", "T,place(1)").replace("T,place(I+1)", "T,place(2)")
    text = text.replace("entity(T,thing)", "entity(T,thing)")
    symbolic = TaskSpace(domain_of(text), 6, engine="symbolic")
    automaton = with_engine(symbolic, "automaton")
    asked: dict[str, Any] = {"weights": weights, "by": "plan"}
    drawn, expected = (space.sample(40, seed=chance.seed(1), **asked) for space in (symbolic, automaton))
    assert [(str(task), task.log_probability) for task in drawn] == [(str(t), t.log_probability) for t in expected]
    assert symbolic.sampling(**asked).total_weight() == automaton.sampling(**asked).total_weight()
    assert symbolic.statistics(**asked) == automaton.statistics(**asked)


@pytest.mark.parametrize(("things", "places"), [(1, 2), (2, 3), (3, 5), (4, 6)])
def test_things_that_are_carried_are_counted_as_a_formula_does(things: int, places: int) -> None:
    space = TaskSpace(domain_of(CARRIED.format(things=things, places=places)), 0, engine="symbolic")
    steps = range(0, 2 * things + 5)
    assert [space.at(n).count("plan") for n in steps] == [carried(things, places, n) for n in steps]


@pytest.mark.slow
def test_a_world_of_a_hundred_million_states_is_counted_and_drawn_from() -> None:
    """8 things, 10 places: 10^8 states with a free hand and 8 * 10^7 with a thing in it, all within 20 steps."""
    told: list[str] = []
    space = TaskSpace(domain_of(CARRIED.format(things=8, places=10)), 20, engine="symbolic", progress=told.append)
    assert space.count("plan") == carried(8, 10, 20) == 3_024_000_000
    assert any("180,000,000 states" in line for line in told)
    for rank in (0, 1_234_567_890, 3_023_999_999):
        word = space.engines.engine("plan", space.length).unrank(20, rank)
        assert space.engines.engine("plan", space.length).rank(word) == rank
    for task in space.sample(20, seed=3, by="plan"):
        at = {f"thing({i})": f"place({i})" for i in range(1, 9)}
        for picked, put in zip(task.actions[::2], task.actions[1::2], strict=True):
            thing, place = picked.arguments
            assert (picked.name, put.name, put.arguments[0]) == ("pick", "put", thing)
            assert at[thing] == place
            at[thing] = put.arguments[1]
        assert at == {f"thing({i})": f"place({i + 1})" for i in range(1, 9)}


SUMS = """
#program base.
class(lamp). entity((l1; l2; l3; l4), lamp).
fluent(lit(L)) :- entity(L,lamp).
action(press(L)) :- entity(L,lamp).
initially(F,false) :- fluent(F).
weighs(l1,1). weighs(l2,2). weighs(l3,-1). weighs(l4,3).
#program step(t).
holds(lit(L),true,t) :- occurs(press(L),t), holds(lit(L),false,t-1).
holds(lit(L),false,t) :- occurs(press(L),t), holds(lit(L),true,t-1).
changed(lit(L),t) :- occurs(press(L),t).
{rule}
"""
LIT, DARK = "holds(lit({}),true,t)", "not holds(lit({}),true,t)"
WEIGHTS = {"l1": 1, "l2": 2, "l3": -1, "l4": 3}


def lamps_on(length: int) -> Iterator[Sequence[frozenset[str]]]:
    """Yield the sets of lamps that are lit after each step, for every way to press."""
    runs: list[list[frozenset[str]]] = [[frozenset()]]
    for _ in range(length):
        runs = [[*run, run[-1] ^ {lamp}] for run in runs for lamp in WEIGHTS]
    return iter(runs)


@pytest.mark.parametrize("bound", [-1, 0, 1, 2, 3, 4, 6])
def test_sums_of_weights_below_zero_as_well_are_exact(bound: int) -> None:
    rule = f":- #sum{{ W,L : weighs(L,W), holds(lit(L),true,t) }} >= {bound}."
    space = TaskSpace(domain_of(SUMS.format(rule=rule)), 4, engine="symbolic")
    expected = sum(
        all(sum(WEIGHTS[lamp] for lamp in lit) < bound for lit in run[1:]) for run in lamps_on(4)
    )  # fmt: skip
    assert space.count("plan") == expected


def test_rules_that_derive_each_other_are_evaluated_until_nothing_changes() -> None:
    """Of lamps in a row, those lit are joined to the first one, or the step is forbidden."""
    rule = """
        joined(l1,t) :- holds(lit(l1),true,t).
        next(l1,l2). next(l2,l3). next(l3,l4).
        joined(M,t) :- joined(L,t), next(L,M), holds(lit(M),true,t).
        joined(L,t) :- joined(M,t), next(L,M), holds(lit(L),true,t).
        :- holds(lit(L),true,t), not joined(L,t)."""
    rule = rule.replace("next(l1,l2). next(l2,l3). next(l3,l4).", "")
    text = SUMS.format(rule=rule).replace("weighs(l1,1).", "next(l1,l2). next(l2,l3). next(l3,l4). weighs(l1,1).")
    space = TaskSpace(domain_of(text), 6, engine="symbolic")
    rows = [frozenset(list(WEIGHTS)[:k]) for k in range(5)]
    assert space.count("plan") == sum(all(lit in rows for lit in run) for run in lamps_on(6))


def test_lamps_are_counted_as_walks_in_a_cube() -> None:
    """Ends of walks with all lamps off again: the eigenvalues of the cube (Stanley, Algebraic Combinatorics, 2)."""
    text = "".join(
        ["initially(F,false) :- fluent(F). class(kind(1..12)). entity(lamp(K),kind(K)) :- class(kind(K)).\n",
         "fluent(lit(L)) :- entity(L,_). action((on(L); off(L))) :- entity(L,_).\n",
         "precondition(on(L),lit(L),false) :- entity(L,_). postcondition(on(L),lit(L),true) :- entity(L,_).\n",
         "precondition(off(L),lit(L),true) :- entity(L,_). postcondition(off(L),lit(L),false) :- entity(L,_).\n",
         "goal(lit(L),false) :- entity(L,_).\n",
         "#program step(t). beat(t) :- not beat(t-1). #program ending(t). :- beat(t)."]
    )  # fmt: skip
    space = TaskSpace(domain_of(text), 14, engine="symbolic")
    assert space.count("plan") == sum(comb(12, j) * (12 - 2 * j) ** 14 for j in range(13)) // 2**12


@pytest.mark.parametrize("by", LEVELS)
def test_a_limit_ends_it_with_one_line(by: Level) -> None:
    """26 things in a row of which neighbours swap: more orders than diagrams can hold."""
    text = """
        class(thing). entity(thing(1..26), thing).
        fluent(at(T,1..26)) :- entity(T,thing).
        initially(at(thing(I),I), true) :- entity(thing(I),thing).
        initially(F,false) :- fluent(F), not initially(F,true).
        action(swap(1..25)).
        goal(at(thing(I),27-I), true) :- entity(thing(I),thing).
        #program step(t).
        holds(at(T,P),V,t) :- occurs(swap(P),t), holds(at(T,P+1),V,t-1).
        holds(at(T,P+1),V,t) :- occurs(swap(P),t), holds(at(T,P),V,t-1), P < 26.
        changed(at(T,P..P+1),t) :- occurs(swap(P),t), entity(T,thing)."""
    space = TaskSpace(domain_of(text), 325, engine="symbolic", limits=Limits(seconds=0.5, cached=False))
    with pytest.raises(LimitReached, match=rf"^the time limit of 0.5 s was reached: there are at least \d+ {by}s of "):
        space.count(by)


@dataclass(frozen=True)
class Looks:
    """Limits, and a clock, that are spent after so many looks; then there is time to tell what was found."""

    left: list[int]
    limits: Limits = ONE_SECOND
    seconds: float | None = 1
    cached: bool = False

    def begin(self) -> Looks:
        return self

    def reached_limit(self) -> StopReason | None:
        self.left[0] -= 1
        return None if self.left[0] >= 0 else StopReason(StopKind.TIME, 1)

    def to_close(self) -> Looks:
        return Looks([10**9])  # more than are needed

    to_report = to_close


@pytest.mark.parametrize("by", LEVELS)
def test_at_a_limit_it_tells_how_many_there_are_at_least(by: Level, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whenever it is ended, there are no more words than it says, and the later it is the more it knows."""
    monkeypatch.setattr("prag_asp.logic.diagram.diagrams.LOOK", 100)
    text = CARRIED.format(things=2, places=3).replace("goal(at(thing(I),place(I+1)), true)", "seen(I)")
    exact = TaskSpace(domain_of(text), 6, limits=UNCACHED).count(by)
    told = []
    for looks in (0, 1, *range(3, 1000, 12)):
        space = TaskSpace(domain_of(text), 6, engine="symbolic", limits=Looks([looks]))  # type: ignore[arg-type]
        try:
            assert space.count(by) == exact
            break
        except LimitReached as reached:
            told.append(reached.at_least)
    else:
        pytest.fail("so many looks do not do")
    assert max(told) > 0
    assert all(found <= exact for found in told), told


def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have a machine with so little memory that small spaces do not fit, however they are merged."""
    monkeypatch.setattr("prag_asp.space.engines.auto_engine.usual_memory", lambda: 40_000)
    for name in ("PATIENCE", "MORE_PATIENCE"):
        monkeypatch.setattr(f"prag_asp.space.engines.reachability.{name}", 1000)


def test_auto_goes_over_to_diagrams_where_states_will_not_fit_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    narrow(monkeypatch)
    told: list[str] = []
    space = TaskSpace(domain_of(CARRIED.format(things=4, places=6)), 12, limits=UNCACHED, progress=told.append)
    assert space.count("plan") == carried(4, 6, 12)
    assert sum("engine symbolic, because" in line for line in told) == 1
    word = next(iter(space.enumerate("plan")))
    assert space.engines.engine("plan", space.length).rank(word) == 0
    assert space.engines.engine("plan", space.length).unrank(12, 0) == word
    assert word in space
    assert space.at(4).count("plan") == 0
    drawn = [str(task) for task in space.sample(3, seed=1, by="plan")]
    assert drawn == [str(task) for task in with_engine(space, "symbolic").sample(3, seed=1, by="plan")]


def test_auto_tells_how_many_were_found_where_diagrams_reach_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was listed has words, which the end of the listing and of the diagrams does not take away."""
    narrow(monkeypatch)

    def refuse(self: SymbolicEngine, length: int, prefix: tuple[str, ...] = ()) -> int:
        raise limit_error(StopReason(StopKind.TIME, 9), 0, "plan", length)

    monkeypatch.setattr(SymbolicEngine, "count", refuse)
    text = CARRIED.format(things=5, places=8).replace("goal(at(thing(I),place(I+1)), true)", "seen(I)")
    with pytest.raises(LimitReached, match=r"^the time limit of 9 s was reached: there are at least \d{3,} pl") as told:
        TaskSpace(domain_of(text), 12, limits=UNCACHED).count("plan")
    assert 0 < told.value.at_least < (5 * 8) ** 6


def test_spaces_that_fill_up_are_told_from_those_that_grow_on() -> None:
    growing, filling = Growth(10**9), Growth(10**9)
    for depth in range(1, 9):
        growing.hopeless(Extent(depth, 8**depth, 0, 0), 30)
        filling.hopeless(Extent(depth, sum(comb(12, k) for k in range(depth + 1)), 0, 0), 30)
    extent = Extent(9, 8**8, 0, 10**8)
    assert growing.forecast(extent, 30) > 10**12
    assert 10**8 <= filling.forecast(Extent(9, 4000, 0, 10**8), 30) < 2 * 10**8
    assert growing.hopeless(extent, 30)
    assert not growing.hopeless(Extent(10, 8**8, 0, 10**6), 30)
