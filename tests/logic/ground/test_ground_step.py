"""What a step is ground for: all that may be carried along, and nothing without end."""

from __future__ import annotations

from math import comb
from typing import Any

import pytest

from prag_asp import EngineError, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.ground.ground_step import GroundStep, extend_step, ground_step
from prag_asp.logic.ground.program import canonical_extension
from prag_asp.logic.ground.stationary import StepReads
from prag_asp.program.facts import Facts
from prag_asp.program.finite import checks
from prag_asp.program.grounding import Grounder
from prag_asp.program.sources import Program
from tests.domains import domain_of
from tests.spaces import with_engines

TWO = "fluent(f). action(a). action(b). postcondition(a,f,true). postcondition(b,f,false). initially(f,false)."
COUNTER = TWO + "\n#program base.\nn(0,0).\n#program step(t).\nn(N+1,t) :- n(N,t-1), occurs(a,t){end}.\n" + (
    "n(N,t) :- n(N,t-1), occurs(b,t). :- n({most},t-1), occurs(a,t).\n"
)  # fmt: skip


def counter(end: str, most: int) -> str:
    return COUNTER.replace("{end}", end).replace("{most}", str(most))


def test_a_counter_without_a_bound_is_told_with_its_line_and_left_to_clingo() -> None:
    domain = domain_of(counter("", 3))
    with pytest.raises(EngineError, match=r"^domain\.lp:5: n/2 takes new values at every step without end; add a cond"):
        TaskSpace(domain, 4, engine="automaton").count("plan")
    told: list[str] = []
    auto = TaskSpace(domain, 5, progress=told.append)
    bounded = TaskSpace(domain_of(counter(", N < 5", 3)), 5, engine="automaton")
    assert [auto.count(by) for by in ("plan", "task")] == [bounded.count(by) for by in ("plan", "task")] == [26, 26]
    assert any("because domain.lp:5: n/2" in words for words in told)
    assert next(iter(auto)).states


def test_a_disjunction_in_the_base_is_a_choice_that_is_left_to_clingo() -> None:
    domain = domain_of(TWO + "x ; y.\n#program step(t).\n:- occurs(a,t), x. :- occurs(b,t), y.")
    with pytest.raises(EngineError, match="the base part makes a choice"):
        TaskSpace(domain, 3, engine="automaton").count("plan")
    assert TaskSpace(domain, 3).count("plan") == TaskSpace(domain, 3, engine="clingo").count("plan") == 2


def test_what_a_step_doubles_is_told_before_it_fills_the_memory() -> None:
    doubled = "\n#program base.\nn(z,0).\n#program step(t).\nn((X,X),t) :- n(X,t-1), occurs(a,t).\n"
    domain = domain_of(f"{TWO}{doubled}n(X,t) :- n(X,t-1), occurs(b,t).")
    with pytest.raises(EngineError, match=r"^domain\.lp:5: n/2 takes new values at every step without end"):
        TaskSpace(domain, 3, engine="automaton").count("plan")
    assert [TaskSpace(domain, length).count("plan") for length in (3, 10)] == [8, 1024]


def test_a_counter_with_a_bound_is_carried_as_far_as_that() -> None:
    model = DomainLogic(domain_of(counter(", N < 70", 70)))
    assert not model.ground.obstacles
    assert sum(symbol.name == "n" for symbol in model.ground.before) == 71
    space = TaskSpace(model.domain, 80, engine="automaton")
    assert space.count("plan") == sum(comb(80, a) for a in range(71))


@pytest.fixture
def few_values(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checks, "MOST_VALUES", 1000)


@pytest.mark.parametrize(("most", "told"), [("900", ""), ("2147483647", "1,000 times")])
def test_a_bound_on_occurrences_takes_work_in_proportion_or_is_left_to_clingo(
    most: str, told: str, few_values: None
) -> None:
    model = DomainLogic(domain_of(f"{TWO} at_most(a,{most}).", "at_most"))
    assert [told in str(each.error()) for each in model.ground.obstacles] == [True] * bool(told)
    carried = sum(symbol.name == "_occurrences" for symbol in model.ground.before)
    assert carried == (0 if told else int(most) + 1)
    assert TaskSpace(model.domain, 5).count("plan") == 2**5


@pytest.mark.parametrize("bound", ["N < 900", "limit(K), N < K", "N < 2147483647"])
def test_a_counter_of_the_author_is_carried_or_told_within_seconds(bound: str, few_values: None) -> None:
    model = DomainLogic(domain_of(f"{TWO} limit(900).{counter(f', {bound}', 900)[len(TWO) :]}"))
    assert bool(model.ground.obstacles) is (bound == "N < 2147483647")
    assert TaskSpace(model.domain, 6).count("plan") == 2**6


