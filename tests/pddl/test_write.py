"""Domains and tasks as PDDL have the same plans; other planners' code accepts, solves and validates them."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings

from prag_asp import Domain, DomainError, Task, TaskSpace, load_domain
from prag_asp.pddl import Exported, write
from tests.brute_force import Toy
from tests.chance import examples
from tests.pddl.forward import Search
from tests.pddl.tasks import TASKS
from tests.pddl.test_read import written
from tests.strategies import toys

STRIPS = ("gripper", "blocks", "logistics", "sokoban", "either", "costs")


def exported(domain: Domain, task: Task | None = None, *, negative: bool = True) -> Exported:
    return write(domain.name, domain.program, domain.facts, task, negative=negative)


def counts(domain: Domain, most: int = 4) -> list[int]:
    space = TaskSpace(domain, 0)
    return [space.at(n).count(by="plan") for n in range(most + 1)]


@pytest.mark.parametrize("negative", [True, False])
@pytest.mark.parametrize("name", ["blocks", "hanoi", "kitchen"])
def test_a_domain_that_goes_out_and_comes_in_again_has_the_same_plans(
    name: str, negative: bool, tmp_path: Path
) -> None:
    domain = load_domain(name, flat=True)
    found = exported(domain, negative=negative)
    assert counts(load_domain(*written(tmp_path, found.domain, found.problem))) == counts(domain)
    assert negative or "(not (" not in "".join(line for line in found.domain.splitlines() if ":precondition" in line)


@pytest.mark.parametrize("name", STRIPS)
def test_pddl_that_comes_in_and_goes_out_again_has_the_same_plans(name: str, tmp_path: Path) -> None:
    domain = load_domain(*written(tmp_path, *TASKS[name]))
    found = exported(domain, negative=False)
    assert Search(found.domain, found.problem).count(4) == Search(*TASKS[name]).count(4)
    again = load_domain(*written(tmp_path, found.domain, found.problem))
    assert counts(again, 3) == counts(domain, 3)


def closed(toy: Toy) -> Toy:
    """Return a domain that PDDL can say: all is known, and no rule is over time."""
    initially = {**dict.fromkeys(range(toy.fluents), False), **toy.initially}
    actions = tuple(
        type(each)(each.name, each.before, {f: bool(v) for f, v in each.after.items()}) for each in toy.actions
    )
    return Toy(toy.fluents, actions, initially, toy.exclusive, toy.implies, toy.goal, impossible=toy.impossible)


@settings(max_examples=examples(20))
@given(toy=toys(closed=True))
def test_random_domains_have_the_plans_of_the_definition(toy: Toy, tmp_path_factory: pytest.TempPathFactory) -> None:
    toy = closed(toy)
    try:
        domain = load_domain(text=toy.text())
    except DomainError:
        return
    plans = [len(list(toy.plans(n))) for n in range(4)]
    for negative in (True, False):
        try:
            found = exported(domain, negative=negative)
        except DomainError as error:
            assert "breaks an invariant, so there is no plan" in str(error) and not any(plans)
            return
        assert Search(found.domain, found.problem).count(3) == plans


@pytest.mark.parametrize(("name", "length"), [("blocks", 4), ("prag", 3), ("two_arms", 3)])
def test_other_planners_accept_solve_and_validate_a_task(name: str, length: int, tmp_path: Path) -> None:
    pytest.importorskip("unified_planning")
    domain = load_domain(name, flat=True)
    space = TaskSpace(domain, length)
    task = space[space.count() // 2]
    found = exported(domain, task)
    domain_file, problem_file = written(tmp_path, found.domain, found.problem)
    (tmp_path / "plan").write_text("\n".join(found.plan))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # those packages' own
        status, steps = judged(domain_file, problem_file, tmp_path / "plan")
        import pddl

        assert pddl.parse_domain(domain_file).name and pddl.parse_problem(problem_file).goal
    assert status == "VALID"
    if steps is None:
        pytest.skip("Fast Downward is not installed: up-fast-downward")
    again = load_domain(domain_file, problem_file)
    plan = TaskSpace(again, len(steps))
    assert len(steps) <= length and steps in {tuple(spelled(each) for each in one.actions) for one in plan}
    left_open = len(domain.facts.fluents) > len(task.initial)
    assert ("leaves open" in found.problem) == left_open


def judged(domain: Path, problem: Path, plan: Path) -> tuple[str, tuple[tuple[str, ...], ...] | None]:
    """Return what unified-planning says of a plan, and a plan of Fast Downward's, if there is one."""
    from unified_planning.exceptions import UPNoSuitableEngineAvailableException
    from unified_planning.io import PDDLReader
    from unified_planning.shortcuts import OneshotPlanner, PlanValidator, get_environment

    get_environment().credits_stream = None
    reader = PDDLReader()
    read = reader.parse_problem(str(domain), str(problem))
    with PlanValidator(name="sequential_plan_validator") as validator:
        status = validator.validate(read, reader.parse_plan(read, str(plan))).status.name
    try:
        with OneshotPlanner(name="fast-downward") as planner:
            found = planner.solve(read).plan
    except (UPNoSuitableEngineAvailableException, KeyError):
        return status, None
    steps = tuple((each.action.name, *map(str, each.actual_parameters)) for each in found.actions)
    return status, tuple(tuple(word.replace("-", "_") for word in step) for step in steps)


def spelled(action: Any) -> tuple[str, ...]:
    return (action.name, *action.arguments)


def test_what_pddl_cannot_say_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DomainError, match=r"domain.pddl:4: PDDL cannot say this rule over time; leave it out"):
        exported(load_domain(*written(tmp_path, *TASKS["conditional"])))
    with pytest.raises(DomainError, match=r"no_undo.lp:\d+: PDDL cannot say this rule over time; leave it out"):
        exported(load_domain("blocks", rules=("no_undo",)))
    with pytest.raises(DomainError, match="kitchen: PDDL cannot say which actions make a composite; export with --fl"):
        exported(load_domain("kitchen"))
    with pytest.raises(DomainError, match="unknown, which PDDL cannot say; let the action make it true or false"):
        exported(load_domain(text="fluent(f). initially(f,true). action(a). postcondition(a,f,unknown).\n"))
    with pytest.raises(DomainError, match="prag: its world is open, so it has no first state that PDDL can say"):
        exported(load_domain("prag"))


OPEN = """class(c). entity((on;behind),c). fluent(on(X)) :- entity(X,c). fluent(seen).
initially(seen,false). exclusive(on(on),on(behind)).
action((push(X);take(X))) :- entity(X,c).
postcondition(push(X),on(Y),unknown) :- entity(X,c), entity(Y,c).
precondition(take(X),on(X),true) :- entity(X,c). postcondition(take(X),on(X),false) :- entity(X,c).
postcondition(take(X),seen,true) :- entity(X,c).
"""
"""Open effects, an open start, and an object and a predicate of one name."""


def test_effects_that_are_open_are_what_the_task_needs_and_its_plan_is_one_in_pddl() -> None:
    domain = load_domain(text=OPEN)
    for task in TaskSpace(domain, 2):
        found = exported(domain, task)
        search = Search(found.domain, found.problem)
        state = search.start
        for step in found.plan:
            state = dict(search.after(state))[tuple(step.strip("()").split())]
        assert search.holds(search.goal, state, {})
        assert "; Effects that the domain leaves open are what the task needs, and false otherwise." in found.problem
        assert "(on on-2)" in found.domain + found.problem
