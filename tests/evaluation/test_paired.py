"""The paired test and interval, beside their definitions by enumeration."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp.evaluation import Pairs
from prag_asp.rl import Rate

COUNTS = st.builds(Pairs, *[st.integers(0, 60)] * 4)


@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize("second", range(6))
def test_the_p_value_is_the_share_of_all_splits_at_least_as_uneven(first: int, second: int) -> None:
    splits = [sum(signs) for signs in product((1, -1), repeat=first + second)]
    share = Fraction(sum(abs(split) >= abs(first - second) for split in splits), len(splits))
    assert Pairs(3, first, second, 2).p_value() == share


@given(COUNTS)
def test_the_interval_has_the_difference_and_turns_round_with_the_order(pairs: Pairs) -> None:
    low, high = pairs.interval()
    assert -1.0 <= low <= float(pairs.difference) <= high <= 1.0
    turned = Pairs(pairs.both, pairs.second, pairs.first, pairs.neither)
    assert turned.interval() == pytest.approx((-high, -low))
    assert turned.p_value() == pairs.p_value()


@given(st.integers(1, 40), st.data())
def test_with_one_sure_success_the_interval_is_that_of_the_other_share(count: int, data: st.DataObject) -> None:
    fails = data.draw(st.integers(0, count))
    pairs = Pairs(count - fails, fails, 0, 0)  # the first always succeeds
    low, high = Rate(count - fails, count).interval()
    sure, _ = Rate(count, count).interval()
    share = 1 - fails / count
    assert pairs.interval() == pytest.approx(
        (max(-1.0, 1 - share - math.hypot(1 - sure, high - share)), min(1.0, 1 - low))
    )


@pytest.mark.parametrize("probabilities", [(0.4, 0.1, 0.1, 0.4), (0.5, 0.2, 0.05, 0.25), (0.1, 0.3, 0.3, 0.3)])
def test_the_interval_covers_the_true_difference_as_often_as_it_says(probabilities: tuple[float, ...]) -> None:
    count, covered = 25, 0.0
    for both, first, second in product(range(count + 1), repeat=3):
        neither = count - both - first - second
        if neither >= 0:
            pairs = Pairs(both, first, second, neither)
            ways = math.factorial(count)
            for number in pairs:
                ways //= math.factorial(number)
            low, high = pairs.interval()
            if low <= probabilities[1] - probabilities[2] <= high:
                covered += ways * math.prod(p**number for p, number in zip(probabilities, pairs, strict=True))
    assert 0.93 < covered < 0.985
