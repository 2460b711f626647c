"""Enumerated words as a tree automaton with a leaf for each word."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from fractions import Fraction
from math import lcm

import numpy as np

from prag_asp.space.automaton.automaton import Automaton, Completions
from prag_asp.space.weights.weights import Weighed


def word_tree(
    words: Sequence[Sequence[int]],
    length: int,
    weights: Sequence[Fraction] | None = None,
    ends: Sequence[Hashable] | None = None,
) -> Weighed:
    """Return words of one length, in order of their letters, with their weights and the goals of their `ends`."""
    numbers: dict[tuple[int, ...], int] = {} if not words else {(): 0}
    for depth in range(1, length + 1):
        for word in words:
            numbers.setdefault(tuple(word[:depth]), len(numbers))
    scale = lcm(*(weight.denominator for weight in weights)) if weights and length else 1
    whole = [1] * len(numbers)
    goals = [0] * len(numbers)
    kinds: dict[Hashable, int] = {}
    for place, word in enumerate(words):
        leaf = numbers[tuple(word)]
        whole[leaf] = int(weights[place] * scale) if weights and length else 1
        goals[leaf] = kinds.setdefault(ends[place], len(kinds)) if ends else 0
    prefixes = sorted(prefix for prefix in numbers if prefix)
    prefixes.sort(key=lambda prefix: numbers[prefix[:-1]])
    below = [numbers[prefix] for prefix in prefixes]
    sources = np.array([numbers[prefix[:-1]] for prefix in prefixes], dtype=np.int64)
    automaton = Automaton(
        np.searchsorted(sources, np.arange(len(numbers) + 1)).astype(np.int64),
        np.array([prefix[-1] for prefix in prefixes], dtype=np.int64),
        np.array(below, dtype=np.int64),
        np.array([len(prefix) == length for prefix in numbers], dtype=np.bool_),
        np.array([whole[leaf] for leaf in below], dtype=object) if weights else None,
        length,
    )
    ended = np.array([goals[leaf] for leaf in below], dtype=np.int64) if ends else None
    return Weighed(Completions(automaton), Fraction(1, scale), ended)
