"""The integers of a logic program: those of clingo have 32 bits, and overflow silently."""

from __future__ import annotations

import re
from collections.abc import Iterator

LARGEST = 2**31 - 1
"""Numbers go from ``-LARGEST`` to this. The one number below has no positive counterpart: dividing it by -1 ends the
process."""

SPELLED = re.compile(r"(?<![\w'@#])(?:0x[\da-fA-F]+|0o[0-7]+|0b[01]+|\d+)(?![\w'])")
PLAIN_BITS = 10_000
"""Bits of a number up to which Python writes it as fast as anything does."""

PLAIN_DIGITS = 3_000
"""Digits of a number up to which Python reads and writes it at once, whatever it is told to refuse."""

GROUP = 3
LONGEST = 40
"""Digits, in any base, beyond which a number is not even read."""

TOLD = f"write numbers from -{LARGEST} to {LARGEST}"


def fits(number: int) -> bool:
    """Return whether a logic program can hold a number."""
    return -LARGEST <= number <= LARGEST


def too_large(text: str) -> Iterator[tuple[int, str]]:
    """Yield the numbers in a text without comments and strings that no logic program can hold, with their positions."""
    for match in SPELLED.finditer(text):
        digits = match[0]
        if len(digits) > LONGEST or not fits(int(digits, 0 if digits[1:2].isalpha() else 10)):
            yield match.start(), digits


def shortened(digits: str) -> str:
    """Return a number as messages show it."""
    return digits if len(digits) <= 24 else f"{digits[:20]}... ({len(digits)} digits)"


def digits_of(number: int) -> str:
    """Return the decimal digits of a number, however long: Python's own way takes time quadratic in their number.

    The number is cut in halves of bits, which are put together again as decimals, whose products are fast.
    """
    if number.bit_length() <= PLAIN_BITS:
        return str(number)
    import decimal  # noqa: PLC0415 - few numbers are that long

    def joined(part: int, bits: int) -> decimal.Decimal:
        if bits <= PLAIN_BITS:
            return decimal.Decimal(part)
        half = bits // 2
        if half not in powers:
            powers[half] = decimal.Decimal(2) ** half
        return joined(part >> half, bits - half) * powers[half] + joined(part & ((1 << half) - 1), half)

    powers: dict[int, decimal.Decimal] = {}
    with decimal.localcontext() as context:
        context.prec, context.Emax, context.Emin = decimal.MAX_PREC, decimal.MAX_EMAX, decimal.MIN_EMIN
        context.traps[decimal.Inexact] = True
        found = str(joined(abs(number), number.bit_length()))
    return f"-{found}" if number < 0 else found


def number_of(digits: str) -> int:
    """Return the number that decimal digits spell, however many there are: Python itself reads a few thousand.

    Raises:
        ValueError: the text has a character that is not a decimal digit.
    """
    if len(digits) <= PLAIN_DIGITS:
        return int(digits)
    if not (digits.isascii() and digits.isdecimal()):
        raise ValueError("it is no whole number")
    import decimal  # noqa: PLC0415 - as above

    with decimal.localcontext() as context:
        context.prec, context.Emax = decimal.MAX_PREC, decimal.MAX_EMAX
        return int(decimal.Decimal(digits))


def grouped(number: int) -> str:
    """Return the decimal digits of a number, however long, with commas between thousands."""
    digits = digits_of(number)
    if len(digits) <= PLAIN_DIGITS:
        return f"{number:,}"
    first = (len(digits) - 1) % GROUP + 1
    return ",".join([digits[:first], *(digits[at : at + GROUP] for at in range(first, len(digits), GROUP))])
