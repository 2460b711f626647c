"""The total weight of the occurrences of letters, and of consecutive letters, in the words of one length.

A word with one chosen occurrence is a word of a larger automaton, which consists of copies of the automaton, one above
the other, and of marked edges that lead up to the next copy. Occurrences in long words can therefore be counted by a
recurrence, as words are.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from prag_asp.processes.progress_events import counted
from prag_asp.space.automaton.automaton import Automaton, Completions
from prag_asp.space.automaton.recurrence import count_by_recurrence

Marks = Sequence[NDArray[np.bool_]]
"""For each of several consecutive letters, whether an edge has that letter, shape (edges,)."""


def occurrences_by_recurrence(automaton: Automaton, kinds: Iterable[Marks], length: int) -> list[int] | None:
    """Return, for each kind of occurrence, the sum over all words of the weight times the number of such occurrences.

    The result is None if a recurrence may be slower than counting step by step.
    """
    weights = []
    for marks in counted(list(kinds), "occurrences"):
        weight = count_by_recurrence(Completions(with_occurrence(automaton, marks)), length)
        if weight is None:
            return None
        weights.append(weight)
    return weights


def with_occurrence(automaton: Automaton, marks: Marks) -> Automaton:
    """Return the automaton of the words in which one occurrence of consecutive letters is chosen.

    It has one path for each word and each occurrence in the word. Before the occurrence, the path is in copy 0; each
    letter of the occurrence leads to the next copy. Only the last copy accepts.
    """
    edges, states = np.arange(len(automaton.letters)), automaton.states
    inside = [_edges(copy, copy, edges) for copy in (0, len(marks))]
    upward = [_edges(copy, copy + 1, np.flatnonzero(mark)) for copy, mark in enumerate(marks)]
    lower, upper, kept = np.concatenate([*inside, *upward], axis=1)
    sources = lower * states + automaton.sources[kept]
    order = np.argsort(sources, kind="stable")
    return replace(
        automaton.with_edges(kept[order]),
        offsets=np.searchsorted(sources[order], np.arange(states * (len(marks) + 1) + 1)).astype(np.int64),
        targets=(upper * states + automaton.targets[kept])[order],
        accepting=np.concatenate([np.zeros(states * len(marks), dtype=np.bool_), automaton.accepting]),
    )


def _edges(lower: int, upper: int, edges: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return edges from one copy to another as three rows: the two copies and the edges."""
    return np.stack([np.full(len(edges), lower), np.full(len(edges), upper), edges])
