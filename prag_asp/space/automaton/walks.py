"""Words along the edges of states, whatever states are: in order, and by rank."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

State = TypeVar("State")

Choice = Callable[[int, Sequence[int]], int]
"""Takes an edge of each step, by the number of the step and the running totals of what is behind each edge."""


def words_along(
    start: State, length: int, onward: Callable[[State, int], Iterator[tuple[int, State]]]
) -> Iterator[tuple[int, ...]]:
    """Yield the words of a length that begin in a state, lazily, one that is completed before the next is begun.

    `onward` yields the letters with which words go on from a state at a step, in order, each with the state after it.
    """
    if not length:
        yield ()
        return
    word: list[int] = []
    waiting = [onward(start, 0)]
    while waiting:
        for letter, state in waiting[-1]:
            if len(waiting) == length:
                yield (*word, letter)
            else:
                word.append(letter)
                waiting.append(onward(state, len(word)))
                break
        else:
            waiting.pop()
            word = word[:-1]


def owner_of(rank: int) -> Choice:
    """Return the choice that leads to the word of a rank, from 0 on: of the edge that has it, at each step."""

    def owner(_: int, totals: Sequence[int]) -> int:
        nonlocal rank
        edge = bisect_right(totals, rank)
        rank -= totals[edge - 1] if edge else 0
        return edge

    return owner
