"""From a step function to the automaton of its plans: breadth-first, all states of a layer at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.transition import States, Transition
from prag_asp.space.automaton import Automaton

CHUNK = 16_384
"""States that are expanded together: enough to make NumPy's overhead small, few enough to stay in the cache."""

Progress = Callable[[int, int], None]
"""Called with the depth reached and the number of states found."""


def explore(
    transition: Transition, length: int, progress: Progress | None = None
) -> tuple[Automaton, NDArray[np.bool_]]:
    """Return the automaton of all plans of up to `length` actions, and the labels of its edges.

    Letters are numbers of `transition.actions`. The labels have shape (edges, number of labels).
    """
    numbers: dict[bytes, int] = {}
    accepting: list[NDArray[np.bool_]] = []
    edges: list[NDArray[np.int64]] = []
    labels: list[NDArray[np.bool_]] = []
    frontier = transition.initial
    first = 0
    _number(frontier, numbers)
    depth = 0
    while frontier.shape[1]:
        accepting.append(transition.accepts(frontier))
        if depth == length:
            break
        found: list[States] = []
        for start in range(0, frontier.shape[1], CHUNK):
            chunk = frontier[:, start : start + CHUNK]
            for letter, after in enumerate(transition.expand(chunk)):
                if not len(after.sources):
                    continue
                targets, new = _number(after.states, numbers)
                found.append(new)
                sources = after.sources.astype(np.int64) + first + start
                edges.append(np.stack([sources, np.full_like(sources, letter), targets]))
                labels.append(after.labels.T)
            if progress:
                progress(depth + 1, len(numbers))
        first += frontier.shape[1]
        frontier = np.concatenate(found, axis=1) if found else frontier[:, :0]
        depth += 1
    closed = not frontier.shape[1]
    return _assemble(len(numbers), edges, labels, accepting, len(transition.labels), None if closed else length)


def _number(states: States, numbers: dict[bytes, int]) -> tuple[NDArray[np.int64], States]:
    """Return the number of each state, and the states that had none yet, in the order of their new numbers."""
    if not states.shape[0]:
        new = states[:, : 1 if states.shape[1] and not numbers else 0]
        if states.shape[1]:
            numbers.setdefault(b"", 0)
        return np.zeros(states.shape[1], dtype=np.int64), new
    packed = np.ascontiguousarray(np.packbits(states, axis=0).T)
    width = packed.shape[1]
    text = packed.tobytes()
    known = len(numbers)
    found = np.empty(len(packed), dtype=np.int64)
    fresh: list[int] = []
    for row in range(len(packed)):
        key = text[row * width : (row + 1) * width]
        number = numbers.setdefault(key, known + len(fresh))
        if number == known + len(fresh):
            fresh.append(row)
        found[row] = number
    return found, states[:, fresh]


def _assemble(
    size: int,
    edges: list[NDArray[np.int64]],
    labels: list[NDArray[np.bool_]],
    accepting: list[NDArray[np.bool_]],
    width: int,
    horizon: int | None,
) -> tuple[Automaton, NDArray[np.bool_]]:
    rows = np.concatenate(edges, axis=1) if edges else np.zeros((3, 0), dtype=np.int64)
    marks = np.concatenate(labels) if labels else np.zeros((0, width), dtype=np.bool_)
    order = np.lexsort((rows[1], rows[0]))
    sources, letters, targets = rows[:, order]
    offsets = np.searchsorted(sources, np.arange(size + 1)).astype(np.int64)
    ends = np.concatenate(accepting) if accepting else np.zeros(0, dtype=np.bool_)
    return Automaton(offsets, letters, targets, ends, horizon=horizon), marks[order]
