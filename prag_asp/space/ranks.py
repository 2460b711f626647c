"""Random sets of ranks."""

from __future__ import annotations

import random


def distinct_ranks(generator: random.Random, total: int, count: int) -> list[int]:
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
    generator.shuffle(ranks)
    return ranks
