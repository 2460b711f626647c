"""Parse exact numbers as authors write them, and return them as fractions, without expanding huge exponents."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction

from prag_asp.errors import QueryError
from prag_asp.integers import shortened

Number = int | Fraction | Decimal | str

MAX_EXPONENT = 1000
"""The maximum number of digits before and after the decimal point."""

EXPONENT = re.compile(r"[-+]?(?P<digits>[\d_.]*)(?:[eE](?P<exponent>[-+]?\d{1,18}))?\d*")
"""The pattern of a number; only the first 18 digits of its exponent are read."""


def parse_number(what: str, number: Number) -> Fraction:
    """Return an exact number as a fraction, read from decimal digits or from p/q; `what` names it in errors.

    Raises:
        QueryError: the value is not an exact number, or has too many digits.
    """
    try:
        if isinstance(number, (float, bool)):
            raise ValueError
        if _exponent(number) > MAX_EXPONENT:
            raise QueryError(f"{what}: {shortened(str(number))} is out of range; write a number up to 1e{MAX_EXPONENT}")
        return Fraction(number)
    except (ValueError, ZeroDivisionError, TypeError, OverflowError):
        raise QueryError(f"{what}: {number!r} is not an exact number; write 2, '0.5' or '1/3'") from None


def _exponent(number: Number) -> int:
    """Return an upper bound on the number of digits before and after the decimal point, without writing them out."""
    if isinstance(number, Decimal):
        return abs(number.adjusted()) if number.is_finite() else 0
    if isinstance(number, str):
        parts = [EXPONENT.fullmatch(part.strip()) for part in number.split("/")]
        return max((len(part["digits"]) - 1 + abs(int(part["exponent"] or 0)) for part in parts if part), default=0)
    return max(abs(number.numerator).bit_length(), number.denominator.bit_length()) * 3 // 10
