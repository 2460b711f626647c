"""Walks along the edges of states of any kind, to list words in order or to find the word with a given rank."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

State = TypeVar("State")
Letter = TypeVar("Letter")

Choice = Callable[[int, Sequence[int]], int]
"""A function that selects an edge, given the number of the step and the running totals of the edges' weights."""


def words_along(
    start: State, length: int, onward: Callable[[State, int], Iterator[tuple[Letter, State]]]
) -> Iterator[tuple[Letter, ...]]:
    """Yield the words of a given length from a state, lazily and depth-first.

    `onward` yields, in order, the letters that can continue words from a state at a step, each with the successor.
    """
    if not length:
        yield ()
        return
    word: list[Letter] = []
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
    """Return a function that chooses the edges that lead to the word with a given rank, counted from 0."""

    def owner(_: int, totals: Sequence[int]) -> int:
        nonlocal rank
        edge = bisect_right(totals, rank)
        rank -= totals[edge - 1] if edge else 0
        return edge

    return owner
