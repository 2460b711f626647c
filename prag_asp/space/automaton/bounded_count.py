"""Counts of words within limits: if a limit ends a count, the result is a lower bound."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import NDArray

from prag_asp.space.automaton.automaton import Automaton, Completions
from prag_asp.stop_reason import LimitCheck, StopReason

REPORTED = 4096
"""The number of letters between two progress reports."""


def count_within(
    completions: Completions,
    length: int,
    check: LimitCheck,
    tell: Callable[[str], None] = lambda words: None,
) -> tuple[int, StopReason | None]:
    """Return the weight of all words of a given length and None, or a lower bound and the limit that was reached.

    The lower bound is the weight of the words that follow one fixed path up to the first step whose completions are
    known. `tell` is called periodically to report progress.
    """
    automaton = completions.automaton
    if not automaton.states:
        return 0, None
    row = completions.row(0)
    for left in range(length):
        stop = check()
        if stop:
            return _along_one_path(automaton, length - left, row), stop
        row = completions.following(row)
        if left % REPORTED == 0:
            tell(f"counted {left:,} of {length:,} actions")
    return int(row[0]), None


def _along_one_path(automaton: Automaton, steps: int, row: NDArray[Any]) -> int:
    """Return a lower bound on the weight of the words that begin with a certain path of `steps` steps.

    `row` holds the weights of the completions after these steps.

    The path always leaves a state by the same edge, so it soon runs into a cycle. Skipped cycles count as a factor of
    1, which is a lower bound because weights are integers.
    """
    state, weight, left = 0, 1, steps
    seen: dict[int, int] = {}
    while left:
        if state in seen:
            left %= seen[state] - left
            seen = {}
            if not left:
                break
        seen[state] = left
        edges = range(int(automaton.offsets[state]), int(automaton.offsets[state + 1]))
        if not edges:
            return 0
        best = max(edges, key=lambda edge: int(row[automaton.targets[edge]]))
        weight *= 1 if automaton.weights is None else int(automaton.weights[best])
        state, left = int(automaton.targets[best]), left - 1
    return weight * int(row[state])
