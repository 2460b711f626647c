"""The automaton of skeletons: its edges are relabelled, bisimilar states merged, and the result determinised.

Merging bisimilar states first keeps the subset construction small (Rabin and Scott 1959; partition refinement after
Kanellakis and Smolka 1983).
"""

from __future__ import annotations

from math import prod

import numpy as np
from numpy.typing import NDArray

from prag_asp.space.automaton.automaton import Automaton
from prag_asp.space.automaton.numbering import Numbering
from prag_asp.stop_reason import LimitCheck, StopReason

LOOK = 1024
"""Number of subsets between two checks of the limits."""


def skeleton_automaton(
    automaton: Automaton, names: NDArray[np.int64], check: LimitCheck = lambda: None
) -> tuple[Automaton, StopReason | None]:
    """Return the deterministic automaton of the words of `automaton` with each letter replaced by its name.

    `names` maps letters to numbers of names, shape (number of letters,). The limit that was reached, if any, is also
    returned. In that case, some states lack edges, so words may be missing, but none is wrong.
    """
    if not automaton.states:
        return automaton, None
    blocks, letters, sources, targets = _quotient(automaton, names[automaton.letters])
    accepting = np.zeros(int(blocks.max()) + 1, dtype=np.bool_)
    accepting[blocks[automaton.accepting]] = True
    moves: dict[int, dict[int, list[int]]] = {}
    for source, letter, target in zip(sources.tolist(), letters.tolist(), targets.tolist(), strict=True):
        moves.setdefault(source, {}).setdefault(letter, []).append(target)
    return _determinise(int(blocks[0]), moves, accepting, automaton.horizon, check)


def _quotient(
    automaton: Automaton, letters: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return the block of each state, and the letters, sources and targets of the edges between blocks."""
    sources = automaton.sources
    blocks = automaton.accepting.astype(np.int64)
    number = int(blocks.max()) - int(blocks.min()) + 1
    while True:
        edges = _distinct(sources, letters, blocks[automaton.targets])
        refined = _refine(blocks, *edges)
        count = int(refined.max()) + 1
        if count == number:
            first, letter, target = _distinct(blocks[edges[0]], edges[1], edges[2])
            return blocks, letter, first, target
        blocks, number = refined, count


def _distinct(*columns: NDArray[np.int64]) -> tuple[NDArray[np.int64], ...]:
    """Return the distinct rows of a table given by its columns, sorted."""
    sizes = [int(column.max(initial=0)) + 1 for column in columns]
    if prod(sizes) < 2**62:
        # np.unique would import numpy.ma, which takes a tenth of the time of a small count.
        codes = np.sort(np.ravel_multi_index(columns, sizes))
        codes = codes[np.append(True, codes[1:] != codes[:-1])[: len(codes)]]
        return tuple(np.asarray(column, dtype=np.int64) for column in np.unravel_index(codes, sizes))
    return tuple(np.unique(np.stack(columns, axis=1), axis=0).T)


def _refine(
    blocks: NDArray[np.int64], sources: NDArray[np.int64], letters: NDArray[np.int64], targets: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the blocks, refined by comparing the k-th edges of all states for each k; edges are sorted."""
    starts = np.searchsorted(sources, np.arange(len(blocks) + 1))
    degrees = np.diff(starts)
    kinds = blocks.copy()
    for place in range(int(degrees.max(initial=0))):
        states = np.flatnonzero(degrees > place)
        edges = starts[states] + place
        kinds[states] = _numbers(kinds[states], letters[edges], targets[edges])
    return _numbers(degrees, kinds)


def _numbers(*columns: NDArray[np.int64]) -> NDArray[np.int64]:
    rows = np.stack(columns, axis=1).astype(np.uint64)
    return Numbering(len(columns)).add(rows)


def _determinise(
    start: int,
    moves: dict[int, dict[int, list[int]]],
    accepting: NDArray[np.bool_],
    horizon: int | None,
    check: LimitCheck,
) -> tuple[Automaton, StopReason | None]:
    numbers: dict[frozenset[int], int] = {frozenset({start}): 0}
    subsets = [frozenset({start})]
    offsets, letters, targets = [0], [], []
    stop: StopReason | None = None
    for place, subset in enumerate(subsets):
        if place % LOOK == LOOK - 1 and not stop:
            stop = check()
        reached: dict[int, list[list[int]]] = {}
        for state in () if stop else subset:
            for letter, successors in moves.get(state, {}).items():
                reached.setdefault(letter, []).append(successors)
        for letter in sorted(reached):
            target = frozenset().union(*reached[letter])
            if target not in numbers:
                numbers[target] = len(subsets)
                subsets.append(target)
            letters.append(letter)
            targets.append(numbers[target])
        offsets.append(len(letters))
    ends = np.array([bool(accepting[list(subset)].any()) for subset in subsets])
    automaton = Automaton(
        np.array(offsets, dtype=np.int64),
        np.array(letters, dtype=np.int32),
        np.array(targets, dtype=np.int32),
        ends,
        horizon=horizon,
    )
    return automaton, stop
