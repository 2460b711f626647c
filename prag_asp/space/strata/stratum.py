"""Strata of a task space: all tasks with the same length, skeleton or goal, in uniformly random order."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

from prag_asp.errors import QueryError
from prag_asp.program.entity_names import action_name
from prag_asp.random_bits import SeededBits
from prag_asp.space.distinct_sampling import RankedDraw, TaskOrder, UniformOrder, distinct_order, nonempty_sets
from prag_asp.space.engines.engine import Letters
from prag_asp.space.sampling.samplers import GoalSampler, Over, SkeletonSampler
from prag_asp.space.strata.allocation import STRATIFIED_BY, StratifiedBy
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.word_set import WordSet

_OVER: dict[StratifiedBy, Over] = {"skeleton": "skeletons", "goal": "goals"}

LONGEST_NAME = 60
"""The maximum length of the name of a stratum, in characters, because it becomes part of file names."""


@dataclass(frozen=True)
class Stratum:
    """A stratum: its name, the exact number of its tasks, and its tasks in the order of sampling without replacement.

    The probability of a draw is 1 divided by the number of tasks in the whole space.
    """

    name: str
    size: int
    order: TaskOrder


@dataclass(frozen=True)
class StratumOrder:
    """The tasks of a stratum of one length in uniformly random order.

    `draw` returns the independent uniform draw with a given number. Repeated draws are skipped; this is sampling
    without replacement because each new task is uniformly distributed among those that have not occurred yet.
    """

    words: WordSet
    size: int
    draw: Callable[[int], Letters]
    probability: Fraction

    def pick(self, numbers: Iterable[int]) -> Iterator[RankedDraw]:
        """Yield the tasks with the given ascending numbers, until there are no more."""
        requested = iter(numbers)
        following = next(requested, None)
        seen: set[Letters] = set()
        number = 0
        while following is not None and len(seen) < self.size:
            word = self.draw(number)
            number += 1
            if word in seen:
                continue
            if len(seen) == following:
                yield RankedDraw(word, self.words.require_rank(word), self.probability)
                following = next(requested, None)
            seen.add(word)


def strata_of(space: TaskSpace, by: StratifiedBy, *, seed: int, most: int) -> list[Stratum]:
    """Return the nonempty strata of a space.

    Tasks of different lengths are always in different strata. The goal of a task is the known part of its final state.

    Raises:
        QueryError: the space is empty, there are more than `most` strata, or `by` is unknown.
    """
    if by not in STRATIFIED_BY:
        raise QueryError(f"strata are those of {', '.join(STRATIFIED_BY)}; got {by!r}")
    sets = nonempty_sets(space.sampling(weights={}))
    probability = Fraction(1, sum(words.count() for words in sets))
    strata: list[Stratum] = []
    for words in sets:
        length = space.at(words.length)
        if by == "length" or not words.length:
            order = distinct_order(length.sampling(weights={}), seed)
            assert isinstance(order, UniformOrder)
            strata.append(Stratum(f"length_{words.length}", order.size, replace(order, probabilities=[probability])))
            continue
        found = _strata_of_length(length, by, words, seed, probability, most - len(strata))
        strata += found
    return _named(strata, by)


def _strata_of_length(
    space: TaskSpace, by: StratifiedBy, words: WordSet, seed: int, probability: Fraction, most: int
) -> list[Stratum]:
    """Return the strata for the skeletons or goals of one length.

    Raises:
        QueryError: there are more than `most` strata.
    """
    sampler = space.sampling(weights={}, over=_OVER[by]).sampler()
    assert isinstance(sampler, (SkeletonSampler, GoalSampler))
    letters, names = words.engine.letters, sorted({*map(action_name, space.domain.facts.actions)})
    count = sampler.count if isinstance(sampler, SkeletonSampler) else len(sampler.weights)
    if count > most:
        raise QueryError(
            f"{space.title} has {count} {by}s, and a sample needs 2 tasks of each; request more tasks, or choose other "
            "strata"
        )
    draws: list[tuple[str, int, Callable[[int], Letters]]] = []
    for number in range(count):
        bits = SeededBits(seed, f" {by} {words.length} {number}")
        if isinstance(sampler, SkeletonSampler):
            name = "_".join(names[letter] for letter in sampler.skeleton(number))
            draws.append((name, sampler.weight(number), partial(_with_skeleton, sampler, number, bits, letters)))
        else:
            draw = partial(_with_goal, sampler, number, bits, letters)
            draws.append(("", int(sampler.weights[number]), draw))
    if isinstance(sampler, GoalSampler):  # the engine may number goals in any order; the order of their texts is fixed
        tasks = space.tasks_of_plans([draw(0) for _, _, draw in draws])
        texts = [sorted(f"{fact}={value}" for fact, value in task.states[-1].items()) for task in tasks]
        order = sorted(range(count), key=lambda number: texts[number])
        draws = [(f"goal_{words.length}_{place}", *draws[number][1:]) for place, number in enumerate(order, 1)]
    return [Stratum(name, size, StratumOrder(words, size, draw, probability)) for name, size, draw in draws]


def _with_skeleton(sampler: SkeletonSampler, rank: int, bits: SeededBits, letters: Letters, number: int) -> Letters:
    """Return a uniformly random task with a skeleton."""
    return tuple(letters[letter] for letter in sampler.of_rank(rank, bits, number)[0])


def _with_goal(sampler: GoalSampler, goal: int, bits: SeededBits, letters: Letters, number: int) -> Letters:
    """Return a uniformly random task with a goal."""
    return tuple(letters[letter] for letter in sampler.of_goal(goal, bits, number))


def _named(strata: Sequence[Stratum], by: StratifiedBy) -> list[Stratum]:
    """Return the strata, numbered if their names are not unique or cannot be part of file names."""
    folded = Counter(stratum.name.casefold() for stratum in strata)
    usable = all(
        folded[stratum.name.casefold()] == 1
        and len(stratum.name) <= LONGEST_NAME
        and re.fullmatch(r"\w+", stratum.name)
        for stratum in strata
    )
    return [stratum if usable else replace(stratum, name=f"{by}_{number}") for number, stratum in enumerate(strata, 1)]
