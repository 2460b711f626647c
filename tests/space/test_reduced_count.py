"""Counts with the small-model reduction are those with all entities ground."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from importlib.util import find_spec
from math import perm
from pathlib import Path

import clingo
import pytest

from prag_asp import DomainError, LimitReached, TaskSpace, load_domain
from prag_asp.domain import load
from prag_asp.domain.load import Domain
from prag_asp.lint import Checked
from prag_asp.program.sources import Program, Source, core_sources
from prag_asp.reduction import reduction as reduction_module
from prag_asp.reduction.reduction import Reduction, find_reduction
from prag_asp.space import ENGINES
from prag_asp.space.engines.engine import LEVELS
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.reduced_count import ReducedCounter
from tests.chance import Chance
from tests.domains import ENCODINGS
from tests.reduction.lifted import TRAPS, draw_lifted

DOMAINS, PARTS = 60, 4
"""How many domains are drawn; with `pytest --fresh`, ten times as many."""

MOST = 8
"""Things of a domain that are all ground, to compare with; some domains need more."""

NO_SETTINGS = Source(Path("domain.toml"), "")

STACKS = """class(cube). class(table). entity(table_1, table).
fluent(on(C,D)) :- is_a(C,cube), is_a(D,cube), C != D. fluent(held(C)) :- is_a(C,cube).
fluent(on(C,T)) :- is_a(C,cube), is_a(T,table).
exclusive(on(C,D), on(C,E)) :- fluent(on(C,D)), fluent(on(C,E)), D < E.
exclusive(held(C), held(D)) :- fluent(held(C)), fluent(held(D)), C < D.
action(take(C)) :- is_a(C,cube). action(put(C,D)) :- fluent(on(C,D)).
precondition(take(C), on(D,C), false) :- action(take(C)), fluent(on(D,C)).
precondition(take(C), held(D), false) :- action(take(C)), fluent(held(D)).
postcondition(take(C), held(C), true) :- action(take(C)).
postcondition(take(C), on(C,D), false) :- action(take(C)), fluent(on(C,D)).
precondition(put(C,D), held(C), true) :- action(put(C,D)).
precondition(put(C,D), on(E,D), false) :- action(put(C,D)), fluent(on(E,D)), is_a(D,cube).
postcondition(put(C,D), on(C,D), true) :- action(put(C,D)).
postcondition(put(C,D), held(C), false) :- action(put(C,D)).
"""
"""Cubes that are taken and put onto one another; where they begin is open."""


@pytest.fixture(autouse=True)
def small_programs_are_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reduction_module, "MANY", 0)


@cache
def cubes(number: int, more: str = "") -> Domain:
    """Return the domain of stacks with so many cubes."""
    return load_domain(text=f"entity(({'; '.join(f'c{n}' for n in range(number))}), cube).\n{STACKS}{more}")


def reduction_of(text: str, fewest: int = 2) -> Reduction | str | None:
    """Return the reduction of a text with groups of at least `fewest` entities."""
    program = Program((*core_sources(ENCODINGS), Source(Path("toy.lp"), text)))
    return find_reduction(program, NO_SETTINGS, fewest=fewest)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_counts_are_those_of_all_entities_on_random_domains(part: int, chance: Chance) -> None:
    number, compared = chance.examples(DOMAINS) // PARTS, 0
    for seed in range(part * number, (part + 1) * number):
        lifted, length = draw_lifted(chance.generator(seed)), 2 if seed % 4 == 0 else 1
        try:
            first = reduction_of(lifted.text(MOST))
        except DomainError:
            continue  # what is drawn contradicts itself
        if not isinstance(first, Reduction) or (things := max(first.sizes(length)) + 1 + lifted.marked) > MOST:
            continue
        reduction = reduction_of(lifted.text(things))
        if not isinstance(reduction, Reduction):
            continue
        domain = load_domain(text=lifted.text(things))
        told = f"seed {seed}: {lifted.text(things)}"
        assert reduction.total(reduction.facts.fluents) == len(domain.facts.fluents), told
        assert reduction.total(reduction.facts.tried) == len(domain.facts.tried), told
        counter, space = ReducedCounter(domain, reduction, "auto", None, UNLIMITED), TaskSpace(domain, length)
        for by in LEVELS:
            found = counter.count(by, length)
            compared += found is not None
            assert found in (None, space.count(by)), f"{by} of length {length}, {told}"
    assert compared > number / 2


@pytest.mark.parametrize(
    ("trap", "told"),
    [
        (TRAPS[2], "an aggregate or a condition"),
        (TRAPS[3], "an aggregate or a condition"),
        (TRAPS[4], "the order of their names"),
        (TRAPS[8], "a rule of a step"),
        (TRAPS[13], "the order of their names"),
        (TRAPS[14], "the order of their names"),
        (TRAPS[16], "an action has the name of one of them"),
        ("far(X) :- is_a(X,thing), not near(X). near(X) :- is_a(X,thing), not far(X).", "on itself through `not`"),
        ("{{ lucky(X) : is_a(X,thing) }}.", "a choice or an aggregate in a head"),
        ("alone(X) :- exclusive(X,X).", "exclusive/2 may tell of every entity"),
        ("fluent(h(@f(X))) :- is_a(X,thing).", "a function of a script"),
        ("late(Z) :- is_a(X,thing), is_a(Z,thing), -X < -Z.", "a minus makes other names"),
        ("precondition(a(X),g,true) :- action(a(X)), mark(-X).", "a minus makes other names"),
        ("action(e(-X)) :- is_a(X,thing).", "a minus makes other names"),
    ],
)
def test_what_may_see_entities_that_nobody_names_has_all_of_them_ground(trap: str, told: str) -> None:
    rules = (
        "class(thing). fluent(p(X)) :- is_a(X,thing). action(a(X)) :- is_a(X,thing). action(d). fluent(g). mark(z)."
        "postcondition(a(X),p(X),true) :- action(a(X)). fluent(q(X)) :- is_a(X,thing)."
        f"postcondition(d,g,true). entity(({'; '.join(f'x{n}' for n in range(16))}), thing)."
    )
    found = reduction_of(f"{rules}\n{trap.format(things=16)}", fewest=16)
    assert isinstance(found, str) and told in found


def test_an_entity_that_is_told_apart_is_always_ground() -> None:
    for more in (
        "heavy(c1).",
        "precondition(take(c1), held(c1), false).",
        "#const best = c1. mark(X) :- is_a(X,cube), X != best.",
        "near(c1,c1). initially(held(c1),false).",
    ):
        reduction = cubes(30, more).reduction
        assert isinstance(reduction, Reduction), more
        assert [len(group) for group in reduction.groups] == [29] and "c1" not in map(str, reduction.groups[0])


def test_names_with_a_minus_are_other_names() -> None:
    for more in (
        "heavy(-c1).",
        "heavy(far(-c1)).",
        "heavy(-far(c1)). " + " ".join(f"heavy(far(c{n}))." for n in range(30)),
    ):
        reduction = cubes(30, more).reduction
        assert isinstance(reduction, Reduction), more
        assert [len(group) for group in reduction.groups] == [29] and "c1" not in map(str, reduction.groups[0])
    rules = "late(N) :- level(N), N > -(2-1), N < -1+3. level(-1). level(0)."
    found = cubes(30, rules).reduction
    assert isinstance(found, Reduction) and [len(group) for group in found.groups] == [30]


def test_entities_that_a_pattern_looks_into_are_told_apart() -> None:
    rules = STACKS + "entity(cube(1..20), cube). entity(brick(1..20), cube)."
    alike = load_domain(text=rules).reduction
    assert isinstance(alike, Reduction) and [len(group) for group in alike.groups] == [40]
    looked_into = load_domain(text=f"{rules} right(C) :- is_a(C,cube), C = cube(N), N > 3.").reduction
    assert isinstance(looked_into, Reduction) and {each.name for each in looked_into.groups[0]} == {"brick"}


def test_classes_below_one_another_are_needed_each_for_itself() -> None:
    names = "; ".join(f"b{n}" for n in range(20))
    domain = cubes(20, f"class(red, cube). entity(({names}), red). deep(X) :- is_a(X,red).")
    assert domain.reduction and [len(group) for group in domain.reduction.groups] == [20, 20]
    space = TaskSpace(domain, 1)
    assert space.count("plan") == 40 + 40 * 40
    assert space.count() == 2 + 2 + 4


def test_plans_are_counted_by_a_formula() -> None:
    text = (
        "class(lamp). entity(lamp(1..1000), lamp). fluent(lit(L)) :- is_a(L,lamp). initially(F,false) :- fluent(F)."
        "action(light(L)) :- is_a(L,lamp). precondition(light(L), lit(L), false) :- action(light(L))."
        "postcondition(light(L), lit(L), true) :- action(light(L))."
    )
    spaces = TaskSpace(load_domain(text=text), 0)
    for length in range(6):
        space = spaces.at(length)
        assert (space.count("plan"), space.count(), space.count("skeleton")) == (perm(1000, length), 1, 1)
        assert space.count("plan", ["light"] * min(length, 2)) == perm(1000, length)


EVER = """#include "rules/closed_world.lp". #include "rules/ever.lp". class(lamp).
fluent((lit(L);warm(L);gone(L))) :- is_a(L,lamp). action(light(L)) :- is_a(L,lamp).
action((join(L,M);fly(L,M))) :- is_a(L,lamp), is_a(M,lamp), L != M, ever(lit(L)), ever(warm(M)).
action(fetch(L,M)) :- is_a(L,lamp), is_a(M,lamp), ever(gone(L)).
precondition(fetch(L,M),gone(L),true) :- action(fetch(L,M)).
ever(warm(L)) :- ever(lit(L)). precondition(fly(L,M),warm(M),true) :- action(fly(L,M)).
precondition(light(L),lit(L),false) :- action(light(L)). postcondition(light(L),lit(L),true) :- action(light(L)).
precondition(join(L,M),lit(L),true) :- action(join(L,M)). postcondition(join(L,M),warm(M),true) :- action(join(L,M)).
"""


def test_what_may_ever_be_is_found_with_as_many_as_are_needed() -> None:
    lamps = 200
    domain = load_domain(text=f"{EVER}entity(({'; '.join(f'l{n}' for n in range(lamps))}), lamp).")
    assert domain.reduction
    assert domain.reduction.total(domain.reduction.facts.actions) == lamps + 2 * lamps * (lamps - 1)
    assert TaskSpace(domain, 2).count("plan") == 2 * lamps * (lamps - 1)


def test_a_goal_for_all_entities_needs_as_many_steps() -> None:
    text = (
        "class(lamp). entity(lamp(1..20), lamp). fluent(lit(L)) :- is_a(L,lamp). initially(F,false) :- fluent(F)."
        "action(light(L)) :- is_a(L,lamp). goal(lit(L),true) :- is_a(L,lamp)."
        "postcondition(light(L), lit(L), true) :- action(light(L))."
    )
    space = TaskSpace(load_domain(text=text), 19)
    assert space.domain.reduction and space.count() == 0
    assert space.at(20).count() == 1


def test_every_engine_counts_with_as_many_as_are_needed() -> None:
    domain = cubes(40)
    whole = TaskSpace(domain, 2)
    expected = {by: whole.count(by) for by in LEVELS}
    assert expected["plan"] == 40 * 40 + 40 * 40 + 40 * 39 * 39
    for engine in ENGINES:
        if engine == "sharp" and not find_spec("pyganak"):
            continue
        space = TaskSpace(domain, 2, engine=engine)
        assert {by: space.count(by) for by in LEVELS} == expected, engine


def test_counting_and_checking_never_ground_what_no_plan_names(monkeypatch: pytest.MonkeyPatch) -> None:
    check = reduction_module.check

    def only_fewer(program: Program, given: Source, like: dict[clingo.Symbol, clingo.Symbol] | None = None) -> Checked:
        assert like, "all entities are ground"
        return check(program, given, like)

    monkeypatch.setattr(reduction_module, "check", only_fewer)
    domain = cubes(1000)
    space = TaskSpace(domain, 2)
    assert space.count("plan", ["take"]) == 1000 * 1000
    assert space.count() == TaskSpace(cubes(40), 2).count()


def test_all_but_counts_is_as_with_all_entities_ground(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(load, "find_reduction", partial(find_reduction, fewest=8))
    domain = cubes(9)
    plain = replace(domain, reduction=None)
    assert domain.reduction
    space, other = TaskSpace(domain, 1), TaskSpace(plain, 1)
    assert space.count() == other.count() and space.count("plan") == other.count("plan")
    assert list(space.words("plan")) == list(other.words("plan"))
    assert [str(task) for task in space.sample(5, seed=7)] == [str(task) for task in other.sample(5, seed=7)]
    assert space.count("plan", ["take(c3)"]) == 1
    assert domain == plain or domain.facts == plain.facts


def test_a_limit_tells_no_more_than_there_is() -> None:
    whole = TaskSpace(cubes(40), 3).count("plan")
    for engine in ("automaton", "clingo"):
        with pytest.raises(LimitReached) as reached:
            TaskSpace(cubes(40), 3, engine=engine, limits=Limits(seconds=1e-9)).count("plan")
        assert 0 <= reached.value.at_least <= whole


def test_settings_may_name_an_entity_that_is_not_ground(tmp_path: Path) -> None:
    path = tmp_path / "domain.toml"
    path.write_text("[weights]\nc29 = 2\n")
    names = "; ".join(f"c{n}" for n in range(30))
    domain = load_domain(text=f"entity(({names}), cube).\n{STACKS}", settings=path)
    assert domain.reduction and TaskSpace(domain, 1).count("plan") == 30 + 30 * 30


def test_settings_name_entities_as_they_are_written(tmp_path: Path) -> None:
    """One entity with an argument does not stand for all that are made of the same words."""
    path = tmp_path / "domain.toml"
    path.write_text("[weights]\n'c(29)' = 2\ntake = 7\nc = 3\n")
    domain = load_domain(text=f"entity((c(1..60); c), cube).\n{STACKS}", settings=path)
    assert domain.reduction
    ground = {str(entity) for entity in domain.reduction.facts.entities}
    assert {"c(29)", "c"} <= ground and "c(7)" not in ground and len(ground) < 20


def test_invariants_make_a_program_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    lamps = "class(lamp). entity(lamp(1..300), lamp). fluent(lit(L)) :- is_a(L,lamp). action(light(L)) :- is_a(L,lamp)."
    effect = "postcondition(light(L),lit(L),true) :- is_a(L,lamp)."
    domain = load_domain(text=lamps + effect)
    assert domain.reduction is None and not domain.irreducible
    domain = load_domain(text=f"{lamps}{effect} exclusive(lit(L),lit(M)) :- is_a(L,lamp), is_a(M,lamp), L < M.")
    assert domain.reduction and domain.reduction.size > 300 * 299 / 2


def test_tasks_stand_for_the_renamings_of_units_as_well() -> None:
    """Each arm has its own hand, and of the cubes no more are ground than plans need."""
    domain = load_domain(
        text="""class((arm; hand; cube)). entity((a; b), arm). entity((g; h), hand). hand(a, h). hand(b, g).
        entity(cube(1..20), cube). fluent((held(C,H); moved(A))) :- is_a(C,cube), hand(A,H).
        initially(F,false) :- fluent(F). action((move(A); take(H,C))) :- is_a(C,cube), hand(A,H).
        precondition(take(H,C), held(C,H), false) :- action(take(H,C)).
        postcondition(move(A), moved(A), true) :- action(move(A)).
        precondition(take(H,C), moved(A), true) :- action(take(H,C)), hand(A,H).
        postcondition(take(H,C), held(C,H), true) :- action(take(H,C))."""
    )
    assert domain.reduction, domain.irreducible
    whole = TaskSpace(replace(domain, reduction=None), 0)
    assert len(whole.symmetries.joint) == 1
    for engine in ("automaton", "clingo"):
        for length in range(4):
            for by in LEVELS:
                found = TaskSpace(domain, length, engine=engine).count(by)
                assert found == whole.at(length).count(by), (engine, length, by)
