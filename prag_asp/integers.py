"""The whole numbers that a logic program can hold: clingo's have 32 bits, and wrap around without a word."""

from __future__ import annotations

import re
from collections.abc import Iterator

LARGEST = 2**31 - 1
"""Numbers go from ``-LARGEST`` to this. The one number below has no positive counterpart: dividing it by -1 ends the
process."""

SPELLED = re.compile(r"(?<![\w'@#])(?:0x[\da-fA-F]+|0o[0-7]+|0b[01]+|\d+)(?![\w'])")
LONGEST = 40
"""Digits, in any base, beyond which a number is not even read."""

STRING = re.compile(r'"(?:\\.|[^"\\])*"')
TOLD = f"write numbers from -{LARGEST} to {LARGEST}"


def fits(number: int) -> bool:
    """Return whether a logic program can hold a number."""
    return -LARGEST <= number <= LARGEST


def too_large(text: str) -> Iterator[tuple[int, str]]:
    """Yield the numbers in a text without comments that no logic program can hold, each with its position."""
    for match in SPELLED.finditer(STRING.sub(lambda string: " " * len(string[0]), text)):
        digits = match[0]
        if len(digits) > LONGEST or not fits(int(digits, 0 if digits[1:2].isalpha() else 10)):
            yield match.start(), digits


def shortened(digits: str) -> str:
    """Return a number as messages show it."""
    return digits if len(digits) <= 24 else f"{digits[:20]}... ({len(digits)} digits)"
