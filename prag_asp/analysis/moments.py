"""Exact second moments of the features of a plan: the numbers of words with two given values at two positions.

The features of a plan are one value for each position: the actions, their names, their names with the classes of their
arguments, or the pairs of consecutive names. The dynamic programme follows the paths through each value at one position
to all later positions, so that no word is listed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.layered_automaton import LayeredAutomaton, LayerEdges, Objects, layered_words, sums_at
from prag_asp.errors import QueryError
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name
from prag_asp.space.engines import Level
from prag_asp.space.engines.prefix import parse_plan
from prag_asp.space.plans.canonical_plan import canonical_names
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

Feature = Literal["actions", "names", "classes", "pairs"]
FEATURES: tuple[Feature, ...] = ("actions", "classes", "names", "pairs")

MOST_COLUMNS = 4096
"""The maximum number of distinct values, summed over all positions; the eigenvalues of such a matrix take half a
minute.
"""

SAFE = 2**62
"""A bound on sums that are computed in 64 bits."""


@dataclass(frozen=True)
class Moments:
    """The numbers of words in a set in which two values occur at two positions.

    `columns` holds all pairs of a position (from 0) and a value that occurs there, in order; ``joint[k, l]`` is the
    number of words with the values of the columns k and l. Each of the `words` words has one value at each of `places`
    positions.
    """

    feature: Feature
    words: int
    places: int
    columns: tuple[tuple[int, str], ...]
    joint: Objects

    @cached_property
    def values(self) -> tuple[str, ...]:
        """The values that occur at any position."""
        return tuple(sorted({value for _, value in self.columns}))

    @cached_property
    def occurrences(self) -> Objects:
        """The total number of occurrences of each value in all words, shape (values,)."""
        return sums_at(np.diagonal(self.joint), self._value_of_column, len(self.values))

    @cached_property
    def products(self) -> Objects:
        """The sum over all words of the product of the occurrences of two values, shape (values, values)."""
        size, places = len(self.values), self._value_of_column
        rows = np.array([sums_at(row, places, size) for row in self.joint]).reshape(-1, size)
        return np.array([sums_at(column, places, size) for column in rows.T]).reshape(size, size)

    @cached_property
    def _value_of_column(self) -> NDArray[np.int64]:
        number = {value: place for place, value in enumerate(self.values)}
        return np.array([number[value] for _, value in self.columns], dtype=np.int64)


@dataclass(frozen=True)
class ValuedSteps:
    """The words of a space, with the index of a value in `texts` for each edge of each step, or -1 for none."""

    words: LayeredAutomaton
    values: tuple[NDArray[np.int64], ...]
    texts: tuple[str, ...]


def space_moments(space: TaskSpace, feature: Feature, by: Level = "task") -> Moments:
    """Return the second moments of all words of a level of a space.

    Raises:
        QueryError: the space has several lengths, no words or no positions, or the level has no such feature.
        LimitReached: a limit ended the exploration.
    """
    texts_of(space, feature, by, ())  # checks the feature
    words = layered_words(space, by)
    if words.edges is None:
        raise QueryError(f"there is no {by} of {space.title}")
    stage("counting pairs of positions")
    texts = texts_of(space, _single(feature), by, words.letters)
    different = tuple(sorted(set(texts)))
    numbers = np.array([different.index(text) for text in texts], dtype=np.int64)
    if feature == "pairs":
        steps = _paired(words, numbers, different)
    else:
        steps = ValuedSteps(words, tuple(numbers[step.letters] for step in words.edges), different)
    columns, joint = _joint(steps)
    places = words.length - (feature == "pairs")
    return Moments(feature, words.total, _some_places(places, space), columns, joint)


def task_moments(space: TaskSpace, tasks: Iterable[Task | Sequence[str]], feature: Feature) -> Moments:
    """Return the second moments of the given tasks, which all have the length of a space.

    Interchangeable entities get the canonical names that they have in the space. A task that occurs twice counts twice.

    Raises:
        QueryError: there is no task, or a task has a different length or contains something that is not an action of
            the domain.
    """
    actions, rows = space.engines.actions, []
    values = dict(zip(actions, texts_of(space, _single(feature), "task", tuple(actions)), strict=True))
    for task in tasks:
        given = list(map(str, task.actions if isinstance(task, Task) else task))
        known = all(action in actions for action in given)
        plan = [actions[action] for action in given] if known else parse_plan(given, space.domain.facts)
        if len(plan) != space.length:
            raise QueryError(f"a task of {len(plan)} actions, but the space is {space.title}: {' '.join(given)}")
        names = canonical_names(plan, space.symmetries)
        texts = [values[str(renamed(action, names))] for action in plan]
        rows.append([f"{one}>{other}" for one, other in pairwise(texts)] if feature == "pairs" else texts)
    if not rows:
        raise QueryError(f"there is no task to compare with {space.title}")
    places = _some_places(len(rows[0]), space)
    columns = sorted({(place, text) for row in rows for place, text in enumerate(row)})
    number = {column: position for position, column in enumerate(columns)}
    _check_columns(len(columns))
    held = np.array([[number[column] for column in enumerate(row)] for row in rows], dtype=np.int64)
    joint = np.zeros(len(columns) ** 2, dtype=np.int64)
    for place in range(places):
        joint += np.bincount(
            (held[:, place, None] * len(columns) + held).ravel(), minlength=len(joint)
        )  # fmt: skip
    return Moments(
        feature, len(rows), places, tuple(columns), joint.astype(object).reshape(len(columns), len(columns))
    )  # fmt: skip


def texts_of(space: TaskSpace, feature: Feature, by: Level, letters: Sequence[str]) -> list[str]:
    """Return the value of a feature for each letter.

    Raises:
        QueryError: there is no such feature, or skeletons do not have it.
    """
    if feature not in FEATURES:
        raise QueryError(f"there is no feature {feature}; there are {', '.join(FEATURES)}")
    if by == "skeleton":
        if feature not in ("names", "pairs"):
            raise QueryError(f"skeletons have names and pairs, but no {feature}; choose plan or task")
        return list(letters)
    if feature == "actions":
        return list(letters)
    symbols, classes = space.engines.actions, space.domain.facts.entities
    if feature == "classes":
        return [str(renamed(symbols[letter], classes)) for letter in letters]
    return [action_name(symbols[letter]) for letter in letters]


def _single(feature: Feature) -> Feature:
    """Return the feature of single actions from which the values of a feature are composed."""
    return "names" if feature == "pairs" else feature


def _some_places(places: int, space: TaskSpace) -> int:
    if places < 1:
        raise QueryError(f"plans of {space.title} are too short to be compared; take a greater length")
    return places


def _check_columns(number: int) -> None:
    if number > MOST_COLUMNS:
        raise QueryError(
            f"{number:,} different values over all positions, more than {MOST_COLUMNS:,}; "
            "take a shorter length, or classes or names instead of actions"
        )


def _paired(words: LayeredAutomaton, names: NDArray[np.int64], texts: Sequence[str]) -> ValuedSteps:
    """Return words whose states also hold the preceding name, with the pair of names for each edge after the first."""
    width = len(texts)
    states, before = np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
    edges, values = [], []
    for place, step in enumerate(words.edges or ()):
        degrees = np.diff(np.append(step.begins, len(step.letters)))[states]
        own = np.arange(degrees.sum()) + np.repeat(step.begins[states] - np.cumsum(degrees) + degrees, degrees)
        named = names[step.letters[own]]
        coming, targets = np.unique(step.targets[own] * width + named, return_inverse=True)
        if place == words.length - 1:
            coming, targets = np.zeros(1, dtype=np.int64), np.zeros(len(own), dtype=np.int64)
        edges.append(LayerEdges(len(states), np.repeat(np.arange(len(states)), degrees), step.letters[own], targets))
        values.append(np.repeat(before, degrees) * width + named if place else np.full(len(own), -1))
        states, before = np.divmod(coming, width)
    pairs = tuple(f"{one}>{other}" for one in texts for other in texts)
    return ValuedSteps(LayeredAutomaton(words.length, words.letters, tuple(edges)), tuple(values), pairs)


def _joint(steps: ValuedSteps) -> tuple[tuple[tuple[int, str], ...], Objects]:
    """Return the columns of the moments, and the number of words with each pair of them."""
    layers, words = steps.words.edges or (), steps.words
    present = [np.unique(values[values >= 0]) for values in steps.values]
    firsts = np.concatenate([[0], np.cumsum([len(each) for each in present])]).tolist()
    _check_columns(firsts[-1])
    kind = np.int64 if words.total < SAFE else object
    rows = [row.astype(kind) for row in words.completions]
    joint = np.zeros((firsts[-1], firsts[-1]), dtype=object)
    for place, values in enumerate(present):
        if not len(values):
            continue
        through = np.zeros((len(values), words.sizes[place + 1]), dtype=kind)
        weights = words.beginnings[place].astype(kind)[layers[place].sources]
        for number, edges in enumerate(_edges_of(steps.values[place], values)):
            through[number] = _into(weights[edges][None], layers[place].targets[edges], through.shape[1])[0]
        own = slice(firsts[place], firsts[place + 1])
        np.fill_diagonal(joint[own, own], through @ rows[place + 1])
        for later in range(place + 1, words.length):
            step = layers[later]
            for number, edges in enumerate(_edges_of(steps.values[later], present[later])):
                both = through[:, step.sources[edges]] @ rows[later + 1][step.targets[edges]]
                joint[own, firsts[later] + number] = joint[firsts[later] + number, own] = both
            through = _into(through[:, step.sources], step.targets, words.sizes[later + 1])
    columns = tuple((place, steps.texts[value]) for place, values in enumerate(present) for value in values.tolist())
    first = min(place for place, _ in columns) if columns else 0
    return tuple((place - first, text) for place, text in columns), joint


def _edges_of(values: NDArray[np.int64], present: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Return the edges with each of the given values, which are all values of the edges except -1."""
    order = np.argsort(values, kind="stable")
    bounds = np.searchsorted(values[order], np.append(present, values.max() + 1))
    return [order[begin:end] for begin, end in pairwise(bounds.tolist())]


def _into(weights: NDArray[Any], targets: NDArray[np.int64], states: int) -> NDArray[Any]:
    """Return the sums of the columns that have the same target, shape (rows, states)."""
    order = np.argsort(targets, kind="stable")
    reached, begins = np.unique(targets[order], return_index=True)
    sums = np.zeros((len(weights), states), dtype=weights.dtype)
    sums[:, reached] = np.add.reduceat(weights[:, order], begins, axis=1)
    return sums
