"""Costs become weights exactly, or are refused."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import pytest

from prag_asp.errors import QueryError
from prag_asp.pddl.costs import weight_of_cost


def test_weights_are_powers_of_the_factor() -> None:
    assert weight_of_cost(Fraction(1, 4), Decimal(3)) == Decimal("0.015625")


@pytest.mark.parametrize(
    ("factor", "cost", "told"),
    [
        (Fraction(1, 2), Decimal("0.5"), "cost 0.5: only whole costs become weights"),
        (Fraction(1, 2), Decimal(9999), "factor 1/2: to the power of 9999 it has no end as a decimal"),
        (Fraction(1, 2), Decimal(10**20), "cost 1.00000e.20: costs up to 10000 become weights; divide all by the same"),
    ],
)
def test_costs_that_are_no_exact_weights_are_refused(factor: Fraction, cost: Decimal, told: str) -> None:
    with pytest.raises(QueryError, match=told):
        weight_of_cost(factor, cost)
