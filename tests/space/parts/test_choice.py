"""Whole pieces come as near to the shares as they can: compared with all choices."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp.space.parts.choice import NEAR, choose_parts, farthest

SHARES = st.sampled_from([("4/5", "1/5"), ("1/2", "1/2"), ("7/10", "2/10", "1/10"), ("99/100", "1/100")])
SIZES = st.lists(st.integers(0, 1000), min_size=1, max_size=7).filter(any)


def distance(parts: tuple[int, ...] | list[int], sizes: list[int], shares: list[Fraction]) -> Fraction:
    sums = [
        sum(size for size, part in zip(sizes, parts, strict=True) if part == number) for number in range(len(shares))
    ]
    return max(abs(Fraction(each, sum(sizes)) - share) for each, share in zip(sums, shares, strict=True))


@given(SIZES, SHARES, st.integers(0, 99))
def test_a_choice_is_near_wherever_one_is_and_else_the_nearest(
    sizes: list[int], told: tuple[str, ...], seed: int
) -> None:
    shares = list(map(Fraction, told))
    chosen = choose_parts(sizes, shares, seed)
    nearest = min(distance(parts, sizes, shares) for parts in product(range(len(shares)), repeat=len(sizes)))
    found = distance(chosen, sizes, shares)
    assert len(chosen) == len(sizes)
    assert found == nearest or nearest <= found <= NEAR


def test_a_choice_depends_on_the_seed_and_on_nothing_else() -> None:
    sizes, shares = [1000 + 7 * size for size in range(60)], [Fraction(4, 5), Fraction(1, 5)]
    choices = {tuple(choose_parts(sizes, shares, seed)) for seed in range(20)}
    assert len(choices) == 20
    assert choose_parts(sizes, shares, 3) == choose_parts(sizes, shares, 3)
    test = [sum(parts[piece] for parts in choices) for piece in range(60)]
    assert min(test) > 0, "every piece is in the test part for some seed"


@pytest.mark.parametrize("sizes", [[5], [0, 0], [1, 10**30]])
def test_sizes_of_any_kind_have_a_distance(sizes: list[int]) -> None:
    shares = [Fraction(1, 2)] * len(sizes)
    assert 0 <= farthest(sizes, shares) <= 1
