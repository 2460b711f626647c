"""Count the tasks of a space within an edit distance of a given task, and find the nearest one, without listing tasks.

A row of the table of Wagner and Fischer (1974) holds the numbers of edits that turn a prefix of a word into each prefix
of the given plan. Numbers above the radius are capped, so that few distinct rows remain. They are the states of a
deterministic Levenshtein automaton (Schulz and Mihov 2002), which is run in parallel with the automaton of the space.
There is a row for each renaming of the given plan, and the smallest number at the end is the distance. Each task of the
space is one path.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any, Literal

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.layered_automaton import LayeredAutomaton, LayerEdges, layered_words
from prag_asp.analysis.letter_renamings import plan_images
from prag_asp.atom import Atom
from prag_asp.errors import LimitReached, QueryError
from prag_asp.processes.progress_events import stage
from prag_asp.space.engines.prefix import parse_plan
from prag_asp.space.limits import LimitClock
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

Metric = Literal["levenshtein", "hamming"]
METRICS: tuple[Metric, ...] = ("levenshtein", "hamming")

Plan = Task | Sequence[str | Atom]

FAR = 1 << 14
"""A number of edits that exceeds every distance; the sum of two such numbers fits into 16 bits."""

FARTHEST = 100
"""The largest radius of a neighbourhood, for which capped rows fit into 8 bits."""

SAFE = 2**62
"""Numbers of words below this bound fit into 64 bits."""


@dataclass(frozen=True)
class NearestTask:
    """A task of a space at the smallest distance from a given task, as the texts of its actions."""

    distance: int
    plan: tuple[str, ...]


@dataclass(frozen=True)
class Target:
    """A given plan under each renaming, shape (images, actions), as indices of letters, or -1 for none."""

    images: NDArray[np.int64]
    metric: Metric

    def start(self) -> NDArray[np.int64]:
        """Return the numbers of edits from the empty word to each prefix of the plan, shape (actions + 1,)."""
        row = np.arange(self.images.shape[1] + 1)
        if self.metric == "hamming":
            row[1:] = FAR
        return row

    def move(self, rows: NDArray[Any], letters: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the rows after each has read one more letter, shape (rows, images, actions + 1)."""
        differs = self.images[None] != letters[:, None, None]
        moved = np.full(rows.shape, FAR, dtype=np.int64)
        moved[:, :, 1:] = rows[:, :, :-1] + differs
        return moved if self.metric == "hamming" else _with_skips(np.minimum(moved, rows + 1))


