"""Counts with the small-model reduction are those with all entities ground."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from math import perm
from pathlib import Path

import clingo
import pytest

from prag_asp import DomainError, LimitReached, TaskSpace, load_domain
from prag_asp.domain import load
from prag_asp.lint import Checked
from prag_asp.program.sources import Program, Source
from prag_asp.reduction import reduction as reduction_module
from prag_asp.reduction.reduction import Reduction, find_reduction
from prag_asp.space import ENGINES
from prag_asp.space.engines.engine import LEVELS
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.reduced_count import ReducedCounter
from tests.chance import Chance
from tests.reduction.lifted import draw_lifted
from tests.reduction.stacks import STACKS, cubes, reduction_of

DOMAINS, PARTS = 40, 4
"""How many domains are drawn; with `pytest --fresh`, ten times as many."""

MOST = 8
"""Things of a domain that are all ground, to compare with; some domains need more."""


@pytest.fixture(autouse=True)
def small_programs_are_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reduction_module, "MANY", 0)


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


def test_classes_below_one_another_are_reduced_separately() -> None:
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


def test_what_may_ever_be_is_found_in_the_reduced_program() -> None:
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


def test_every_engine_counts_with_the_reduction() -> None:
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


def test_everything_but_counts_is_as_with_all_entities_ground(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(load, "find_reduction", partial(find_reduction, fewest=10))
    plain = cubes(9, "% No group is large enough.")
    monkeypatch.setattr(load, "find_reduction", partial(find_reduction, fewest=8))
    domain = cubes(9)
    assert domain.reduction and not plain.reduction
    space, other = TaskSpace(domain, 1), TaskSpace(plain, 1)
    assert space.count() == other.count() and space.count("plan") == other.count("plan")
    assert list(space.enumerate("plan")) == list(other.enumerate("plan"))
    assert [str(task) for task in space.sample(5, seed=7)] == [str(task) for task in other.sample(5, seed=7)]
    assert space.count("plan", ["take(c3)"]) == 1
    assert domain.facts == plain.facts


def test_a_limit_reports_no_more_than_there_is() -> None:
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
