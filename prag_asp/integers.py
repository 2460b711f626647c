"""The integers of logic programs: clingo's have 32 bits and overflow silently."""

from __future__ import annotations

import re
from collections.abc import Iterator

LARGEST = 2**31 - 1
"""The largest number; the smallest is ``-LARGEST``. The only smaller 32-bit number has no positive counterpart, and
dividing it by -1 would crash the process.
"""

SPELLED = re.compile(r"(?<![\w'@#])(?:0x[\da-fA-F]+|0o[0-7]+|0b[01]+|\d+)(?![\w'])")
PLAIN_BITS = 10_000
"""The number of bits up to which `str` is as fast as any other method."""

PLAIN_DIGITS = 3_000
"""The number of digits up to which Python converts a number quickly, which is below its default limit of 4300 digits.
"""

GROUP = 3
LONGEST = 40
"""The maximum number of digits, in any base; a longer number counts as too large without being converted."""

TOLD = f"write numbers from -{LARGEST} to {LARGEST}"


def fits(number: int) -> bool:
    """Return whether a logic program can hold a number."""
    return -LARGEST <= number <= LARGEST


def too_large(text: str) -> Iterator[tuple[int, str]]:
    """Yield the position and digits of each number that is too large; the text must have no comments or strings."""
    for match in SPELLED.finditer(text):
        digits = match[0]
        if len(digits) > LONGEST or not fits(int(digits, 0 if digits[1:2].isalpha() else 10)):
            yield match.start(), digits


def shortened(digits: str) -> str:
    """Return a number as text for messages, shortened if it is long."""
    return digits if len(digits) <= 24 else f"{digits[:20]}... ({len(digits)} digits)"


def with_short_numbers(text: str) -> str:
    """Return `text`, which a user wrote, with its long numbers shortened for a message."""
    return re.sub(r"\d{40,}", lambda number: shortened(number[0]), text)


def digits_of(number: int) -> str:
    """Return the decimal digits of a number of any size; Python's `str` would take quadratic time.

    The bits are split into halves, which are recombined as `decimal` numbers because multiplying these is fast.
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
    """Return the number written as decimal digits, however many; Python's `int` accepts only a few thousand.

    Raises:
        ValueError: the text has a character that is not a decimal digit.
    """
    if len(digits) <= PLAIN_DIGITS:
        return int(digits)
    if not (digits.isascii() and digits.isdecimal()):
        raise ValueError("it is not a whole number")
    import decimal  # noqa: PLC0415 - as above

    with decimal.localcontext() as context:
        context.prec, context.Emax = decimal.MAX_PREC, decimal.MAX_EMAX
        return int(decimal.Decimal(digits))


def grouped(number: int) -> str:
    """Return the decimal digits of a number of any size, with commas between thousands."""
    digits = digits_of(number)
    if len(digits) <= PLAIN_DIGITS:
        return f"{number:,}"
    first = (len(digits) - 1) % GROUP + 1
    return ",".join([digits[:first], *(digits[at : at + GROUP] for at in range(first, len(digits), GROUP))])
