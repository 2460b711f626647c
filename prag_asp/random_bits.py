"""Random bits addressed by position: a seed gives the same bits on every machine, whatever the size of requests.

The generator is Philox4x64-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011): a published
function from a key and a counter to four 64-bit words. Each draw has its own counters, so it does not depend on earlier
draws. Only raw words are used, because NumPy guarantees the raw stream of a bit generator, but not the results of its
distributions (NEP 19); the key is a SHA-256 digest of the seed, so no seeding procedure of NumPy is involved either.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.uint64]
"""An array of 64-bit random words."""

WORD = 64
BLOCK = 4
"""The number of words that Philox generates from one counter."""


class Bits(Protocol):
    """A source of random words for draws that are numbered from 0."""

    def words(self, first: int, count: int, each: int) -> Words:
        """Return `each` words for each of `count` draws from number `first` onwards, shape (count, each)."""
        ...

    def further(self, draw: int, step: int) -> Iterator[int]:
        """Yield more words for one step of a draw, in the rare case that 64 bits do not decide it."""
        ...


@dataclass(frozen=True)
class SeededBits:
    """The random words derived from a seed; words for different purposes are independent."""

    seed: int
    purpose: str = ""

    @cached_property
    def _key(self) -> int:
        return int.from_bytes(sha256(f"{self.seed:x}{self.purpose}".encode()).digest()[:16], "big")

    def words(self, first: int, count: int, each: int) -> Words:
        """Return `each` words for each of `count` draws from number `first` onwards, shape (count, each)."""
        blocks = -(-each // BLOCK)
        generator = np.random.Philox(key=self._key, counter=first * blocks)
        drawn: Words = generator.random_raw(count * blocks * BLOCK).reshape(count, blocks * BLOCK)
        return drawn[:, :each]

    def further(self, draw: int, step: int) -> Iterator[int]:
        """Yield more words for one step of a draw, from counters that `words` never uses."""
        return self._stream(1, draw, step)

    def randrange(self, below: int) -> int:
        """Draw a number from 0 to `below` - 1 with exactly uniform probability."""
        return uniform_below(below, self._numbers)

    @cached_property
    def _numbers(self) -> Iterator[int]:
        return self._stream(2, 0, 0)

    def _stream(self, purpose: int, draw: int, step: int) -> Iterator[int]:
        generator = np.random.Philox(key=self._key, counter=(purpose << 192) + (draw << 128) + (step << 64))
        while True:
            yield int(generator.random_raw())


def uniform_below(below: int, words: Iterator[int]) -> int:
    """Draw a number from 0 to `below` - 1 with exactly uniform probability, by rejection sampling."""
    size = below.bit_length()
    while True:
        number = 0
        for _ in range(-(-size // WORD)):
            number = (number << WORD) | next(words)
        number >>= -size % WORD
        if number < below:
            return number
