"""The automaton of skeletons: relabel, merge what cannot be told apart, determinise.

Merging bisimilar states first keeps the subset construction small (Rabin and Scott 1959; partition refinement after
Kanellakis and Smolka 1983).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from prag_asp.space.automaton import Automaton


def skeleton_automaton(automaton: Automaton, names: NDArray[np.int64]) -> Automaton:
    """Return the deterministic automaton of the words of `automaton` with each letter replaced by its name.

    `names` maps letters to numbers of names, shape (number of letters,).
    """
    if not automaton.states:
        return automaton
    blocks, letters, sources, targets = _quotient(automaton, names[automaton.letters])
    accepting = np.zeros(int(blocks.max()) + 1, dtype=np.bool_)
    accepting[blocks[automaton.accepting]] = True
    moves: dict[int, dict[int, list[int]]] = {}
    for source, letter, target in zip(sources.tolist(), letters.tolist(), targets.tolist(), strict=True):
        moves.setdefault(source, {}).setdefault(letter, []).append(target)
    return _determinised(int(blocks[0]), moves, accepting, automaton.horizon)


def _quotient(
    automaton: Automaton, letters: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return the block of each state, and the letters, sources and targets of the edges between blocks."""
    sources = automaton.sources
    blocks = automaton.accepting.astype(np.int64)
    number = len(np.unique(blocks))
    while True:
        rows = np.unique(np.stack([sources, letters, blocks[automaton.targets]], axis=1), axis=0)
        starts = np.searchsorted(rows[:, 0], np.arange(automaton.states + 1)).tolist()
        text = np.ascontiguousarray(rows[:, 1:]).tobytes()
        kinds: dict[tuple[int, bytes], int] = {}
        refined = np.fromiter(
            (
                kinds.setdefault((block, text[16 * first : 16 * last]), len(kinds))
                for block, first, last in zip(blocks.tolist(), starts, starts[1:], strict=False)
            ),
            dtype=np.int64,
            count=automaton.states,
        )
        if len(kinds) == number:
            edges = np.unique(np.stack([refined[sources], letters, refined[automaton.targets]], axis=1), axis=0)
            return refined, edges[:, 1], edges[:, 0], edges[:, 2]
        blocks, number = refined, len(kinds)


def _determinised(
    start: int, moves: dict[int, dict[int, list[int]]], accepting: NDArray[np.bool_], horizon: int | None
) -> Automaton:
    numbers: dict[frozenset[int], int] = {frozenset({start}): 0}
    subsets = [frozenset({start})]
    offsets, letters, targets = [0], [], []
    for subset in subsets:
        union: dict[int, set[int]] = {}
        for state in subset:
            for letter, found in moves.get(state, {}).items():
                union.setdefault(letter, set()).update(found)
        for letter in sorted(union):
            target = frozenset(union[letter])
            if target not in numbers:
                numbers[target] = len(subsets)
                subsets.append(target)
            letters.append(letter)
            targets.append(numbers[target])
        offsets.append(len(letters))
    ends = np.array([bool(accepting[list(subset)].any()) for subset in subsets])
    return Automaton(
        np.array(offsets, dtype=np.int64),
        np.array(letters, dtype=np.int64),
        np.array(targets, dtype=np.int64),
        ends,
        horizon=horizon,
    )
