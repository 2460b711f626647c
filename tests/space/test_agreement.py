"""Engines agree with the definition, at every level, on random domains under random conditions."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import TaskSpace
from tests.brute_force import Toy, term
from tests.chance import examples
from tests.conditions import achieves, clauses, ends, entities, satisfied
from tests.domains import domain_of
from tests.spaces import with_engine
from tests.strategies import hierarchies, toys

LONGEST = {"automaton": 5, "clingo": 5, "sat": 4, "symbolic": 3}
"""The largest length of words that an engine is asked for; only composites need more than 4 actions."""


@pytest.mark.slow
@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(
    st.one_of(*(toys_of(closed=closed) for toys_of in (toys, hierarchies) for closed in (False, True))),
    st.data(),
)
def test_engines_agree_with_brute_force_at_every_level_under_conditions(toy: Toy, data: st.DataObject) -> None:
    kinds = st.one_of(clauses(toy), st.one_of(ends(toy), achieves(toy)))
    asked = [] if toy.composites else data.draw(st.lists(kinds, max_size=3))
    domain = domain_of(toy.text() + "#program base.\n" + entities(toy), "at_most")
    automaton = TaskSpace(domain, 0, engine="automaton").where(*(clause.words for clause in asked))
    spaces = {engine: with_engine(automaton, engine) for engine in LONGEST}
    for length in range(6 if toy.composites else 5):
        plans = [plan for plan in toy.plans(length) if satisfied(toy, plan, asked)]
        expected = sorted(tuple(term(toy, i) for i in plan) for plan in plans)
        names = sorted({tuple(action.partition("(")[0] for action in plan) for plan in expected})
        word = tuple(term(toy, data.draw(st.integers(0, len(toy.actions) - 1))) for _ in range(length))
        rank = data.draw(st.integers(0, max(len(expected) - 1, 0)))
        for engine, space in spaces.items():
            if length > LONGEST[engine]:
                continue
            here = space.at(length)
            assert [here.count("plan"), here.count("skeleton")] == [len(expected), len(names)], engine
            assert (word in here) == (word in expected), engine
            if length in (0, 3):
                assert here.count("task") == len(expected), engine  # no entities are interchangeable
                assert list(here.enumerate("plan")) == expected, engine
                assert list(here.enumerate("skeleton")) == names, engine
                assert all(plan in here for plan in expected), engine
                if expected:
                    assert tuple(map(str, here[rank].actions)) == expected[rank], engine
                    assert here.index(here[rank]) == rank and here[rank - len(expected)] == here[rank], engine


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
