"""Power: sums over all results of small samples, published values, and what the command prints."""

from __future__ import annotations

import itertools
import json
import math
from fractions import Fraction

import numpy as np
import pytest

from prag_asp.errors import QueryError
from prag_asp.evaluation import ComparisonDesign
from prag_asp.evaluation.exact_power import (
    fisher_critical_values,
    paired_power,
    sign_test_critical_values,
    unpaired_power,
)
from tests.cli.conftest import Told, told  # noqa: F401 - a fixture


def fisher_p_value(one: int, two: int, size: int) -> Fraction:
    """Return the two-sided p-value of Fisher's test: the tables of the same total that are no more probable."""
    total = one + two
    ways = [math.comb(size, k) * math.comb(size, total - k) for k in range(total + 1)]
    return Fraction(sum(each for each in ways if each <= ways[one]), sum(ways))


def mcnemar_p_value(one: int, two: int) -> Fraction:
    """Return the two-sided p-value of the sign test: the splits that are no more probable."""
    ways = [math.comb(one + two, k) for k in range(one + two + 1)]
    return Fraction(sum(each for each in ways if each <= ways[one]), sum(ways))


def binomial(size: int, number: int, probability: Fraction) -> Fraction:
    return math.comb(size, number) * probability**number * (1 - probability) ** (size - number)


def fisher_power(size: int, first: Fraction, second: Fraction, alpha: Fraction) -> Fraction:
    """Return the power as a sum over all pairs of results, in fractions."""
    return sum(
        (
            binomial(size, one, first) * binomial(size, two, second)
            for one, two in itertools.product(range(size + 1), repeat=2)
            if fisher_p_value(one, two, size) <= alpha
        ),
        Fraction(0),
    )


def mcnemar_power(size: int, first: Fraction, second: Fraction, alpha: Fraction) -> Fraction:
    """Return the power as a sum over all numbers of scenarios in which one policy alone succeeds, in fractions."""
    found = Fraction(0)
    for one in range(size + 1):
        for two in range(size + 1 - one):
            if mcnemar_p_value(one, two) <= alpha:
                ways = math.comb(size, one) * math.comb(size - one, two)
                found += ways * first**one * second**two * (1 - first - second) ** (size - one - two)
    return found


RATES = ((Fraction(1, 2), Fraction(9, 10)), (Fraction(0), Fraction(1, 3)), (Fraction(1), Fraction(1, 5)))
LEVELS = (Fraction(1, 20), Fraction(1, 16), Fraction(1, 10), Fraction(1, 35))
"""Levels of significance; 1/16 and 1/35 are p-values of small tables, where a float may fall on the wrong side."""


@pytest.mark.parametrize("size", [1, 4, 5, 13])
def test_power_is_the_sum_over_all_results_of_small_samples(size: int) -> None:
    for (first, second), alpha in itertools.product(RATES, LEVELS):
        expected = float(fisher_power(size, first, second, alpha))
        assert unpaired_power(size, float(first), float(second), alpha) == pytest.approx(expected, abs=1e-12)
        one, two = first / 2, second / 2
        expected = float(mcnemar_power(size, one, two, alpha))
        assert paired_power(size, float(one), float(two), alpha) == pytest.approx(expected, abs=1e-12)


