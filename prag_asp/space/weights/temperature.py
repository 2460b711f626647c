"""The temperature of weights: from the weights themselves (exploitation) to equal weights (exploration)."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from typing import TypeVar

from prag_asp.errors import QueryError
from prag_asp.exact_numbers import Number, parse_number
from prag_asp.integers import shortened
from prag_asp.space.weights.weights import Weights

INFINITE = "inf"
LARGEST_DENOMINATOR = 10_000
DIGITS = 40
"""Digits after the decimal point: far more than are needed to distinguish fractions with denominators of at most
`LARGEST_DENOMINATOR`."""

LARGEST_EXPONENT = 1000
"""Largest decimal exponent of a weight."""

MOST_BITS = 40_000
"""Maximum number of bits, about 12,000 digits, of the numerator and of the denominator of an exact power.

Counts multiply such numbers for each step of a plan.
"""

Key = TypeVar("Key")

Temperature = Number
"""A number above 0, or ``inf``."""


def tempered(weights: Weights, temperature: Temperature) -> Weights:
    """Return the weights at a temperature T: each weight w becomes about w^(1/T).

    The weight of an entity already includes the weights of its classes. T = 1 keeps the weights, T below 1 sharpens
    them, and T = ``inf`` makes all positive weights equal; 0 stays 0.

    Powers with whole exponents are exact if they have at most about 12,000 digits. Other powers above 1 are rounded to
    the nearest fraction with a denominator of at most 10000; powers below 1 are the inverse of the rounded inverse.
    Decimal arithmetic makes the result the same on every machine, and all later computations are exact.

    Raises:
        QueryError: the temperature is not a number above 0, or too low.
    """
    exponent = Fraction(0)
    if temperature != INFINITE:
        number = parse_number("temperature", temperature)
        if number <= 0:
            raise QueryError(f"temperature {temperature}: write a number above 0, or {INFINITE} for uniform sampling")
        exponent = 1 / number

    def powers(stated: Mapping[Key, Fraction]) -> dict[Key, Fraction]:
        raised = {key: power(weight, exponent) for key, weight in stated.items()}
        return {key: weight for key, weight in raised.items() if weight != 1}

    return Weights(powers(weights.names), powers(weights.pairs), powers(weights.actions), powers(weights.entities))


def power(weight: Fraction, exponent: Fraction, *, inverse: bool = False) -> Fraction:
    """Return `weight` to the power of an exponent of at least 0, rounded as in `tempered`.

    With `inverse`, an error names 1/`weight`.

    Raises:
        QueryError: the power has more than 1000 digits.
    """
    if weight in (0, 1):
        return weight
    if weight < 1:
        return 1 / power(1 / weight, exponent, inverse=True)
    with localcontext(Context(prec=2 * DIGITS, Emax=10**9, Emin=-(10**9))) as context:
        logarithm = (Decimal(weight.numerator) / weight.denominator).ln() * exponent.numerator / exponent.denominator
        size = int(logarithm / Decimal(10).ln())
        if size > LARGEST_EXPONENT:
            given, raised = shortened(str(1 / weight if inverse else weight)), shortened(str(exponent))
            what = f"a weight of {given} to the power of {raised} is too {'small' if inverse else 'large'}"
            raise QueryError(f"{what}; raise the temperature")
        bits = max(weight.numerator.bit_length(), weight.denominator.bit_length())
        if exponent.denominator == 1 and bits * exponent.numerator <= MOST_BITS:
            return weight**exponent.numerator
        context.prec = size + 2 * DIGITS
        base = Decimal(weight.numerator) / weight.denominator
        exact = (base.ln() * exponent.numerator / exponent.denominator).exp()
        return Fraction(exact.quantize(Decimal(1).scaleb(-DIGITS))).limit_denominator(LARGEST_DENOMINATOR)
