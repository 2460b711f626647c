"""What a condition says, not how it is spelled, tells entities apart."""

from __future__ import annotations

import itertools

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import QueryError, TaskSpace
from prag_asp.space.conditions.meaning import weakest
from prag_asp.space.conditions.state_formula import parse_formula
from tests.brute_force import Toy, agrees
from tests.chance import examples
from tests.domains import domain_of

FLUENTS = 4
Formula = tuple[frozenset[tuple[int, bool]], ...]

numbers = st.integers(0, FLUENTS - 1)
pairs = st.lists(st.tuples(numbers, numbers), max_size=4)
literals = st.dictionaries(numbers, st.booleans(), min_size=1, max_size=3)
formulas = st.lists(literals, min_size=1, max_size=4)


def form(toy: Toy, cases: list[dict[int, bool]]) -> list[dict[str, bool]]:
    facts = domain_of(toy.text()).facts
    goal = [(clingo.Function(f"f{f}"), str(v).lower()) for f, v in toy.goal.items()]
    return list(weakest([{f"f{f}": v for f, v in case.items()} for case in cases], goal, facts))


def satisfying(toy: Toy, cases: list[dict[int, bool]]) -> list[tuple[bool, ...]]:
    every = itertools.product((False, True), repeat=FLUENTS)
    return [s for s in every if toy.allowed(s) and agrees(s, toy.goal) and any(agrees(s, dict(c)) for c in cases)]


@settings(max_examples=examples(150))
@given(pairs, pairs, st.dictionaries(numbers, st.booleans(), max_size=1), formulas, formulas)
def test_formulas_have_one_form_where_the_same_states_satisfy_them(
    exclusive: list[tuple[int, int]],
    implies: list[tuple[int, int]],
    goal: dict[int, bool],
    one: list[dict[int, bool]],
    other: list[dict[int, bool]],
) -> None:
    toy = Toy(FLUENTS, (), exclusive=tuple(exclusive), implies=tuple(implies), goal=dict(goal))
    if not any(toy.allowed(s) and agrees(s, toy.goal) for s in itertools.product((False, True), repeat=FLUENTS)):
        return
    for each in (one, other):
        back = [{int(fluent[1:]): value for fluent, value in case.items()} for case in form(toy, each)]
        assert satisfying(toy, back) == satisfying(toy, each)
    assert (form(toy, one) == form(toy, other)) == (satisfying(toy, one) == satisfying(toy, other))


TWO = """
class(c). entity((a;b),c). fluent(f(X)) :- entity(X,c). action((p(X);q(X))) :- entity(X,c).
postcondition(p(X),f(X),true) :- entity(X,c). postcondition(q(X),f(X),false) :- entity(X,c).
"""


@pytest.mark.parametrize(
    "words",
    [
        ["ends f(a) or not f(a)"],
        ["ends (f(a) and f(b)) or (f(a) and not f(b)) or f(b)"],
        ["ends f(a) or f(b)", "ends f(b) or f(a) or not f(a)"],
        ["has at least 0 p(a)"],
        ["uses at least 0 a"],
        ["uses at most 1 b"],
        ["uses at most 2 c"],
        ["uses a", "uses at least 1 b"],
        ["uses a", "uses b"],
        ["has p(a)", "has p(b)"],
        ["has at least 2 p(_)", "ends f(a) or f(b)"],
        ["lacks p(b)", "has at most 0 p(a)", "loop-free"],
        ["after 1: f(a), f(b)", "after 1: f(a)"],
    ],
)
def test_conditions_that_say_the_same_of_two_entities_leave_them_interchangeable(words: list[str]) -> None:
    space = TaskSpace(domain_of(TWO), 2).where(*words)
    plans = set(space.enumerate("plan"))
    swapped = {tuple(a.translate(str.maketrans("ab", "ba")) for a in plan) for plan in plans}
    assert plans == swapped
    orbits = {frozenset({plan, tuple(a.translate(str.maketrans("ab", "ba")) for a in plan)}) for plan in plans}
    assert space.count() == len(orbits) == len(plans) / 2 > 0 or not plans


def test_an_entity_that_all_actions_name_is_not_the_one_that_a_condition_on_its_class_is_about() -> None:
    text = "class(c). entity((a;b),c). action(t(a,b)). action(t(b,a))."
    space = TaskSpace(domain_of(text), 2).where("uses c")
    assert (space.count("plan"), space.count()) == (4, 2)


@pytest.mark.parametrize("words", [["uses a"], ["has at least 1 p(a)", "has at least 2 p(b)"], ["ends f(a)"]])
def test_conditions_that_say_something_of_one_entity_tell_it_apart(words: list[str]) -> None:
    space = TaskSpace(domain_of(TWO), 3).where(*words)
    assert space.count("plan") == space.count() > 0


@pytest.mark.parametrize("words", ["has at least 0 r(a)", "uses at least 0 d", "uses at most 9 d", "avoids d"])
def test_a_condition_that_says_nothing_is_read_nevertheless(words: str) -> None:
    with pytest.raises(QueryError, match="no "):
        TaskSpace(domain_of(TWO), 2).where(words)


def test_a_formula_of_too_many_cases_keeps_its_form() -> None:
    fluents = [f"f{i}" for i in range(10)]
    facts = domain_of(f"fluent(({';'.join(fluents)})). action(a).").facts
    even = [dict(zip(fluents, s, strict=True)) for s in itertools.product((False, True), repeat=10) if sum(s) % 2 == 0]
    assert weakest(even, (), facts) == even
    tautology = parse_formula("f0 or not f0", fluents)
    assert weakest(tautology, (), facts) == [{}]
