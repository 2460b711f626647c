"""The distribution of whole pieces among parts whose sizes come close to the requested shares."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from fractions import Fraction

NEAR = Fraction(2, 100)
"""Maximum difference between a part and its share in a random choice: two percentage points."""

ATTEMPTS, NODES = 20, 200_000
"""Number of random choices before branch and bound starts, and maximum number of nodes in that search."""

SWAPPED = 100
"""Maximum number of pieces for which exchanges of two pieces are also tried."""


def farthest(sizes: Sequence[int], shares: Sequence[Fraction]) -> Fraction:
    """Return the largest difference between the share of a part and its requested share, given the parts' sizes."""
    total = sum(sizes)
    return max(abs(Fraction(size, total) - share) for size, share in zip(sizes, shares, strict=True)) if total else NEAR


def choose_parts(pieces: Sequence[int], shares: Sequence[Fraction], seed: int) -> list[int]:
    """Return the index of each piece's part, given the sizes of the pieces, at least one of which is above 0.

    Pieces are assigned at random to parts that are still too small, and the assignment is improved by local search. If
    no attempt comes close enough, branch and bound searches for the closest assignment.
    """
    chance = random.Random(f"parts {seed}")
    best: list[int] = []
    for _ in range(ATTEMPTS):
        parts = _improved(_random_parts(pieces, shares, chance), pieces, shares)
        if not best or _distance(parts, pieces, shares) < _distance(best, pieces, shares):
            best = parts
        if _distance(best, pieces, shares) <= NEAR:
            return best
    return _nearest(pieces, shares, best)


def _distance(parts: Sequence[int], pieces: Sequence[int], shares: Sequence[Fraction]) -> Fraction:
    return farthest(_sums(parts, pieces, len(shares)), shares)


def _sums(parts: Sequence[int], pieces: Sequence[int], number: int) -> list[int]:
    sums = [0] * number
    for part, size in zip(parts, pieces, strict=True):
        sums[part] += size
    return sums


def _random_parts(pieces: Sequence[int], shares: Sequence[Fraction], chance: random.Random) -> list[int]:
    """Return an assignment of the pieces, in random order, to parts in proportion to how much each part still lacks."""
    total = sum(pieces)
    lacking = [share * total for share in shares]
    parts = [0] * len(pieces)
    for piece in chance.sample(range(len(pieces)), len(pieces)):
        able = [max(lack, Fraction(0)) for lack in lacking]
        point = Fraction(chance.getrandbits(64), 2**64) * sum(able)
        part = 0
        while part < len(able) - 1 and point >= able[part]:
            point -= able[part]
            part += 1
        parts[piece] = part
        lacking[part] -= pieces[piece]
    return parts


def _improved(parts: list[int], pieces: Sequence[int], shares: Sequence[Fraction]) -> list[int]:
    """Return a local optimum, which neither moving a piece nor exchanging two pieces improves."""
    total = sum(pieces)
    excess = [size - share * total for size, share in zip(_sums(parts, pieces, len(shares)), shares, strict=True)]
    while True:
        worst = max(map(abs, excess))
        step = min(_steps(parts, pieces, excess), default=None)
        if step is None or step[0] >= worst or worst <= NEAR * total / 4:
            return parts
        _, changes = step
        for piece, part in changes:
            excess[parts[piece]] -= pieces[piece]
            excess[part] += pieces[piece]
            parts[piece] = part


def _steps(
    parts: Sequence[int], pieces: Sequence[int], excess: Sequence[Fraction]
) -> Iterator[tuple[Fraction, tuple[tuple[int, int], ...]]]:
    """Yield possible changes, each preceded by the largest resulting excess."""

    def after(source: int, target: int, size: int) -> Fraction:
        return max(
            abs(amount - size if part == source else amount + size if part == target else amount)
            for part, amount in enumerate(excess)
        )

    for piece, part in enumerate(parts):
        for other in range(len(excess)):
            if other != part:
                yield after(part, other, pieces[piece]), ((piece, other),)
    if len(pieces) <= SWAPPED:
        for first, part in enumerate(parts):
            for second in range(first + 1, len(parts)):
                other = parts[second]
                if other != part:
                    yield after(part, other, pieces[first] - pieces[second]), ((first, other), (second, part))


def _nearest(pieces: Sequence[int], shares: Sequence[Fraction], best: list[int]) -> list[int]:
    """Return the closest assignment if the search ends within `NODES` nodes, or otherwise the best one found.

    Pieces are placed in order of decreasing size. An excess never shrinks, which bounds each branch.
    """
    total = sum(pieces)
    order = sorted(range(len(pieces)), key=lambda piece: -pieces[piece])
    excess = [-share * total for share in shares]
    least = _distance(best, pieces, shares) * total
    parts, nodes = [0] * len(pieces), 0
    waiting = [iter(range(len(shares)))]
    while waiting:
        depth = len(waiting) - 1
        part = next(waiting[-1], None)
        if part is None or nodes > NODES:
            waiting.pop()
            if depth:
                excess[parts[order[depth - 1]]] -= pieces[order[depth - 1]]
            continue
        nodes += 1
        piece = order[depth]
        if excess[part] + pieces[piece] >= least:
            continue
        excess[part] += pieces[piece]
        parts[piece] = part
        if depth + 1 < len(order):
            waiting.append(iter(range(len(shares))))
            continue
        if max(map(abs, excess)) < least:
            least, best = max(map(abs, excess)), list(parts)
        excess[part] -= pieces[piece]
    return best
