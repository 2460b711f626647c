"""Random sets of ranks."""

from __future__ import annotations

from typing import Protocol


class Generator(Protocol):
    """A source of random numbers."""

    def randrange(self, below: int, /) -> int:
        """Return a number from 0 to `below` - 1, each with the same probability."""
        ...


def distinct_ranks(generator: Generator, total: int, count: int) -> list[int]:
    """Return `count` different numbers below `total`, every set of them equally likely, in random order.

    Needs room for the numbers returned alone, however large `total` is (Floyd's algorithm, Bentley 1987).
    """
    chosen: set[int] = set()
    ranks: list[int] = []
    for last in range(total - count, total):
        rank = generator.randrange(last + 1)
        if rank in chosen:
            rank = last
        chosen.add(rank)
        ranks.append(rank)
    for last in range(count - 1, 0, -1):
        other = generator.randrange(last + 1)
        ranks[last], ranks[other] = ranks[other], ranks[last]
    return ranks