def test_what_only_several_carried_atoms_make_together_is_found() -> None:
    # Neither p nor q alone makes r; they come from different first steps, so no single run of steps has them all.
    rules = """
    p(t) :- occurs(a,t). p(t) :- p(t-1). q(t) :- occurs(b,t). q(t) :- q(t-1). r(t) :- p(t-1), q(t-1). r(t) :- r(t-1).
    s(t) :- r(t-1), not p(t-1). s(t) :- r(t-1), occurs(a,t). :- s(t-1), occurs(b,t).
    """
    domain = domain_of(TWO + "\n#program step(t).\n" + rules)
    names = {symbol.name for symbol in DomainLogic(domain).ground.before}
    assert names >= {"p", "q", "r", "s"}
    automaton, clingo = with_engines(domain, "automaton", "clingo")
    for length in range(7):
        assert automaton.at(length).count("plan") == clingo.at(length).count("plan")


NAMED = """class(cup). entity((a; b; c), cup). fluent(full(X)) :- is_a(X,cup). action(fill(X)) :- is_a(X,cup).
precondition(fill(X),full(X),false) :- action(fill(X)). postcondition(fill(X),full(X),true) :- action(fill(X)).
initially(F,false) :- fluent(F).
"""
READING = '#include "rules/canonical_names.lp".'
"""Rules over what the library adds for tasks: they have to be ground together with it."""


@pytest.mark.parametrize(("rules", "extended"), [("", True), (READING, False)], ids=["plain", "reading"])
def test_the_rules_of_tasks_are_ground_on_top_of_the_step_of_plans_unless_a_rule_reads_them(
    rules: str, extended: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps: list[GroundStep] = []

    def ground_step_once(program: Program, facts: Facts, reads: StepReads) -> GroundStep:
        steps.append(ground_step(program, facts, reads))
        return steps[-1]

    monkeypatch.setattr("prag_asp.logic.ground.ground_step.ground_step", ground_step_once)
    logic = DomainLogic(load_domain(text=NAMED + rules))
    transition = logic.transition(tasks=True)
    assert logic.groups(0) and len(steps) == (1 if extended else 2)
    whole = ground_step(logic.task_program(0), logic.domain.facts, logic._reads(logic.task_program(0)))
    ground = transition.step.ground
    assert ground.before.keys() == whole.before.keys() and ground.now.keys() == whole.now.keys()
    assert ground.initial == whole.initial and ground.obstacles == whole.obstacles == ()
    automaton, clingo = with_engines(logic.domain, "automaton", "clingo")
    assert [automaton.at(k).count() for k in range(5)] == [clingo.at(k).count() for k in range(5)] == [1, 1, 1, 1, 0]


def test_a_step_is_extended_once() -> None:
    logic = DomainLogic(load_domain(text=NAMED))
    extension = canonical_extension(logic.domain, logic.groups(0))
    assert extension is not None
    reads = logic._reads(logic.task_program(0))
    assert extend_step(logic.ground, *extension, reads) is not None
    assert extend_step(logic.ground, *extension, reads) is None


CARRYING = "used(t) :- occurs(A,t). used(t) :- used(t-1). :- used(t-1), holds(f,true,t-1)."
NEVER = "used(t) :- never(A), occurs(A,t). used(t) :- used(t-1). :- used(t-1). #defined never/1."


@pytest.mark.parametrize(("rules", "steps"), [("", 1), (NEVER, 1), (CARRYING, 3)], ids=["plain", "never", "carrying"])
def test_a_step_that_carries_only_the_state_is_ground_once(
    rules: str, steps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts: list[str] = []
    ground = Grounder.ground
    monkeypatch.setattr(Grounder, "ground", lambda self, some: parts.extend(p for p, _ in some) or ground(self, some))
    logic = DomainLogic(load_domain(text=f"{TWO}\n#program step(t).\n{rules}"))
    assert any(symbol.name == "used" for symbol in logic.ground.before) == (steps > 1)
    assert parts.count("step") == steps


def test_of_a_step_that_grows_only_the_last_grounding_is_recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[bool] = []

    class Counted(Grounder):
        def __init__(self, program: Program, **options: Any) -> None:
            given.append(options.get("observer") is not None)
            super().__init__(program, **options)

    monkeypatch.setattr("prag_asp.logic.ground.ground_step.Grounder", Counted)
    grown = TaskSpace(domain_of(TWO), 2).where("nontrivial").engines.model.ground
    assert not grown.obstacles and grown.rules["step"]
    assert given[-2:] == [False, True]
