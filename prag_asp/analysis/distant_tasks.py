"""Find all tasks of a space that are at least a given number of edits away from every task of another part.

A row holds, for each state of the other part's automaton, the number of edits that turn a prefix of a plan into some
prefix that leads to that state; numbers are capped at the required distance. Rows are states of a deterministic
automaton for the neighbourhood of a whole regular language. Its product with the automaton of the space is an automaton
of the tasks that remain, which are counted, ranked and sampled like other tasks.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.layered_automaton import LayeredAutomaton, layered_words, layers_of
from prag_asp.errors import LimitReached, QueryError
from prag_asp.processes.progress_events import stage
from prag_asp.space.automaton.automaton import NOTHING, Automaton, Completions, Ranking
from prag_asp.space.limits import LimitClock
from prag_asp.space.parts.ranked_tasks import RankedTasks, RankRange
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.weights.weights import Weights
from prag_asp.space.word_set import WordSet
from prag_asp.stop_reason import StopKind, StopReason
from prag_asp.task import Task

TOGETHER = 1 << 22
"""The number of edit counts that are computed at a time."""

FARTHEST = 100
"""The largest distance, so that rows fit into 8 bits."""

MOST_ROWS = 1 << 15
"""The maximum number of rows of edits in one layer; beyond it, the number of rows usually grows exponentially."""

Bytes = NDArray[np.int8]


def tasks_apart(space: TaskSpace, other: TaskSpace, distance: int) -> RankedTasks:
    """Return the tasks of a space that are at least `distance` edits from each task of another part, in rank order.

    An edit inserts, removes or replaces an action, up to renaming of interchangeable entities. Both spaces are parts of
    one space, as `hold_out` and `split_skeletons` return them.

    Raises:
        QueryError: the distance is not between 1 and 100, or the spaces have different symmetries or several lengths.
        LimitReached: a limit was reached, or the rows do not fit into memory.
    """
    apart = tasks_apart_from_all(space, [(other, distance)])
    return RankedTasks(RankRange(range(apart.count())), apart)


def tasks_apart_from_all(space: TaskSpace, others: Iterable[tuple[TaskSpace, int]]) -> TasksApart:
    """Return the tasks of a space of one length that are far from each task of other parts, of any length.

    Raises:
        QueryError: a distance is not between 1 and 100, or the spaces have different symmetries.
        LimitReached: a limit was reached, or the rows do not fit into memory.
    """
    words = layered_words(space, "task")
    automaton = NOTHING if words.edges is None else space.engines.engine("task", space.length).weighed(
        space.length, Weights(), plain=True
    ).automaton  # fmt: skip
    for other, distance in others:
        if not 1 <= distance <= FARTHEST:
            raise QueryError(f"a distance of {distance}: give one from 1 to {FARTHEST}")
        for length in (each for each in other.lengths if abs(each - space.length) < distance):
            plans = other.at(length)
            if space.symmetries != plans.symmetries:
                raise QueryError(
                    f"{space.title} and {plans.title} have different interchangeable entities; give parts of one space"
                )
            stage("comparing the parts")
            automaton = words_apart(words, layered_words(plans, "plan"), distance, space.engines.limits.begin())
            words = LayeredAutomaton(space.length, words.letters, layers_of(automaton, space.length))
    return TasksApart(space, words.letters, automaton)


@dataclass(frozen=True)
class TasksApart:
    """The tasks that an automaton accepts; its letters are actions of a space."""

    space: TaskSpace
    letters: tuple[str, ...]
    automaton: Automaton

    @cached_property
    def ranking(self) -> Ranking:
        """The ranks of the words."""
        return Ranking(Completions(self.automaton), self.space.length)

    @property
    def length(self) -> int:
        """The number of actions of each task."""
        return self.space.length

    def count(self) -> int:
        """Return the number of tasks."""
        return self.ranking.total

    def word(self, rank: int) -> tuple[str, ...]:
        """Return the plan of a task, as `plan_at` does."""
        return self.plan_at(rank)

    def rank(self, word: Sequence[str]) -> int | None:
        """Return the rank of the task with a plan, given as texts of actions; None if it is not one of these tasks."""
        words = WordSet(self.space.engines, "task", self.length)
        place = words.rank(tuple(word))
        return None if place is None else self.ranking.rank([self.letters.index(each) for each in words.word(place)])

    def plan_at(self, rank: int) -> tuple[str, ...]:
        """Return the plan of the task with a given rank as the texts of its actions."""
        return tuple(self.letters[letter] for letter in self.ranking.unrank(rank))

    def tasks_of_plans(self, plans: Iterable[Sequence[str]]) -> Iterator[Task]:
        """Yield the tasks of plans that are given as texts of actions."""
        return self.space.tasks_of_plans(plans)

    def index(self, task: Task) -> int:
        """Return the rank of a task.

        Raises:
            QueryError: the task is too near, or not in the space.
        """
        rank = self.rank(self.space.plan_at(self.space.index(task)))
        if rank is None:
            raise QueryError(f"the task is too near to the other part: {task}")
        return rank


def words_apart(words: LayeredAutomaton, plans: LayeredAutomaton, distance: int, clock: LimitClock) -> Automaton:
    """Return the automaton of the words that are at least `distance` edits away from all plans.

    Raises:
        LimitReached: a limit was reached.
    """
    if words.edges is None:
        return NOTHING
    rows = EditRows(words, plans, distance)
    held, pairs = rows.start(), np.zeros((1, 2), dtype=np.int64)
    degrees, letters, targets, known = [], [], [], 1
    for place, step in enumerate(words.edges):
        number = np.diff(np.append(step.begins, len(step.letters)))[pairs[:, 1]]
        edges = np.arange(number.sum()) + np.repeat(step.begins[pairs[:, 1]] - np.cumsum(number) + number, number)
        origins = np.repeat(pairs[:, 0], number)
        reason = clock.reached_limit(6 * held.nbytes + 8 * len(edges))
        if reason or len(held) > MOST_ROWS:
            why = reason.prose() if reason else "the maximum for an exact number"
            raise LimitReached(
                f"{why} was reached with {len(held):,} rows of edits; give a smaller distance or other parts", 0,
                reason or StopReason(StopKind.FORECAST),
            )  # fmt: skip
        width = len(words.letters)
        moves, move = np.unique(origins * width + step.letters[edges], return_inverse=True)
        held, row = rows.move(held, moves // width, moves % width, place)
        size = words.sizes[place + 1]
        following, target = np.unique(row[move] * size + step.targets[edges], return_inverse=True)
        pairs = np.column_stack([following // size, following % size])
        degrees.append(number)
        letters.append(step.letters[edges])
        targets.append(target + known)
        known += len(pairs)
    accepting = np.zeros(known, dtype=np.bool_)
    accepting[known - len(pairs) :] = rows.far(held)[pairs[:, 0]]
    all_degrees = np.concatenate([*degrees, np.zeros(len(pairs), dtype=np.int64)])
    offsets = np.concatenate([[0], np.cumsum(all_degrees)]).astype(np.int64)
    return Automaton(offsets, np.concatenate(letters), np.concatenate(targets), accepting, horizon=words.length)


class EditRows:
    """The rows of words: for each state of a layer, the fewest edits to a prefix of a plan that leads to it.

    A row has a block of numbers for each layer within the distance (see `_layers`); the other layers need too many
    edits.
    """

    def __init__(self, words: LayeredAutomaton, plans: LayeredAutomaton, distance: int) -> None:
        self._length, self._plans, self._distance = words.length, plans, distance
        numbers = {letter: number for number, letter in enumerate(words.letters)}
        named = np.array([numbers.get(letter, -1) for letter in plans.letters], dtype=np.int64)
        self._steps = []
        for step in plans.edges or ():
            order = np.argsort(step.targets, kind="stable")
            begins = np.unique(step.targets[order], return_index=True)[1]
            self._steps.append((step.sources[order], named[step.letters[order]], begins))

    def start(self) -> Bytes:
        """Return the row of the empty word."""
        blocks: dict[int, Bytes] = {}
        for layer in self._layers(0):
            edits = 0 if layer == 0 else layer
            block = np.full((1, self._plans.sizes[layer]), edits, dtype=np.int8)
            blocks[layer] = self._capped(block, layer, 0)
        return self._joined(blocks, 1)

    def move(
        self, held: Bytes, origins: NDArray[np.int64], letters: NDArray[np.int64], place: int
    ) -> tuple[Bytes, NDArray[np.int64]]:
        """Return the distinct rows after one more letter, and for each origin and letter, the index of its new row."""
        widest = max([len(sources) for sources, _, _ in self._steps], default=1)
        size = max(TOGETHER // max(widest, held.shape[1]), 1)
        parts = [
            self._moved(held[origins[begin : begin + size]], letters[begin : begin + size], place)
            for begin in range(0, len(origins), size)
        ]
        moved = np.ascontiguousarray(np.concatenate(parts))
        if not moved.shape[1]:
            return moved[:1], np.zeros(len(moved), dtype=np.int64)
        keys = moved.view(np.dtype((np.void, moved.shape[1]))).ravel()
        _, first, number = np.unique(keys, return_index=True, return_inverse=True)
        return moved[first], number

    def far(self, held: Bytes) -> NDArray[np.bool_]:
        """Return whether the words with these rows are far enough from all plans."""
        last = self._blocks(held, self._length).get(len(self._steps))
        return np.ones(len(held), dtype=np.bool_) if last is None else last[:, 0] >= self._distance

    def _layers(self, place: int) -> range:
        """Return the layers of plans within fewer than `distance` edits of words with `place` letters."""
        if self._plans.edges is None:
            return range(0)
        nearest = self._distance - 1
        return range(max(place - nearest, 0), min(place + nearest, len(self._steps)) + 1)

    def _blocks(self, held: Bytes, place: int) -> dict[int, Bytes]:
        layers = self._layers(place)
        bounds = np.cumsum([self._plans.sizes[layer] for layer in layers])[:-1]
        return dict(zip(layers, np.split(held, bounds, axis=1), strict=True)) if len(layers) else {}

    def _joined(self, blocks: dict[int, Bytes], rows: int) -> Bytes:
        return np.concatenate([np.zeros((rows, 0), dtype=np.int8), *blocks.values()], axis=1)

    def _capped(self, block: Bytes, layer: int, place: int) -> Bytes:
        needed = abs((len(self._steps) - layer) - (self._length - place))
        return np.where(block + needed >= self._distance, self._distance, block).astype(np.int8)

    def _moved(self, held: Bytes, letters: NDArray[np.int64], place: int) -> Bytes:
        before = self._blocks(held, place)
        after: dict[int, Bytes] = {}
        for layer in self._layers(place + 1):
            block = np.full((len(held), self._plans.sizes[layer]), self._distance, dtype=np.int8)
            if layer in before:
                block = np.minimum(block, before[layer] + 1)  # the letter is inserted
            if layer:
                sources, named, begins = self._steps[layer - 1]
                if layer - 1 in before:  # the letter is that of the plan, or replaces it
                    replaced = before[layer - 1][:, sources] + (named != letters[:, None])
                    block = np.minimum(block, np.minimum.reduceat(replaced, begins, axis=1))
                if layer - 1 in after:  # a letter of the plan is removed
                    block = np.minimum(block, np.minimum.reduceat(after[layer - 1][:, sources] + 1, begins, axis=1))
            after[layer] = self._capped(block.astype(np.int8), layer, place + 1)
        return self._joined(after, len(held))
