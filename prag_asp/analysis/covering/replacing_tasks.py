"""Tasks that cover combinations of factors, chosen in rounds; tasks that turn out to be infeasible are replaced.

The first round is a small covering set, whose tasks cover many combinations each. If one of them is infeasible, a
single bad combination may be the cause. Later rounds therefore try the remaining combinations one by one, if possible
with tasks whose other combinations are all covered.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Iterator, Sequence
from fractions import Fraction
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.covering.combinations import Combination, combinations_of, letter_combinations
from prag_asp.analysis.covering.covering_set import covering_set
from prag_asp.analysis.layered_automaton import LayeredAutomaton, layered_words
from prag_asp.atom import parse_atom
from prag_asp.space.task_space import TaskSpace

ROUNDS = 10
"""The number of rounds: a combination that is still missing was in at least this many infeasible tasks, or in all of
them."""

WALKS = 100
"""The number of random tasks that are tried to find an unused one, because neighbours of infeasible tasks are often
infeasible.
"""

LOOK = 10_000
"""The number of tasks, in order, that are tried after the random ones."""


class CoveringRounds:
    """A choice of tasks of a space in rounds, given by ranks; tasks with `excluded` ranks are never chosen.

    Unless `trivial` is true, tasks whose final state equals the initial state do not replace others.

    Raises:
        QueryError: the strength is out of range, the space has several lengths, or its states are too many to be
            listed.
        LimitReached: a limit was reached.
    """

    def __init__(
        self, space: TaskSpace, strength: int, seed: int = 0, excluded: Collection[int] = (), *, trivial: bool = True
    ) -> None:
        self._space, self._strength, self._seed, self._trivial = space, strength, seed, trivial
        first = covering_set(space, strength)
        self.reachable = first.reachable
        self.probability = Fraction(1, max(space.count(), 1))
        """The probability of each task in a uniform sample."""
        self._first = [rank for rank in map(space.index, first.tasks) if rank not in excluded]
        self._used, self._round = {*excluded}, 0
        self._exhausted: set[Combination] = set()
        self._words = layered_words(space, "task")
        self._covers = letter_combinations(space, self._words, strength)

    def missing(self, feasible: Sequence[Sequence[str]]) -> frozenset[Combination]:
        """Return the combinations that no feasible plan, given as texts of actions, covers."""
        classes, actions = self._space.domain.facts.entity_names, {action for plan in feasible for action in plan}
        return self.reachable.difference(
            *(combinations_of(parse_atom(action), classes, self._strength) for action in actions)
        )

    def following(self, feasible: Sequence[Sequence[str]]) -> list[int]:
        """Return the ranks of the tasks in the next round, given all feasible plans; empty if all rounds are over."""
        self._round += 1
        if self._round == 1 and self._first:
            self._used.update(self._first)
            return self._first
        left = self.missing(feasible) if self._round <= ROUNDS else frozenset()
        chosen: list[int] = []
        done: set[Combination] = set()
        for combination in sorted(left - self._exhausted):
            if combination not in done and (rank := self._replacement(combination, left)) is not None:
                self._used.add(rank)
                chosen.append(rank)
                done |= self.reachable - self.missing([self._space.plan_at(rank)])
        return chosen

    def _replacement(self, combination: Combination, left: frozenset[Combination]) -> int | None:
        """Return the rank of an unused task with a combination, if possible without other uncovered combinations."""
        having = [combination in own for own in self._covers]
        fewest = min(len(own & left) for own in self._covers if combination in own)
        clean = [has and len(own & left) == fewest for has, own in zip(having, self._covers, strict=True)]
        spoilt = [not own.isdisjoint(left) and not good for own, good in zip(self._covers, clean, strict=True)]
        for hit, banned in ((clean, spoilt), (having, [False] * len(having))):
            words = WordsThrough(self._words, np.array(hit), np.array(banned))
            for word in words.found(random.Random(f"cover {self._seed} {self._round} {combination}")):
                plan = tuple(self._words.letters[letter] for letter in word)
                rank = self._space.index(plan)
                if rank in self._used:
                    continue
                if self._trivial or not next(self._space.tasks_of_plans([plan])).trivial:
                    return rank
                self._used.add(rank)
        self._exhausted.add(combination)
        return None


class WordsThrough:
    """The words without `banned` letters that have at least one `hit` letter; both are masks of shape (letters,)."""

    def __init__(self, words: LayeredAutomaton, hit: NDArray[np.bool_], banned: NDArray[np.bool_]) -> None:
        self._steps = words.edges or ()
        self._weights: list[NDArray[np.float64]] = []
        whole, through = np.ones(1), np.zeros(1)
        self._hits = [hit[step.letters] for step in self._steps]
        for step, hits in zip(self._steps[::-1], self._hits[::-1], strict=True):
            kept = ~banned[step.letters]
            weights = kept * np.array([np.where(hits, whole[step.targets], through[step.targets]), whole[step.targets]])
            largest = max(float(weights.max()), 1.0)  # only ratios of the numbers of words matter
            self._weights.append(weights / largest)
            through, whole = np.add.reduceat(weights / largest, step.begins, axis=1)
        self._weights.reverse()
        self._possible = bool(through[0] > 0)

    def found(self, chance: random.Random) -> Iterator[list[int]]:
        """Yield words: first random ones, which may repeat, and then the words in order, up to a maximum number."""
        if self._possible:
            for _ in range(WALKS):
                yield self._walk(chance)
            yield from islice(self._from(0, 0, False), LOOK)

    def _edges(self, place: int, state: int, seen: bool) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the edges from a state that lead to words of the set, and, up to a factor, how many words each has."""
        begins = self._steps[place].begins
        end = begins[state + 1] if state + 1 < len(begins) else len(self._steps[place].letters)
        edges = np.arange(begins[state], end)
        weights = self._weights[place][int(seen), edges]
        return edges[weights > 0], weights[weights > 0]

    def _walk(self, chance: random.Random) -> list[int]:
        """Return a random word; all words have nearly the same probability."""
        state, seen, word = 0, False, list[int]()
        for place, step in enumerate(self._steps):
            edges, weights = self._edges(place, state, seen)
            (edge,) = chance.choices(edges.tolist(), weights.tolist())
            word.append(int(step.letters[edge]))
            state, seen = int(step.targets[edge]), seen or bool(self._hits[place][edge])
        return word

    def _from(self, place: int, state: int, seen: bool) -> Iterator[list[int]]:
        """Yield the suffixes of words from a state, in order."""
        if place == len(self._steps):
            yield []
            return
        step = self._steps[place]
        for edge in self._edges(place, state, seen)[0].tolist():
            hits = seen or bool(self._hits[place][edge])
            for rest in self._from(place + 1, int(step.targets[edge]), hits):
                yield [int(step.letters[edge]), *rest]
