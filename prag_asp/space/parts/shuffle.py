"""Pseudo-random permutations of any size with random access."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b

ROUNDS = 6


@dataclass(frozen=True)
class Shuffle:
    """A permutation of the numbers below `size`, given by a seed.

    A Feistel network permutes the numbers with the next even number of bits (Luby and Rackoff 1988); cycle walking
    repeats it until the result is below `size` (Black and Rogaway 2002).
    """

    size: int
    seed: int

    @cached_property
    def _half(self) -> int:
        return max(1, (max(self.size - 1, 1).bit_length() + 1) // 2)

    def __getitem__(self, place: int) -> int:
        """Return the number at an index."""
        while True:
            left, right = place >> self._half, place & self._mask
            for number in range(ROUNDS):
                left, right = right, left ^ self._mixed(number, right)
            place = (left << self._half) | right
            if place < self.size:
                return place

    def place(self, number: int) -> int:
        """Return the index of a number: the inverse of indexing."""
        while True:
            left, right = number >> self._half, number & self._mask
            for step in reversed(range(ROUNDS)):
                left, right = right ^ self._mixed(step, left), left
            number = (left << self._half) | right
            if number < self.size:
                return number

    @cached_property
    def _mask(self) -> int:
        return (1 << self._half) - 1

    def _mixed(self, number: int, half: int) -> int:
        """Compute the round function: pseudo-random bits for half of a number."""
        size = (self._half + 7) // 8
        text = f"{self.seed} {number} {half}".encode()
        random_bytes = b"".join(
            blake2b(text, person=block.to_bytes(8, "little")).digest() for block in range((size + 63) // 64)
        )
        return int.from_bytes(random_bytes[:size], "little") & self._mask
