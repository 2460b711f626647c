"""Find a small set of tasks that together cover all reachable combinations of a space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import combinations
from operator import or_

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.covering.combinations import Combination, letter_combinations
from prag_asp.analysis.covering.fewest_tasks import fewest_tasks
from prag_asp.analysis.layered_automaton import LayeredAutomaton, layered_words
from prag_asp.errors import LimitReached
from prag_asp.processes.progress_events import stage
from prag_asp.space.limits import LimitClock
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

MOST_PAIRS = 20_000
"""The maximum number of pairs of tasks to try; this takes seconds."""

WIDTH = 32
"""The beam width of the search: the number of prefixes of tasks that it keeps; a wider beam hardly ever finds better
tasks.
"""


@dataclass(frozen=True)
class CoveringSet:
    """Tasks that cover all reachable combinations of one strength; every such set has at least `at_least` tasks."""

    tasks: tuple[Task, ...]
    strength: int
    reachable: frozenset[Combination]
    at_least: int


def covering_set(space: TaskSpace, strength: int) -> CoveringSet:
    """Return a small set of tasks that together cover all reachable combinations of a space at a given strength.

    Each task is the best one that a beam search finds: it covers the most combinations not covered by earlier tasks
    (the greedy algorithm for set covers, Chvatal 1979). Then redundant tasks are removed, and a pair of tasks is
    replaced by one task if the search finds one that covers as much. If the set has `at_least` tasks, no smaller set
    exists.

    Raises:
        QueryError: the strength is out of range, the space has several lengths, or its states are too many to be
            listed.
        LimitReached: a limit was reached.
    """
    words = layered_words(space, "task")
    covers = letter_combinations(space, words, strength)
    numbers = {each: number for number, each in enumerate(sorted(frozenset().union(*covers)))}
    masks = [sum(1 << numbers[each] for each in own) for own in covers]
    stage("choosing tasks")
    choice = _Choice(words, masks)
    clock = space.engines.limits.begin()
    chosen = _without_superfluous(choice.all((1 << len(numbers)) - 1, clock), masks)
    at_least = fewest_tasks(words, masks, len(chosen), clock)
    if at_least < len(chosen):
        chosen = choice.improved(chosen, at_least)
    plans = [tuple(words.letters[letter] for letter in word) for word in chosen]
    return CoveringSet(tuple(space.tasks_of_plans(plans)), strength, frozenset(numbers), at_least)


Word = tuple[int, ...]


@dataclass(frozen=True)
class _Choice:
    """The search for words that cover combinations; `masks` holds the combinations of each letter as bits."""

    words: LayeredAutomaton
    masks: Sequence[int]

    @cached_property
    def _edges(self) -> list[list[list[tuple[int, int]]]]:
        """For each layer and state, the letters and targets of its edges."""
        layers = []
        for step in self.words.edges or ():
            edges: list[list[tuple[int, int]]] = [[] for _ in range(step.states)]
            for source, letter, target in zip(
                step.sources.tolist(), step.letters.tolist(), step.targets.tolist(), strict=True
            ):
                edges[source].append((letter, target))
            layers.append(edges)
        return layers

    def _bounds(self, rest: int) -> list[NDArray[np.int64]]:
        """Return, for each layer and state, an upper bound on how many combinations in `rest` a suffix covers."""
        gains = np.array([(mask & rest).bit_count() for mask in self.masks], dtype=np.int64)
        bounds = [np.zeros(1, dtype=np.int64)]
        for step in reversed(self.words.edges or ()):
            bounds.append(np.maximum.reduceat(gains[step.letters] + bounds[-1][step.targets], step.begins))
        return bounds[::-1]

    def improved(self, words: Sequence[Word], enough: int) -> list[Word]:
        """Return words that cover the same combinations; one word replaces two, if possible, until `enough` remain."""
        remaining = list(words)
        pairs, tried = combinations(range(len(remaining)), 2), 0
        while len(remaining) > enough and tried < MOST_PAIRS and (pair := next(pairs, None)) is not None:
            tried += 1
            others = [word for place, word in enumerate(remaining) if place not in pair]
            rest = self._covered(remaining) & ~self._covered(others)
            if self.most(rest) >= rest.bit_count():
                word, covered = self._best(rest)
                if covered == rest:
                    remaining = [*others, word]
                    pairs = combinations(range(len(remaining)), 2)
        return remaining

    def _covered(self, words: Sequence[Word]) -> int:
        return reduce(or_, (self.masks[letter] for word in words for letter in word), 0)

    def most(self, rest: int) -> int:
        """Return an upper bound on the number of combinations in `rest` that one word covers."""
        return int(self._bounds(rest)[0][0])

    def all(self, rest: int, clock: LimitClock) -> list[Word]:
        """Return words that together cover all combinations in `rest`.

        Raises:
            LimitReached: a limit was reached.
        """
        chosen: list[Word] = []
        while rest:
            if reason := clock.reached_limit():
                raise LimitReached(
                    f"{reason.prose()} was reached with {rest.bit_count():,} combinations left; "
                    "allow more (--time), or combine fewer factors", 0, reason,
                )  # fmt: skip
            word, covered = self._best(rest)
            chosen.append(word)
            rest &= ~covered
        return chosen

    def _best(self, rest: int) -> tuple[Word, int]:
        """Return a word that covers many (at least one) of the combinations in `rest`, and the covered ones as bits."""
        bounds = self._bounds(rest)
        beam: dict[tuple[int, int], Word] = {(0, 0): ()}
        for place, edges in enumerate(self._edges):
            following: dict[tuple[int, int], Word] = {}
            for (state, covered), word in beam.items():
                for letter, target in edges[state]:
                    following.setdefault((target, covered | self.masks[letter] & rest), (*word, letter))
            later = bounds[place + 1]
            ranked = sorted(following.items(), key=lambda item: (
                -min(item[0][1].bit_count() + int(later[item[0][0]]), rest.bit_count()), -item[0][1].bit_count(),
                item[1],
            ))  # fmt: skip
            beam = dict(ranked[:WIDTH])
        (_, covered), word = max(beam.items(), key=lambda item: item[0][1].bit_count())
        return word, covered


def _without_superfluous(words: Sequence[Word], masks: Sequence[int]) -> list[Word]:
    """Return the words without those whose combinations the others cover."""
    remaining = list(words)
    for word in words[::-1]:
        others = [other for other in remaining if other is not word]
        covered = 0
        for other in others:
            for letter in other:
                covered |= masks[letter]
        if all(masks[letter] & ~covered == 0 for letter in word):
            remaining = others
    return remaining