def test_integers_and_floats_reject_the_same_results(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes, level = np.arange(1, 81), Fraction(1, 20)
    fisher, mcnemar = fisher_critical_values(40, sizes, level), sign_test_critical_values(sizes, level)
    monkeypatch.setattr("prag_asp.evaluation.exact_power.CLOSE", 0.99)  # integers decide nearly everywhere
    assert (fisher_critical_values(40, sizes, level) == fisher).all()
    assert (sign_test_critical_values(sizes, level) == mcnemar).all()


def test_powers_and_numbers_of_scenarios_are_the_published_ones() -> None:
    # R package pwrss (checked by its authors with G*Power and PASS): Fisher's test, McNemar's test
    assert ComparisonDesign(rate=0.4).power(50, 0.2) == pytest.approx(0.462, abs=5e-4)
    assert ComparisonDesign(0.45, discordant=0.3).scenarios(0.1) == 249
    assert ComparisonDesign(0.45, correlation=0.4141414).power(249, 0.1) == pytest.approx(0.801, abs=5e-4)
    # manual of G*Power 3.1, example of McNemar's test, one-sided at 0.05; two sides at 0.1 add at most 2e-5
    assert paired_power(50, 0.08, 0.32, Fraction(1, 10)) == pytest.approx(0.839343, abs=2e-5)


def test_the_number_of_scenarios_and_its_successors_reach_the_power() -> None:
    design = ComparisonDesign("0.4", discordant=1)  # all results differ: the power of the sign test is a saw
    number = design.scenarios(0.2)
    powers = [design.power(each, 0.2) for each in range(1, number + 31)]
    assert powers[number - 2] < 0.8 <= min(powers[number - 1 :])
    assert max(powers[: number - 1]) >= 0.8, "an earlier number reaches the power, but not those after it"


def test_the_smallest_effect_is_the_first_that_reaches_the_power() -> None:
    for design in (ComparisonDesign(), ComparisonDesign("1/4", correlation="1/2"), ComparisonDesign(discordant="0.2")):
        effect = design.smallest_effect(200, 0.9)
        assert effect is not None
        assert design.power(200, effect - Fraction(1, 10_000)) < 0.9 <= design.power(200, effect)
    assert ComparisonDesign(rate="0.95").smallest_effect(50) is None
    assert ComparisonDesign(rate=1).smallest_effect(50) is None


def test_a_correlation_is_that_of_the_two_results() -> None:
    one, two = ComparisonDesign(0.5, correlation=0), ComparisonDesign(0.5, discordant=0.5)
    assert one.power(60, 0.2) == pytest.approx(two.power(60, 0.2), abs=1e-12)
    assert ComparisonDesign(0.5, correlation=0.5).power(60, 0.2) > one.power(60, 0.2)


def test_few_tasks_need_fewer_scenarios() -> None:
    # Cochran, Sampling Techniques (1977), section 4.4: n = n0 / (1 + (n0 - 1) / N)
    number, few = ComparisonDesign().scenarios(0.2), ComparisonDesign(tasks=600)
    assert few.scenarios(0.2) == math.ceil(number / (1 + (number - 1) / 600)) < number
    assert ComparisonDesign(tasks=10**9).scenarios(0.2) == number
    assert few.power(few.scenarios(0.2), 0.2) >= 0.8
    assert (few.power(600, 0.01), few.power(600, 0), few.half_width(600)) == (1.0, 0.0, 0.0)
    assert few.smallest_effect(600) == Fraction(1, 600)
    assert few.half_width(300) < ComparisonDesign().half_width(300)


def test_the_half_width_is_that_of_an_interval_of_wilson() -> None:
    # Newcombe, Statistics in Medicine 17 (1998), table I: 81 of 263, from 0.2553 to 0.3662
    half = ComparisonDesign(rate=Fraction(81, 263)).half_width(263)
    assert half == pytest.approx((0.3662 - 0.2553) / 2, abs=5e-5)


@pytest.mark.parametrize(
    ("design", "words"),
    [
        ({"rate": 1.5}, "rate 1.5 is not between 0 and 1"),
        ({"rate": "half"}, "not an exact number"),
        ({"alpha": 0}, "alpha 0 is not between 1e-06 and 0.5"),
        ({"correlation": 0.2, "discordant": 0.2}, "leave one of them out"),
        ({"tasks": 0}, "a space has at least 1 task; got 0"),
    ],
)
def test_impossible_designs_are_refused(design: dict[str, float], words: str) -> None:
    with pytest.raises(QueryError, match=words):
        ComparisonDesign(**design)  # type: ignore[arg-type]


def test_impossible_effects_and_numbers_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.evaluation.power.MOST", 300)
    for design, effect, words in (
        (ComparisonDesign(0.9), 0.2, "leads from the rate 0.9 to 1.1"),
        (ComparisonDesign(0.9, correlation=0.9), 0.1, "correlation 0.9 is impossible for rates of 0.9 and 1"),
        (ComparisonDesign(discordant=0.1), 0.2, "discordant 0.1 is impossible"),
        (ComparisonDesign(), 0, "no number of scenarios shows an effect of 0"),
        (ComparisonDesign(), 0.01, "an effect of 0.01 needs more than 300 scenarios"),
    ):
        with pytest.raises(QueryError, match=words):
            design.scenarios(effect)


def test_a_power_of_one_needs_all_tasks() -> None:
    with pytest.raises(QueryError, match="no number of scenarios gives a power of 1"):
        ComparisonDesign().scenarios(0.05, power=1)
    assert ComparisonDesign(tasks=20).scenarios(0.05, power=1) == 20


def test_more_scenarios_than_tasks_are_refused() -> None:
    with pytest.raises(QueryError, match="21 scenarios are more than the 20 tasks"):
        ComparisonDesign(tasks=20).power(21, 0.1)


def test_the_command_prints_what_the_design_says(told: Told) -> None:  # noqa: F811
    table = told("power", "--effect", "0.1", "--power", "0.8", "--paired", "0.5")
    assert [line.split()[-1] for line in table.splitlines()] == ["test", "211", "0.8013"]
    found = json.loads(told("power", "--scenarios", "500", "--effect", "0.1", "--format", "json"))
    assert found["power"] == pytest.approx(ComparisonDesign().power(500, 0.1))
    assert found["smallest_effect"] == 0.0894 and round(found["half_width"], 4) == 0.0437
    assert "nothing to compute" in told("power", code=2)
    assert "none" in told("power", "--scenarios", "50", "--rate", "0.95")
