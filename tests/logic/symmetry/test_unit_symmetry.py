"""Entities that are interchangeable together with others, and what is divided by."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping

import clingo
import pytest

from prag_asp import QueryError, TaskSpace
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from tests.domains import domain_of
from tests.spaces import with_engines

SAUCERS = """
class((cup; saucer)). entity((c1; c2; c3), cup). entity((s1; s2; s3), saucer). of(c1, s2). of(c2, s3). of(c3, s1).
fluent(on(C)) :- of(C, _). initially(on(C), false) :- of(C, _).
action(serve(C); clear(S)) :- of(C, S).
precondition(serve(C), on(C), false) :- of(C, _). postcondition(serve(C), on(C), true) :- of(C, _).
precondition(clear(S), on(C), true) :- of(C, S). postcondition(clear(S), on(C), false) :- of(C, S).
"""

TRAYS = """
class((tray; cup; saucer)). entity(t(1..2), tray). entity(c(1..2,1..2), cup). entity(s(1..2,1..2), saucer).
of(c(I,J), s(I,J), t(I)) :- entity(c(I,J), cup). fluent((on(C); full(T))) :- of(C, _, T).
initially((on(C); full(T)), false) :- of(C, _, T).
action(serve(C)) :- of(C, _, _). action(clear(S)) :- of(_, S, _). action(carry(T)) :- of(_, _, T).
precondition(serve(C), on(C), false) :- of(C, _, _). postcondition(serve(C), (on(C); full(T)), true) :- of(C, _, T).
precondition(clear(S), on(C), true) :- of(C, S, _). postcondition(clear(S), on(C), false) :- of(C, S, _).
precondition(carry(T), full(T), true) :- of(_, _, T).
"""

PAIRS = """
class(sock). entity((s1; s2; s3; s4), sock). pair(s1, s2). pair(s3, s4). pair(B, A) :- pair(A, B).
fluent(worn(S)) :- entity(S, sock). initially(worn(S), false) :- entity(S, sock).
action(change(A, B)) :- pair(A, B). precondition(change(A, B), worn(A), false) :- pair(A, B).
postcondition(change(A, B), worn(A), true; change(A, B), worn(B), false) :- pair(A, B).
"""

SEATS = """
class(seat). entity((s1; s2; s3; s4; s5), seat).
beside(s1,s2). beside(s2,s3). beside(s3,s4). beside(s4,s5). beside(s5,s1). beside(B, A) :- beside(A, B).
fluent(sat(S)) :- entity(S, seat). action(pass(A, B)) :- beside(A, B).
postcondition(pass(A, B), sat(B), true) :- beside(A, B).
"""

Names = Mapping[str, str]


def orbits(plans: Iterable[tuple[str, ...]], renamings: Iterable[Names]) -> set[frozenset[tuple[str, ...]]]:
    """Return plans up to renamings, each of all entities."""
    ways = [{clingo.parse_term(one): clingo.parse_term(other) for one, other in each.items()} for each in renamings]
    return {
        frozenset(tuple(str(renamed(clingo.parse_term(a), names)) for a in plan) for names in ways) for plan in plans
    }


def renamings_of_trays() -> Iterable[Names]:
    for trays, *cups in itertools.product(itertools.permutations("12"), repeat=3):
        names = {f"t({i})": f"t({trays[int(i) - 1]})" for i in "12"}
        for kind, i, j in itertools.product("cs", "12", "12"):
            names[f"{kind}({i},{j})"] = f"{kind}({trays[int(i) - 1]},{cups[int(i) - 1][int(j) - 1]})"
        yield names


def renamings_of_saucers() -> Iterable[Names]:
    saucer = {"c1": "s2", "c2": "s3", "c3": "s1"}
    for order in itertools.permutations(saucer):
        cups = dict(zip(saucer, order, strict=True))
        yield {**cups, **{saucer[one]: saucer[other] for one, other in cups.items()}}


def renamings_of_pairs() -> Iterable[Names]:
    for pairs, *socks in itertools.product(itertools.permutations(["s1 s2", "s3 s4"]), *[(1, -1)] * 2):
        named = [name for pair, turn in zip(pairs, socks, strict=True) for name in pair.split()[::turn]]
        yield dict(zip(["s1", "s2", "s3", "s4"], named, strict=True))


@pytest.mark.parametrize(
    ("text", "names"),
    [(SAUCERS, renamings_of_saucers), (TRAYS, renamings_of_trays), (PAIRS, renamings_of_pairs)],
)
def test_tasks_are_orbits_under_renamings_of_what_belongs_together(text, names) -> None:
    spaces = [space.at(3) for space in with_engines(domain_of(text), "automaton", "clingo", "sat", "symbolic")]
    plans = sorted(spaces[0].enumerate("plan"))
    found = orbits(plans, names())
    for space in spaces:
        assert sorted(space.enumerate("plan")) == plans
        assert space.symmetries.order == len(list(names()))
        tasks = list(space.enumerate("task"))
        assert space.count() == len(found) == len(tasks) and orbits(tasks, names()) == found
        ranks = [{space.index(plan) for plan in orbit} for orbit in found]
        assert sorted(map(sorted, ranks)) == [[rank] for rank in range(len(found))]


def test_states_are_merged_beside_units() -> None:
    """Cups are interchangeable on their tray, and trays together with their cups."""
    text = """
        class((tray; cup)). entity(t(1..2), tray). entity(c(1..2,1..3), cup). lies(c(I,J), t(I)) :- entity(c(I,J), cup).
        fluent((on(C); full(T))) :- lies(C, T). initially((on(C); full(T)), false) :- lies(C, T).
        action((serve(C); clear(C); carry(T))) :- lies(C, T). precondition(carry(T), full(T), true) :- lies(_, T).
        precondition(serve(C), on(C), false) :- lies(C, _). precondition(clear(C), on(C), true) :- lies(C, _).
        postcondition(serve(C), (on(C); full(T)), true) :- lies(C, T).
        postcondition(clear(C), on(C), false) :- lies(C, _).
    """
    model = TaskSpace(domain_of(text), 0).engines.model
    assert [len(group) for group in model.groups(0)] == [3, 3] and len(model.symmetries(0).joint) == 1
    plain, merged = (AutomatonEngine(model, "task", merge=merge) for merge in (False, True))
    for length in range(6):
        assert list(plain.words(length)) == list(merged.words(length))


def test_of_a_ring_one_reflection_is_found() -> None:
    space = TaskSpace(domain_of(SEATS), 2)
    [units] = space.symmetries.joint
    assert space.symmetries.order == 2 and len(units) == 2
    pairs = {str(one): str(other) for one, other in zip(*units, strict=True)}
    names = {seat: seat for seat in ("s1", "s2", "s3", "s4", "s5")} | pairs | {b: a for a, b in pairs.items()}
    assert space.count() == len(orbits(space.enumerate("plan"), [{seat: seat for seat in names}, names]))


def test_what_tells_one_apart_tells_its_unit_apart() -> None:
    space = TaskSpace(domain_of(SAUCERS), 2)
    assert [len(units) for units in space.where("uses s1").symmetries.joint] == [2]


@pytest.mark.parametrize("what", ["c1", "s3", "serve(c2)"])
def test_a_member_of_a_unit_is_not_held_out(what: str) -> None:
    with pytest.raises(QueryError, match="interchangeable"):
        TaskSpace(domain_of(SAUCERS), 2).hold_out(what)


def test_members_of_units_weigh_the_same() -> None:
    space = TaskSpace(domain_of(SAUCERS), 2)
    assert space.sampling(weights={"cup": 2}).total_weight() > space.count()
    with pytest.raises(QueryError, match="c1 and c2 are interchangeable"):
        space.sampling(weights={"c2": 2}).total_weight()


def test_after_a_mere_name_a_prefix_names_units_that_were_named_before() -> None:
    space = TaskSpace(domain_of(SAUCERS), 3)
    plans = [plan for plan in space.enumerate("plan") if plan[0] == "serve(c3)" and plan[2] == "clear(s1)"]
    assert space.count(prefix=["serve(c3)", "serve", "clear(s1)"]) == len(orbits(plans, renamings_of_saucers())) == 1
    with pytest.raises(QueryError, match="an action name without arguments"):
        space.count(prefix=["serve(c3)", "serve", "clear(s2)"])