def _with_skips(rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the rows after also allowing actions of the plan to be skipped, at one edit each."""
    places = np.arange(rows.shape[-1])
    skipped: NDArray[np.int64] = np.minimum.accumulate(rows - places, axis=-1) + places
    return skipped


def count_neighbours(space: TaskSpace, task: Plan, up_to: int = 3, metric: Metric = "levenshtein") -> tuple[int, ...]:
    """Return the numbers of tasks in a space at the distances 0, 1, ..., `up_to` from a task, which may be outside it.

    The Levenshtein distance is the smallest number of actions to insert, remove or replace, over all renamings of the
    interchangeable entities of the space; the Hamming distance counts only replaced actions. If there are several
    lengths, the numbers are added up.

    Raises:
        QueryError: the radius is out of range, the metric is unknown, or the task contains an action that the domain
            does not have.
        LimitReached: a limit was reached, or the rows of edits do not fit into memory.
    """
    if metric not in METRICS or not 0 <= up_to <= FARTHEST:
        raise QueryError(f"{metric} up to {up_to}: give {' or '.join(METRICS)}, with 0 to {FARTHEST} edits")
    plan, clock = _symbols(space, task), space.engines.limits.begin()
    totals = [0] * (up_to + 1)
    for words, target in _targets(space, plan, metric, up_to):
        stage("counting neighbours")
        for distance, number in enumerate(_within(words, target, up_to, clock)):
            totals[distance] += number
    return tuple(totals)


def nearest_task(space: TaskSpace, task: Plan, metric: Metric = "levenshtein") -> NearestTask:
    """Return a task of a space at the smallest distance from a given task; for distances, see `count_neighbours`.

    The distance is exact: it is the length of a shortest path in the product of the automaton and the plan.

    Raises:
        QueryError: the space has no task (or, with `metric` hamming, none of the same length), or there is no such
            metric.
        LimitReached: a limit ended the exploration.
    """
    if metric not in METRICS:
        raise QueryError(f"{metric}: give {' or '.join(METRICS)}")
    plan = _symbols(space, task)
    best: NearestTask | None = None
    for words, target in _targets(space, plan, metric, None):
        found = _shortest(words, target)
        if best is None or found.distance < best.distance:
            best = found
    if best is None:
        raise QueryError(f"there is no task of {space.title} to compare with a task of {len(plan)} actions")
    return best


def _symbols(space: TaskSpace, task: Plan) -> tuple[clingo.Symbol, ...]:
    return tuple(parse_plan(task.actions if isinstance(task, Task) else task, space.domain.facts))


def _targets(
    space: TaskSpace, plan: Sequence[clingo.Symbol], metric: Metric, up_to: int | None
) -> Iterator[tuple[LayeredAutomaton, Target]]:
    """Yield the words of each length that may be close enough, with the plan's images as letters of these words."""
    for length in sorted(space.lengths, key=lambda each: abs(each - len(plan))):
        away = abs(length - len(plan))
        if (metric == "hamming" and away) or (up_to is not None and away > up_to):
            continue
        here = space.at(length)
        words = layered_words(here, "task")
        numbers = {letter: number for number, letter in enumerate(words.letters)}
        images = [[numbers.get(str(each), -1) for each in image] for image in plan_images(here, plan)]
        if words.edges is not None:
            yield words, Target(np.array(images, dtype=np.int64).reshape(len(images), len(plan)), metric)


def _within(words: LayeredAutomaton, target: Target, up_to: int, clock: LimitClock) -> list[int]:
    """Return the number of words at each distance from 0 to `up_to`."""
    size = target.images.shape[1]
    rows = np.repeat(_capped(target.start(), up_to, words.length, size)[None, None], len(target.images), axis=1)
    numbers = np.ones((1, 1), dtype=np.int64 if words.total < SAFE else object)
    for place, step in enumerate(words.edges or ()):
        left = words.length - place - 1
        states = words.sizes[place + 1]
        moved_rows, moved_numbers = [], []
        for letter, edges in _letter_classes(step, target):
            reason = clock.reached_limit(2 * rows.nbytes)
            if reason:
                message = f"{reason.prose()} was reached with {len(rows):,} rows of edits; take a smaller radius"
                raise LimitReached(message, 0, reason)
            passed = _passed(numbers, step, edges, states)
            used = np.flatnonzero(passed.any(axis=1))
            moved = _capped(target.move(rows[used], np.array([letter])), up_to, left, size)
            near = (moved <= up_to).any(axis=(1, 2))
            moved_rows.append(moved[near])
            moved_numbers.append(passed[used[near]])
        rows, numbers = _summed(np.concatenate(moved_rows), np.concatenate(moved_numbers))
    distances = rows[:, :, -1].min(axis=1)
    return [int(sum(numbers[distances == distance, 0].tolist())) for distance in range(up_to + 1)]


def _capped(rows: NDArray[np.int64], up_to: int, left: int, size: int) -> NDArray[np.int8]:
    """Return rows in which a number is `up_to` + 1 if it exceeds `up_to` after adding the edits still needed."""
    needed = np.abs(size - np.arange(size + 1) - left)
    return np.where(rows + needed > up_to, up_to + 1, rows).astype(np.int8)


def _letter_classes(step: LayerEdges, target: Target) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Yield each letter of the plan with its edges, and -2 with all other edges, in the order of their targets."""
    of_plan = set(target.images.ravel().tolist()) & set(step.letters.tolist())
    others = np.flatnonzero(~np.isin(step.letters, list(of_plan)))
    classes = [(letter, np.flatnonzero(step.letters == letter)) for letter in sorted(of_plan)] + [(-2, others)]
    for letter, edges in classes:
        if len(edges):
            yield letter, edges[np.argsort(step.targets[edges], kind="stable")]


def _passed(numbers: NDArray[Any], step: LayerEdges, edges: NDArray[np.int64], states: int) -> NDArray[Any]:
    """Return, for each row, the number of words that reach each state of the next layer through the given edges."""
    targets, begins = np.unique(step.targets[edges], return_index=True)
    passed = np.zeros((len(numbers), states), dtype=numbers.dtype)
    passed[:, targets] = np.add.reduceat(numbers[:, step.sources[edges]], begins, axis=1)
    return passed


def _summed(rows: NDArray[np.int8], numbers: NDArray[Any]) -> tuple[NDArray[np.int8], NDArray[Any]]:
    """Return the distinct rows, and the sum of the numbers of equal rows."""
    if not len(rows):
        return rows, numbers
    flat = np.ascontiguousarray(rows.reshape(len(rows), -1))
    keys = flat.view(np.dtype((np.void, flat.shape[1]))).ravel()
    order = np.argsort(keys, kind="stable")
    _, begins = np.unique(keys[order], return_index=True)
    return rows[order[begins]], np.add.reduceat(numbers[order], begins, axis=0)


def _shortest(words: LayeredAutomaton, target: Target) -> NearestTask:
    """Return the nearest word: a shortest path, traced back from the smallest number of edits at the end."""
    rows = [np.tile(target.start(), (1, len(target.images), 1))]
    for step, states in zip(words.edges or (), words.sizes[1:], strict=True):
        order = np.argsort(step.targets, kind="stable")
        begins = np.searchsorted(step.targets[order], np.arange(states))
        rows.append(np.minimum.reduceat(target.move(rows[-1][step.sources[order]], step.letters[order]), begins))
    image = int(rows[-1][0, :, -1].argmin())
    place, state = target.images.shape[1], 0
    distance = int(rows[-1][0, image, place])
    own = Target(target.images[image : image + 1], target.metric)
    letters: list[int] = []
    for depth in range(words.length, 0, -1):
        step = (words.edges or ())[depth - 1]
        edges = np.flatnonzero(step.targets == state)
        before = rows[depth - 1][step.sources[edges], image : image + 1]
        moved = own.move(before, step.letters[edges])[:, 0]
        edge = int(moved[:, place].argmin())
        chosen = int(edges[edge])
        place = _place_before(before[edge, 0], int(moved[edge, place]), own.images[0], int(step.letters[chosen]), place)
        letters.append(int(step.letters[chosen]))
        state = int(step.sources[chosen])
    return NearestTask(distance, tuple(words.letters[letter] for letter in reversed(letters)))


def _place_before(row: NDArray[Any], edits: int, plan: NDArray[np.int64], letter: int, place: int) -> int:
    """Return the length of the plan's prefix before a letter; `place` is the length of the prefix after this letter."""
    for skipped in count():
        after = place - skipped
        if after and row[after - 1] + (plan[after - 1] != letter) == edits - skipped:
            return after - 1
        if row[after] + 1 == edits - skipped:
            return after
    raise AssertionError("the edits come from no earlier row")
