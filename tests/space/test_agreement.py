"""Both engines agree with the definition, at every level, on random domains."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import TaskSpace
from tests.brute_force import Toy, term
from tests.chance import examples
from tests.domains import domain_of
from tests.spaces import with_engine
from tests.strategies import toys

LENGTH = 4


@pytest.mark.slow
@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(toys(closed=False))
def test_both_engines_agree_with_brute_force_on_open_worlds(toy: Toy) -> None:
    check_agreement(toy)


@pytest.mark.slow
@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(toys(closed=True))
def test_both_engines_agree_with_brute_force_on_closed_worlds(toy: Toy) -> None:
    check_agreement(toy)


def check_agreement(toy: Toy) -> None:
    domain = domain_of(toy.text(), "at_most")
    automaton = TaskSpace(domain, 0, engine="automaton")
    spaces = [automaton, with_engine(automaton, "clingo")]
    for length in range(LENGTH + 1):
        expected = {tuple(term(toy, i) for i in plan) for plan in toy.plans(length)}
        names = {tuple(action.partition("(")[0] for action in plan) for plan in expected}
        for space in spaces:
            here = space.at(length)
            assert here.count("plan") == len(expected)
            assert here.count("skeleton") == len(names)
            if length in (0, 3):
                assert here.count("task") == len(expected)  # no entities are interchangeable: a task is a plan
                plans = list(here.enumerate("plan"))
                assert sorted(plans) == sorted(expected)
                assert list(here.enumerate("skeleton")) == sorted(names)
                assert all(plan in here for plan in plans)


@settings(max_examples=examples(30), suppress_health_check=list(HealthCheck))
@given(toys(closed=False), st.data())
def test_a_prefix_counts_the_plans_that_begin_with_it(toy: Toy, data: st.DataObject) -> None:
    domain = domain_of(toy.text(), "at_most")
    plans = [tuple(term(toy, i) for i in plan) for plan in toy.plans(3)]
    choices = [term(toy, i) for i in range(len(toy.actions))]
    choices += sorted({action.name for action in toy.actions})
    prefix = tuple(data.draw(st.lists(st.sampled_from(choices), max_size=3)))
    expected = sum(all(p in (a, a.partition("(")[0]) for p, a in zip(prefix, plan, strict=False)) for plan in plans)
    automaton = TaskSpace(domain, 3, engine="automaton")
    for space in (automaton, with_engine(automaton, "clingo")):
        assert space.count("plan", prefix) == expected
        assert len(list(space.enumerate("plan", prefix))) == expected
