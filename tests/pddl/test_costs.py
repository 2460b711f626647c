"""Costs become weights exactly, or are refused."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest

from prag_asp.errors import QueryError
from prag_asp.pddl import read
from prag_asp.pddl.costs import factor_of, weight_of_cost
from tests.pddl.imports import written


def test_weights_are_powers_of_the_factor() -> None:
    assert weight_of_cost(Fraction(1, 4), Decimal(3)) == Decimal("0.015625")


@pytest.mark.parametrize(
    ("factor", "cost", "message"),
    [
        (Fraction(1, 2), Decimal("0.5"), "cost 0.5: only integer costs become weights"),
        (Fraction(1, 2), Decimal(9999), "factor 1/2: its power 9999 has 9,999 digits, more than the limit of 2,000"),
        (Fraction(1, 3), Decimal(2), "factor 1/3: its power 2 has no finite decimal expansion"),
        (Fraction(1, 2), Decimal(10**20), "cost 1.00000e.20: costs above 10000 cannot become weights; divide all"),
    ],
)
def test_costs_that_are_no_exact_weights_are_refused(factor: Fraction, cost: Decimal, message: str) -> None:
    with pytest.raises(QueryError, match=message):
        weight_of_cost(factor, cost)


@pytest.mark.parametrize("factor", ["1e-9999999", "1e-9_999_999", "1/" + "3" * 10**6, "0." + "1" * 10**6])
def test_a_factor_that_has_millions_of_digits_is_refused_before_it_is_computed(factor: str) -> None:
    with pytest.raises(QueryError, match=r"it has too many digits; write a shorter one, such as 1/2 or 0.8"):
        factor_of(factor)


def test_costs_with_many_digits_are_summed_exactly(tmp_path: Path) -> None:
    long, short = "1" + "0" * 40, "0." + "0" * 30 + "1"
    domain = f"""(define (domain d) (:predicates (p)) (:functions (total-cost) (far))
        (:action go :effect (and (p) (increase (total-cost) {long}) (increase (total-cost) (far)))))"""
    problem = f"(define (problem e) (:domain d) (:init (= (far) {short})) (:goal (p)))"
    assert Fraction(read(*written(tmp_path, domain, problem)).cost("go", ())) == 10**40 + Fraction(1, 10**31)
