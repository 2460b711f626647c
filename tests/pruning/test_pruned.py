"""What can never occur is left out: the rest is the same domain as without it, for every engine."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.program.paths import data_folder
from prag_asp.space.plans.readings import Composite
from tests.brute_force import Toy, term
from tests.chance import examples
from tests.domains import domain_of
from tests.pruning import loaded
from tests.space.test_tasks import Schema, orbit, schemas
from tests.spaces import with_engines
from tests.strategies import hierarchies, toys

ENGINES = ("automaton", "clingo", "sat")
FLAG = "fluent(flag). initially(flag,false).\n"
NEVER = {
    "needs_both(x1)": "precondition(needs_both(x1),p(x1),true). precondition(needs_both(x1),p(x1),false).",
    "makes_both(x2)": "postcondition(makes_both(x2),q(x2),true). postcondition(makes_both(x2),q(x2),false).",
    "flagged(x3)": "precondition(flagged(x3),flag,true). postcondition(flagged(x3),p(x3),true).",
    "raises(x1)": "precondition(raises(x1),flag,true). postcondition(raises(x1),p(x2),true).",
    "hoists(x2)": "precondition(hoists(x2),g,(true;false)). postcondition(hoists(x2),flag,true).",
}
"""Actions that can never occur, the last of them the only one that would raise the flag that two others need."""


def pruned(schema: Schema, names: set[str]) -> Schema:
    """Return a schema without some actions."""
    kept = [(name, action) for name, action in zip(schema.names, schema.toy.actions, strict=True) if name not in names]
    toy = replace(schema.toy, actions=tuple(action for _, action in kept))
    return replace(schema, toy=toy, names=tuple(name for name, _ in kept))


@settings(max_examples=examples(8), suppress_health_check=list(HealthCheck))
@given(schemas(), st.sets(st.sampled_from(sorted(NEVER)), min_size=1))
def test_the_rest_is_the_domain_without_them_for_every_engine_and_level(schema: Schema, never: set[str]) -> None:
    more = FLAG + "".join(f"action({name}). {NEVER[name]}\n" for name in sorted(never))
    domain = loaded(f"{schema.text()}\n{more}")
    assume(domain is not None and all(each.name != "no-plan" for each in domain.warnings))
    never_occurring = set(map(str, domain.facts.pruned))
    assert never <= never_occurring
    rest = pruned(schema, never_occurring)
    without = domain_of(f"{rest.text()}\n{FLAG}")
    assert replace(domain.facts, pruned=(), unreachable=(), static=()) == replace(without.facts, static=())
    groups = DomainLogic(without).groups(3)
    assert DomainLogic(domain).groups(3) == groups
    spaces = with_engines(domain, *ENGINES)
    for length in (1, 3):
        plans = schema.plans(length)
        tasks = {orbit(plan, [tuple(map(str, group)) for group in groups]) for plan in plans}
        names = {tuple(action.partition("(")[0] for action in plan) for plan in plans}
        for space in (each.at(length) for each in spaces):
            assert [space.count(level) for level in ("plan", "task", "skeleton")] == [
                len(plans), len(tasks), len(names),
            ]  # fmt: skip
    spaces = [TaskSpace(each, 3) for each in (domain, without)]
    assert list(spaces[0].enumerate("task")) == list(spaces[1].enumerate("task"))
    if spaces[0].count():
        assert spaces[0].statistics() == spaces[1].statistics()
        assert spaces[0].sample(5, seed=1) == [replace(t, domain=domain.name) for t in spaces[1].sample(5, seed=1)]


@settings(max_examples=examples(10), suppress_health_check=list(HealthCheck))
@given(st.booleans().flatmap(lambda closed: st.one_of(toys(closed=closed), hierarchies(closed=closed))))
def test_random_domains_and_hierarchies_count_as_the_definition_says(toy: Toy) -> None:
    domain = loaded(toy.text(), "at_most")
    assume(domain is not None and domain.facts.pruned)
    spaces = with_engines(domain, *ENGINES)
    for length in (0, 2, 3):
        expected = {tuple(term(toy, i) for i in plan): len(set(toy.readings(plan))) for plan in toy.plans(length)}
        for space in (each.at(length) for each in spaces):
            assert space.count("plan") == space.count("task") == len(expected)
            assert set(space.enumerate("plan")) == set(expected)
        space = spaces[0].at(length)
        if toy.composites:
            assert all(space.readings(task).count() == expected[tuple(map(str, task.actions))] for task in space)


def test_composites_with_left_out_actions_are_left_out_and_keep_the_hierarchy() -> None:
    text = """
    fluent(on). fluent(odd). initially(on, false). initially(odd, false).
    action(press). precondition(press, on, false). postcondition(press, on, true).
    action(release). precondition(release, on, true). postcondition(release, on, false).
    action(break). precondition(break, odd, true).
    composite(blink). stage(blink, 1, press). stage(blink, 2, release).
    composite(fail). stage(fail, 1, press). stage(fail, 2, break).
    free(press).
    """
    domain = load_domain(text=text)
    assert [str(each) for each in domain.facts.pruned] == ["break", "fail"]
    assert [warning.text.partition(":")[0] for warning in domain.warnings] == ["break can never occur"]
    for engine in ENGINES:
        assert set(TaskSpace(domain, 2, engine=engine).enumerate("plan")) == {("press", "release")}
        assert TaskSpace(domain, 3, engine=engine).count() == 1
    flat = load_domain(text=text, flat=True).facts
    assert ([str(each) for each in flat.pruned], len(flat.declared_actions)) == (["break"], 3)
    (task,) = TaskSpace(domain, 2)
    (reading,) = TaskSpace(domain, 2).readings(task)
    assert isinstance(reading[0], Composite)


def test_what_is_left_out_may_be_weighed_and_is_told_where_it_is_asked_for(tmp_path: Path) -> None:
    text = """
    fluent(on). initially(on, false).
    action(press). precondition(press, on, false). postcondition(press, on, true).
    action(spin(left)). precondition(spin(left), on, true). precondition(spin(left), on, false).
    """
    (tmp_path / "domain.lp").write_text(text, encoding="utf-8")
    (tmp_path / "domain.toml").write_text(
        '[weights]\nspin = 2\n"spin(left)" = 3\n"press>spin" = 2\n[language]\nspin = "spin {0}"\n'
    )
    space = TaskSpace(load_domain(tmp_path), 1)
    assert [str(task) for task in space.sample(1, seed=1)] == ["press"]
    for ask in (lambda: space.count(prefix=["spin(left)"]), lambda: space.where("has spin").count()):
        with pytest.raises(QueryError, match=r"^spin(\(left\))? can never occur, so it is pruned; prag-asp check"):
            ask()


def test_own_rules_that_unset_a_fluent_keep_what_they_make_possible() -> None:
    text = """
    fluent(held). fluent(down). exclusive(held, down).
    action(lower). precondition(lower, held, true). postcondition(lower, down, true). action(wait).
    """
    assert [str(each) for each in load_domain(text=text).facts.pruned] == ["lower"]
    domain = load_domain(text=f"{text}#program step(t).\nchanged(held,t) :- occurs(lower,t).\n")
    assert domain.warnings == () and domain.facts.pruned == ()
    assert {TaskSpace(domain, 1, engine=engine).count() for engine in ENGINES} == {2}


def test_encodings_that_do_not_know_what_is_left_out_keep_it(tmp_path: Path) -> None:
    encodings = tmp_path / "encodings"
    for source in data_folder("encodings").glob("*.lp"):
        encodings.mkdir(exist_ok=True)
        text = source.read_text(encoding="utf-8").replace(", not _pruned(A)", "").replace("not _pruned(C), ", "")
        (encodings / source.name).write_text(text, encoding="utf-8")
    (tmp_path / "domain.lp").write_text(
        "fluent(on). initially(on,false). action(go). action(no). precondition(no,on,true)."
    )
    domain = load_domain(tmp_path, encodings=encodings)
    assert [each.path.name for each in domain.warnings] == ["reachable.lp", "step.lp"]
    assert domain.facts.pruned == () and len(domain.facts.actions) == 2
    assert TaskSpace(domain, 3).count() == 1


def test_hundreds_of_actions_of_which_half_never_occur_are_left_out() -> None:
    places = 20
    pairs = [(a, b) for a in range(places) for b in range(places)]
    far = {(a, b) for a, b in pairs if a == b or (a * 7 + b * 3) % 2}
    fluents = [f"fluent(at({p})). initially(at({p}),{str(p == 0).lower()})." for p in range(places)]
    fluents += [f"fluent(link({a},{b})). initially(link({a},{b}),{str((a, b) not in far).lower()})." for a, b in pairs]
    every, able = (
        load_domain(
            text="\n".join(fluents)
            + "".join(
                f"action(move({a},{b})). precondition(move({a},{b}),(at({a});link({a},{b})),true). "
                f"postcondition(move({a},{b}),at({a}),false; move({a},{b}),at({b}),true).\n"
                for a, b in moves
            )
        )
        for moves in (pairs, [pair for pair in pairs if pair not in far])
    )
    assert len(every.facts.pruned) == len(every.warnings) == len(far) > 200
    assert replace(every.facts, pruned=()) == able.facts
