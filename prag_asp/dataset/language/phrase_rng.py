"""Random choices that are the same on every machine and in every version of Python."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import blake2b
from typing import TypeVar

Option = TypeVar("Option")


class PhraseRng:
    """A random generator seeded by a text: its numbers are digits of the text's digest in a mixed base."""

    def __init__(self, text: str) -> None:
        self._seed = text.encode()
        self._value, self._left = 0, 1

    def number(self, options: int) -> int:
        """Return a number from 0 below the number of options."""
        if self._left < options << 32:
            self._seed = blake2b(self._seed).digest()
            self._value, self._left = int.from_bytes(self._seed, "big"), 1 << 512
        self._value, found = divmod(self._value, options)
        self._left //= options
        return found

    def pick(self, options: Sequence[Option]) -> Option:
        """Return a random one of some options."""
        return options[self.number(len(options))]
