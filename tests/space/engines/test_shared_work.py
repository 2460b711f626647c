"""What one level or engine has found, those of the same domain do not look for again."""

from __future__ import annotations

import gc

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.transition import Transition
from prag_asp.program.grounding import Grounder
from prag_asp.program.sources import Program
from prag_asp.space.automaton.exploration import Exploration, explore
from prag_asp.space.engines import clingo_engine, reachability
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.clingo_engine import ClingoEngine
from prag_asp.space.engines.engine import LEVELS
from prag_asp.space.limits import Limits
from tests.domains import domain_of


@pytest.fixture
def explored(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The lengths up to which states are explored."""
    lengths: list[int] = []

    def counted(transition: Transition, length: int, *others: object, **more: object) -> Exploration:
        lengths.append(length)
        return explore(transition, length, *others, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(reachability, "explore", counted)
    return lengths


def test_levels_share_what_is_explored_and_who_listens_or_is_limited_explores_anew(explored: list[int]) -> None:
    domain = load_domain("kitchen")
    model, space = DomainLogic(domain), TaskSpace(domain, 0)
    plans = AutomatonEngine(model, "plan")
    expected = [space.at(length).count("skeleton") for length in (2, 3)]
    explored.clear()
    assert plans.count(2) and explored == [2]
    assert AutomatonEngine(model, "skeleton").count(2) == expected[0] and explored == [2]
    assert plans.count(3) and explored == [2, 3]
    assert AutomatonEngine(model, "skeleton").count(3) == expected[1] and explored == [2, 3]
    said: list[str] = []
    AutomatonEngine(model, "plan", said.append).count(3)
    AutomatonEngine(model, "plan", limits=Limits(seconds=10.0**6)).count(3)
    AutomatonEngine(model, "plan", limits=Limits(memory_bytes=10**15)).count(3)
    assert explored == [2, 3, 3, 3, 3] and said


def test_what_was_explored_up_to_a_length_answers_for_no_other(explored: list[int]) -> None:
    domain = load_domain("kitchen")
    model, space = DomainLogic(domain), TaskSpace(domain, 0)
    known = [space.at(length).count("plan") for length in range(5)]
    explored.clear()
    for length in (2, 4, 1, 0, 3):
        engine = AutomatonEngine(model, "plan")
        assert engine.count(length) == len(list(engine.words(length))) == known[length]
    assert explored == [2, 4, 1, 0, 3]


@pytest.mark.parametrize(("entities", "tasks_are_plans"), [("", True), ("class(c). entity((x; y), c).", False)])
def test_clingo_grounds_plans_and_tasks_once_where_they_are_the_same(
    entities: str, tasks_are_plans: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    domain = domain_of(f"{entities} fluent(f). action(a(x; y)). action(b). postcondition(b,f,true).")
    ground: list[int] = []

    def counted(program: Program, *arguments: str) -> Grounder:
        ground.append(len(arguments))
        return Grounder(program, *arguments)

    expected = {by: list(ClingoEngine(DomainLogic(domain), by).words(3)) for by in LEVELS}
    model = DomainLogic(domain)
    assert bool(model.symmetries(3)) != tasks_are_plans
    monkeypatch.setattr(clingo_engine, "Grounder", counted)
    engines = {by: ClingoEngine(model, by) for by in LEVELS}
    asked = {by: engine.words(3) for by, engine in engines.items()}
    begun = {by: [next(words)] for by, words in asked.items()}
    assert {by: engine.count(3) for by, engine in engines.items()} == {by: len(expected[by]) for by in LEVELS}
    assert {by: [*begun[by], *words] for by, words in asked.items()} == expected
    assert len(ground) == (2 if tasks_are_plans else 3)
    del engines, asked
    gc.collect()
    assert not [key for key in clingo_engine._in_use if key[0] in (id(model.program), id(model.task_program(3)))]
