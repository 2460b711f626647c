"""A temperature turns weights into powers: exactly where it can, else into the nearest fractions."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.space.weights.temperature import LARGEST_DENOMINATOR, power, tempered
from prag_asp.space.weights.weights import Weights

DOMAIN = load_domain("prag")


def test_one_leaves_weights_below_one_sharpens_them_and_infinity_makes_them_alike() -> None:
    weights = TaskSpace(DOMAIN, 2).weights({"grasp": 3, "grasp>move": "1/2", "can": 5, "drop": 0})
    assert tempered(weights, 1) == weights
    sharp = tempered(weights, "1/3")
    assert sharp.names == {"grasp": 27, "drop": 0} and sharp.pairs == {("grasp", "move"): Fraction(1, 8)}
    alike = tempered(weights, "inf")
    assert alike.names == {"drop": 0} and not alike.pairs and not alike.entities  # 1 is not a weight


@given(st.fractions(Fraction(1, 50), 50).filter(bool), st.integers(2, 4))
def test_a_root_is_the_nearest_fraction(weight: Fraction, root: int) -> None:
    found = power(weight, Fraction(1, root))
    if weight < 1:
        assert found == 1 / power(1 / weight, Fraction(1, root))
        return
    assert found.denominator <= LARGEST_DENOMINATOR
    for denominator in (*range(1, 60), LARGEST_DENOMINATOR - 1, LARGEST_DENOMINATOR):
        near = Fraction(int(float(weight) ** (1 / root) * denominator), denominator)
        for other in (near, near + Fraction(1, denominator)):
            # Nearer means that the root lies on this side of the middle: compare powers, which are exact.
            middle = ((other + found) / 2) ** root
            assert other == found or (middle >= weight if other > found else middle <= weight)


def test_a_root_that_is_a_fraction_is_found() -> None:
    assert power(Fraction(9, 4), Fraction(1, 2)) == Fraction(3, 2)
    assert power(Fraction(4, 9), Fraction(3, 2)) == Fraction(8, 27)
    assert power(Fraction(10) ** 900, Fraction(1, 2)) == Fraction(10) ** 450


@pytest.mark.parametrize(
    ("temperature", "message"),
    [
        (0, "above 0"),
        ("-1", "above 0"),
        ("warm", "not an exact number"),
        (0.5, "not an exact number"),
        ("1/9999", "too large"),
    ],
)
def test_a_temperature_that_means_nothing_is_refused(temperature: object, message: str) -> None:
    with pytest.raises(QueryError, match=message):
        TaskSpace(DOMAIN, 2).sample(1, seed=0, weights={"grasp": 3}, temperature=temperature)  # type: ignore[arg-type]


def test_powers_with_too_many_digits_are_rounded() -> None:
    """(1 + 1/10^8)^(10^6) is about 1 + 1/100, and exact it has 8 million digits."""
    raised = power(Fraction(10**8 + 1, 10**8), Fraction(10**6))
    assert raised.denominator <= LARGEST_DENOMINATOR and abs(raised - Fraction(10100501, 10**7)) < Fraction(1, 10**5)
    assert power(Fraction(3, 2), Fraction(600)) == Fraction(3, 2) ** 600


def test_weights_whose_totals_are_too_long_are_refused() -> None:
    digits = "1." + "3" * 600
    space = TaskSpace(DOMAIN, 3)
    assert space.sample(1, seed=1, weights={"grasp": digits})
    with pytest.raises(QueryError, match=r"the weights have 59\d digits together, .* at length 1,000; round them"):
        space.at(1000).sample(1, seed=1, weights={"grasp": digits})


@pytest.mark.parametrize(
    ("weight", "told"), [(10**300, "0{19}... .301 digits. .*large"), (Fraction(1, 3), "1/3 .*small")]
)
def test_a_power_that_is_out_of_range_is_told_with_the_weight_in_short(weight: int | Fraction, told: str) -> None:
    with pytest.raises(QueryError, match=told) as raised:
        tempered(Weights({"a": Fraction(weight)}), "1/9999")
    assert len(str(raised.value)) < 160
