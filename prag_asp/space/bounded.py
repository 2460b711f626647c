"""Counting that a limit may end: what is known then is a lower bound."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import NDArray

from prag_asp.space.automaton import Automaton, Completions


def count_within(completions: Completions, length: int, spent: Callable[[], str | None]) -> tuple[int, str]:
    """Return the weight of all words of a length, and "", or what is known of it when a limit is reached, and which.

    What is known then is the weight of the words that begin with one path, to where the completions are known.
    """
    automaton = completions.automaton
    if not automaton.states:
        return 0, ""
    row = completions.row(0)
    for left in range(length):
        stopped = spent()
        if stopped:
            return _along_one_path(automaton, length - left, row), stopped
        row = completions.following(row)
    return int(row[0]), ""


def _along_one_path(automaton: Automaton, steps: int, row: NDArray[Any]) -> int:
    """Return the weight of the words that begin with one path of so many steps, where `row` has what completes it."""
    state, weight = 0, 1
    for _ in range(steps):
        edges = range(int(automaton.offsets[state]), int(automaton.offsets[state + 1]))
        if not edges:
            return 0
        best = max(edges, key=lambda edge: int(row[automaton.targets[edge]]))
        weight *= 1 if automaton.weights is None else int(automaton.weights[best])
        state = int(automaton.targets[best])
    return weight * int(row[state])
