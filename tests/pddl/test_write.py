"""Domains and tasks as PDDL have the same plans; other planners' code accepts, solves and validates them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import DomainError, TaskSpace, load_domain, parse_atom
from prag_asp.planners import PddlExport, write
from tests.brute_force import Toy
from tests.chance import examples
from tests.pddl.forward import Search, signed
from tests.pddl.imports import check_plans, counts, searched, written
from tests.pddl.random_tasks import random_task
from tests.pddl.tasks import TASKS
from tests.strategies import toys


def counts_of(found: PddlExport, length: int) -> list[int]:
    return searched(found.domain, found.problem, length)


@pytest.mark.parametrize("name", ["blocks", "hanoi", "kitchen"])
def test_a_domain_that_goes_out_and_comes_in_again_has_the_same_plans(name: str, tmp_path: Path) -> None:
    domain = load_domain(name, flat=True)
    plans = counts(domain, 4)
    for negative in (True, False):
        found = write(domain, negative=negative)
        assert counts(load_domain(*written(tmp_path, found.domain, found.problem)), 4) == plans
        conditions = "".join(line for line in found.domain.splitlines() if ":precondition" in line)
        assert negative or "(not (" not in conditions


@pytest.mark.parametrize("name", TASKS)
def test_pddl_that_comes_in_and_goes_out_again_has_the_same_plans(name: str, tmp_path: Path) -> None:
    domain = load_domain(*written(tmp_path, *TASKS[name]))
    plans = searched(*TASKS[name], 4)
    for negative, conditional in ((True, True), (False, True), (True, False), (False, False)):
        found = write(domain, negative=negative, conditional=conditional)
        assert counts_of(found, 4) == plans
        assert negative or all(positive for _, positive in condition_literals(Search(found.domain, found.problem)))
        assert conditional or not any(each in found.domain + found.problem for each in ("(when ", "(or "))
    assert counts(load_domain(*written(tmp_path, found.domain, found.problem)), 3) == plans[:4]


def condition_literals(search: Search) -> Iterator[tuple[str, bool]]:
    """Yield the predicates of all conditions, and whether each is asserted."""
    yield from signed(search.goal)
    for _, parts in search.actions:
        yield from signed(parts[":precondition"])
        for word, *rest in parts[":effect"][1:]:
            if word == "when":
                yield from signed(rest[0])


@settings(max_examples=examples(10))
@given(seed=integers(0, 10**6))
def test_random_tasks_that_go_out_again_have_the_plans_of_a_forward_search(seed: int, folder: Path) -> None:
    task = random_task(seed)
    domain, plans = load_domain(*written(folder, *task)), searched(*task, 3)
    for conditional in (True, False):
        found = write(domain, negative=conditional, conditional=conditional)
        assert counts_of(found, 3) == plans, f"{seed}\n{found.domain}\n{found.problem}"
        check_plans(folder, found.domain, found.problem, automaton=2, clingo=2, sat=1)


OVER_TIME = """#include "rules/closed_world.lp".
fluent((f;g;h)). action((a;b;c)). postcondition(a,f,true). postcondition(b,f,false). postcondition(c,g,true).
"""


@pytest.mark.parametrize(
    "rules",
    [
        "#program base. water(0,0). #program step(t). water(N+1,t) :- water(N,t-1), not holds(f,true,t-1), N < 3. "
        "water(N,t) :- water(N,t-1), holds(f,true,t-1). :- water(3,t), holds(g,true,t). "
        "#program check(t). :- water(0,t).",
        "#program step(t). changed(h,t) :- holds(f,true,t). holds(h,true,t) :- holds(f,true,t). "
        ":- occurs(c,t), holds(h,true,t-1). "
        ":- occurs(a,t), holds(h,false,t-1), holds(g,true,t-1).",
        "postcondition(a,g,unknown). goal(g,true). precondition(b,h,false). exclusive(f,h). implies(h,g). "
        "#program step(t). :- occurs(a,t), occurs(a,t-1).",
        "#program step(t). holds(h,true,t) :- holds(g,true,t-1). changed(h,t) :- holds(g,true,t-1). "
        ":- 2 #sum { 1,f : holds(f,true,t); 1,g : holds(g,true,t); 2,h : holds(h,true,t), not holds(f,true,t-1) }.",
        "#program step(t). above(t) :- holds(f,true,t), not below(t). below(t) :- holds(g,true,t). "
        "#program check(t). :- not above(t), not holds(h,true,t).",
    ],
)
def test_rules_over_time_become_conditions_and_effects(rules: str) -> None:
    domain = load_domain(text=OVER_TIME + rules)
    plans = counts(domain, 5, "clingo")
    assert any(plans)
    for conditional in (True, False):
        assert counts_of(write(domain, conditional=conditional), 5) == plans


@pytest.mark.parametrize("rules", [("no_undo",), ("at_most(stack,1)", "at_most(pick_up,2)")])
def test_rules_of_the_encodings_go_out_and_a_task_under_them_keeps_its_plan(rules: tuple[str, ...]) -> None:
    domain = load_domain("blocks", rules=rules)
    assert counts_of(write(domain), 4) == counts(domain, 4)
    space = TaskSpace(domain, 4)
    for conditional in (True, False):
        assert reaches(write(domain, space[space.count() // 2], conditional=conditional))


def reaches(task: PddlExport) -> bool:
    search = Search(task.domain, task.problem)
    state = search.start
    for step in task.plan:
        state = dict(search.after(state))[tuple(step.strip("()").split())]
    return search.holds(search.goal, state, {})


CLASHING = """#include "rules/closed_world.lp".
fluent((on;not'on)). action((a;b)). precondition(a,on,false). postcondition(a,on,true).
precondition(b,not'on,false). postcondition(b,not'on,true).
"""


def test_no_predicate_is_named_as_the_opposite_of_another() -> None:
    assert counts_of(write(load_domain(text=CLASHING), negative=False), 3) == [1, 2, 2, 0]


def test_a_task_without_actions_goes_out_where_no_action_can_ever_occur() -> None:
    domain = load_domain(
        text="fluent(f). initially(f,false). action(a). precondition(a,f,true).\n#program step(t). :- occurs(a,t-1)."
    )
    (task,) = TaskSpace(domain, 0)
    for conditional in (True, False):
        assert counts_of(write(domain, task, conditional=conditional), 1) == [1, 0]


def test_actions_of_composites_go_out_with_what_may_come_next() -> None:
    domain = load_domain("kitchen")
    assert counts_of(write(domain), 2) == counts(domain, 2)


def closed(toy: Toy) -> Toy:
    """Return a domain that PDDL can say: all is known, and no rule is over time."""
    initially = {**dict.fromkeys(range(toy.fluents), False), **toy.initially}
    actions = tuple(
        type(each)(each.name, each.before, {f: bool(v) for f, v in each.after.items()}) for each in toy.actions
    )
    return Toy(toy.fluents, actions, initially, toy.exclusive, toy.implies, toy.goal, impossible=toy.impossible)


@settings(max_examples=examples(20))
@given(toy=toys(closed=True))
def test_random_domains_have_the_plans_of_the_definition(toy: Toy) -> None:
    toy = closed(toy)
    try:
        domain = load_domain(text=toy.text())
    except DomainError:
        return
    plans = [len(list(toy.plans(n))) for n in range(4)]
    for negative in (True, False):
        try:
            found = write(domain, negative=negative)
        except DomainError as error:
            assert "breaks an invariant, so there is no plan" in str(error) and not any(plans)
            return
        assert counts_of(found, 3) == plans


@pytest.mark.filterwarnings("ignore")  # those of the packages
@pytest.mark.parametrize(("name", "length"), [("blocks", 4), ("prag", 3), ("two_arms", 3)])
def test_other_planners_accept_solve_and_validate_a_task(name: str, length: int, tmp_path: Path) -> None:
    pytest.importorskip("unified_planning")
    domain = load_domain(name, flat=True)
    space = TaskSpace(domain, length)
    task = space[space.count() // 2]
    found = write(domain, task)
    files, steps = accepted(found, tmp_path)
    plans = {
        tuple((each.name, *each.arguments) for each in one.actions)
        for one in TaskSpace(load_domain(*files), len(steps))
    }
    assert len(steps) <= length and steps in plans
    left_open = len(domain.facts.fluents) > len(task.initial)
    assert ("leaves open" in found.problem) == left_open


@pytest.mark.filterwarnings("ignore")  # those of the packages
@pytest.mark.parametrize("conditional", [True, False])
def test_other_planners_accept_solve_and_validate_conditional_effects(conditional: bool, tmp_path: Path) -> None:
    pytest.importorskip("unified_planning")
    rules = """#program base. water(0,0). #program step(t). water(N+1,t) :- water(N,t-1), not holds(f,true,t-1), N < 3.
        water(N,t) :- water(N,t-1), holds(f,true,t-1). :- occurs(c,t), not water(2,t-1).
        holds(h,true,t) :- moved(t). changed(h,t) :- moved(t). moved(t) :- occurs(b,t), holds(g,true,t-1)."""
    domain = load_domain(text=OVER_TIME + rules)
    space = TaskSpace(domain, 5)
    task = next(each for each in space if str(each.actions[-1]) == "b" and each.states[-1][parse_atom("h")])
    found = write(domain, task, conditional=conditional)
    assert ("(when " in found.domain) == conditional
    _, steps = accepted(found, tmp_path)
    plan = tuple(re.sub(r"_\d+$", "", name) for name, *_ in steps)
    assert plan in {tuple(map(str, each.actions)) for each in TaskSpace(domain, len(plan))}


def accepted(found: PddlExport, folder: Path) -> tuple[tuple[Path, Path], tuple[tuple[str, ...], ...]]:
    """Return the files of an export whose plan unified-planning finds valid, and a plan of Fast Downward."""
    import pddl
    from unified_planning.exceptions import UPNoSuitableEngineAvailableException
    from unified_planning.io import PDDLReader
    from unified_planning.shortcuts import OneshotPlanner, PlanValidator, get_environment

    domain, problem = files = written(folder, found.domain, found.problem)
    (folder / "plan").write_text("\n".join(found.plan))
    assert pddl.parse_domain(domain).name and pddl.parse_problem(problem).goal
    get_environment().credits_stream = None
    reader = PDDLReader()
    read = reader.parse_problem(str(domain), str(problem))
    with PlanValidator(name="sequential_plan_validator") as validator:
        assert validator.validate(read, reader.parse_plan(read, str(folder / "plan"))).status.name == "VALID"
    try:
        with OneshotPlanner(name="fast-downward") as planner:
            plan = planner.solve(read).plan
    except (UPNoSuitableEngineAvailableException, KeyError):
        pytest.skip("Fast Downward is not installed: up-fast-downward")
    steps = ((each.action.name, *map(str, each.actual_parameters)) for each in plan.actions)
    return files, tuple(tuple(word.replace("-", "_") for word in step) for step in steps)


def test_what_pddl_cannot_say_is_refused() -> None:
    rules = {
        "occurs/2 is read at a step other than t and t-1": ":- occurs(a,t), occurs(a,t-2).",
        "the rule reads the number of the step": ":- occurs(a,t), t > 3.",
        "k/2 takes new values at every step without end": "k(N+1,t) :- k(N,t-1).\n#program base.\nk(0,0).",
        "a step chooses more than its action: x(t)": "{ x(t) }. :- x(t), occurs(a,t).",
        "rules of a step depend on their own negation": "x(t) :- not y(t). y(t) :- not x(t). :- x(t), occurs(a,t).",
    }
    for told, rule in rules.items():
        text = f"fluent(f). initially(f,true). action(a). postcondition(a,f,false).\n#program step(t).\n{rule}\n"
        with pytest.raises(DomainError, match=f"^<text>:3: PDDL cannot express this rule over time: {re.escape(told)}"):
            write(load_domain(text=text))
    many = " ".join(f"fluent(f({n})). fluent(g({n}))." for n in range(12))
    text = f"""#include "rules/closed_world.lp". {many} action(a). action(b(N)) :- fluent(f(N)).
        postcondition(b(N),f(N),true) :- action(b(N)).
        #program step(t). holds(g(N),true,t) :- moved(N,t). changed(g(N),t) :- moved(N,t).
        moved(N,t) :- occurs(a,t), holds(f(N),true,t-1)."""
    with pytest.raises(DomainError, match=r"^<text>:3: a depends on 12 fluents, which makes more than 1,000 copies of"):
        write(load_domain(text=text), conditional=False)
    with pytest.raises(DomainError, match="unknown, which PDDL cannot express; let the action make it true or false"):
        write(load_domain(text="fluent(f). initially(f,true). action(a). postcondition(a,f,unknown).\n"))
    with pytest.raises(DomainError, match="prag: its world is open, so it has no initial state that PDDL can express"):
        write(load_domain("prag"))


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
        found = write(domain, task)
        assert reaches(found)
        assert "; Effects that the domain leaves open are what the task needs, and false otherwise." in found.problem
        assert "(on on-2)" in found.domain + found.problem
