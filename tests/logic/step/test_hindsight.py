"""What a task tells of its states is true, and enough."""

from __future__ import annotations

import itertools

import clingo
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from prag_asp import Atom, TaskSpace
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.hindsight import solved_states
from tests.brute_force import Action, State, Toy, agrees, term
from tests.chance import examples
from tests.domains import domain_of
from tests.strategies import toys


def trajectories(toy: Toy, plan: tuple[int, ...]) -> list[tuple[State, ...]]:
    """Return all sequences of complete states that execute a plan and reach the goal."""
    paths = [(state,) for state in toy.start()]
    for k, i in enumerate(plan):
        paths = [(*path, s) for path in paths for s in toy.after(frozenset({path[-1]}), plan[:k], i)]
    return [path for path in paths if agrees(path[-1], toy.goal)]


@settings(max_examples=examples(30), suppress_health_check=list(HealthCheck))
@given(toys(closed=False), st.data())
def test_what_is_told_of_a_plan_holds_in_every_execution_and_suffices_for_one(toy: Toy, data: st.DataObject) -> None:
    plans = list(itertools.islice(toy.plans(3), 200))
    assume(plans)
    plan = data.draw(st.sampled_from(plans))
    domain, actions = domain_of(toy.text(), "at_most"), tuple(term(toy, i) for i in plan)
    (task,) = TaskSpace(domain, 3).tasks_of_plans(iter([actions]))
    states = [{str(fluent): value for fluent, value in state.items()} for state in (task.initial, *task.states)]
    told = [{int(fluent[1:]): value for fluent, value in state.items()} for state in states]
    paths = trajectories(toy, plan)
    assert all(agrees(path[k], told[k]) for path in paths for k in range(4))
    everything = itertools.product((False, True), repeat=toy.fluents)
    fitting = {s for s in everything if toy.allowed(s) and agrees(s, told[0])}
    begun = {path[0] for path in paths}
    # What is impossible rules out plans, and tells nothing of states.
    assert begun <= fitting if toy.impossible else begun == fitting
    # Solving the whole plan tells the same as evaluating its steps.
    fluents = domain.facts.fluents
    solved = solved_states(DomainLogic(domain).program, tuple(map(clingo.parse_term, actions)), fluents).T
    assert states == [{str(f): v == 1 for f, v in zip(fluents, row, strict=True) if v >= 0} for row in solved]


def test_a_goal_says_nothing_of_states_before_its_fluent_changed() -> None:
    toy = Toy(1, (Action("a", {}, {}), Action("b", {}, {0: True}), Action("c", {}, {0: False})), goal={0: False})
    (task,) = TaskSpace(domain_of(toy.text()), 3).tasks_of_plans(iter([("a(0)", "b(1)", "c(2)")]))
    assert (task.initial, *(dict(state) for state in task.states)) == (
        {}, {}, {Atom("f0"): True}, {Atom("f0"): False},
    )  # fmt: skip
    assert task.goal == {Atom("f0"): False}
