"""Plans of a domain with composites are concatenations of whole composites and of free actions."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import TaskSpace
from tests.brute_force import Toy, term
from tests.domains import domain_of
from tests.strategies import hierarchies

LENGTH = 5


@pytest.mark.slow
@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))
@given(hierarchies(closed=False))
def test_both_engines_agree_with_brute_force_on_open_worlds(toy: Toy) -> None:
    check_agreement(toy)


@pytest.mark.slow
@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))
@given(hierarchies(closed=True))
def test_both_engines_agree_with_brute_force_on_closed_worlds(toy: Toy) -> None:
    check_agreement(toy)


def check_agreement(toy: Toy) -> None:
    domain = domain_of(toy.text(), "at_most")
    spaces = [TaskSpace(domain, 0, engine=engine) for engine in ("automaton", "clingo")]
    for length in range(LENGTH + 1):
        expected = sorted(tuple(term(toy, i) for i in plan) for plan in toy.plans(length))
        names = sorted({tuple(action.partition("(")[0] for action in plan) for plan in expected})
        for space in spaces:
            here = space.at(length)
            assert here.count("plan") == here.count("task") == len(expected)
            assert here.count("skeleton") == len(names)
            if length in (0, 4):
                assert sorted(here.words("plan")) == expected
                assert list(here.words("skeleton")) == names
