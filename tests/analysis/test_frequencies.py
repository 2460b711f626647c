"""Frequencies stand beside exact expected ones, and the test of them is calibrated."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from math import erfc, exp, factorial, inf, sqrt

import numpy as np
import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.analysis import compare_frequencies
from prag_asp.analysis.frequencies import rank, upper_tail
from tests.analysis.orbit_spaces import orbit_spaces
from tests.chance import Chance
from tests.domains import domain_of


def test_the_tail_is_that_of_closed_forms() -> None:
    for statistic in (0.01, 0.5, 3.0, 17.5, 60.0, 400.0):
        assert upper_tail(1, statistic) == pytest.approx(erfc(sqrt(statistic / 2)), rel=1e-10)
        for half in (1, 2, 9, 40):
            closed = exp(-statistic / 2) * sum((statistic / 2) ** k / factorial(k) for k in range(half))
            assert upper_tail(2 * half, statistic) == pytest.approx(closed, rel=1e-10)
    assert (upper_tail(3, 0.0), upper_tail(3, inf), upper_tail(0, 0.0), upper_tail(0, inf)) == (1, 0, 1, 0)


def test_expected_numbers_and_covariances_are_those_of_a_list(chance: Chance) -> None:
    for case, space, _ in orbit_spaces(chance, 8, 3):
        words = list(space.enumerate("task"))
        tasks = [words[0], words[-1], words[0]]
        found = compare_frequencies(space, tasks, "actions")
        actions = [each.value for each in found.frequencies]
        counts = np.array([[word.count(action) for action in actions] for word in words])
        mean = [Fraction(int(total), len(words)) for total in counts.sum(axis=0)]
        seen = Counter(action for task in tasks for action in task)
        assert [each.expected for each in found.frequencies] == [3 * each for each in mean], case.text()
        assert {each.value: each.observed for each in found.frequencies} == {a: seen[a] for a in actions}
        covariance = np.cov(counts.T, bias=True).reshape(len(actions), -1)
        assert found.degrees == np.linalg.matrix_rank(covariance, tol=1e-9)
        apart = np.array([float(each.observed - each.expected) for each in found.frequencies])
        statistic = apart @ np.linalg.pinv(covariance, rcond=1e-9) @ apart / 3
        assert found.statistic == pytest.approx(statistic, abs=1e-6)


def test_p_values_of_uniform_samples_are_uniform_and_those_of_others_are_not(chance: Chance) -> None:
    space = TaskSpace(load_domain("prag"), 6)
    found = [compare_frequencies(space, space.sample(100, seed=chance.seed(n))).p_value for n in range(24)]
    assert 3 <= sum(p < 0.5 for p in found) <= 21  # further away once in 28,000 runs
    weighted = space.sample(300, seed=1, weights={"rotate": 3})
    far = compare_frequencies(space, weighted)
    assert far.p_value < 1e-9 and far.few == 0 and far.degrees == 7


def test_what_the_space_cannot_have_has_no_chance() -> None:
    two = TaskSpace(domain_of("fluent(f). action(a). action(b). postcondition(a,f,true). postcondition(b,f,true)."), 2)
    found = compare_frequencies(two.where("lacks b"), [("a", "b")])
    assert found.statistic == inf and found.p_value == 0
    alone = compare_frequencies(two.where("lacks b"), [("a", "a")])
    assert (alone.statistic, alone.degrees, alone.p_value) == (0, 0, 1)


def test_the_rank_is_exact_for_integers_of_any_size() -> None:
    big = np.array([[10**30, 2 * 10**30, 1], [3 * 10**30, 6 * 10**30, 3], [0, 0, 5]], dtype=object)
    assert rank(big) == 2 and rank(np.zeros((2, 2), dtype=object)) == 0
