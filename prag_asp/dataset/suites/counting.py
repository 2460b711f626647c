"""Exact counts of the tasks in each part of a suite, and of the tasks that two parts share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.store.manifest import Decimal
from prag_asp.errors import QueryError
from prag_asp.integers import digits_of, number_of
from prag_asp.processes.progress_events import report_progress
from prag_asp.space.limits import UNLIMITED
from prag_asp.space.task_space import TaskSpace
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.dataset_spec import ApartSpec
    from prag_asp.dataset.suites.suite_spec import Suite, SuitePart
    from prag_asp.space.limits import Limits

Counted = Callable[[str, int, int], None]
"""A callback that reports progress: a message, the number of completed counts, and the total number."""


class Overlap(msgspec.Struct, frozen=True):
    """The number of tasks that two parts share, and whether one of the parts declares that it may share tasks."""

    one: str
    other: str
    digits: Decimal = msgspec.field(name="tasks")
    declared: bool = False

    @property
    def tasks(self) -> int:
        """The number of tasks."""
        return number_of(self.digits)


class HeldOutCount(msgspec.Struct, frozen=True):
    """The number of tasks in a part that contain something held out from it."""

    what: str
    part: str
    digits: Decimal = msgspec.field(name="tasks")

    @property
    def tasks(self) -> int:
        """The number of tasks."""
        return number_of(self.digits)


@dataclass(frozen=True)
class Figures:
    """The exact figures of a suite: the sizes of parts by length, and the counts of shared and held-out tasks."""

    sizes: Mapping[str, Mapping[int, int]]
    shared: tuple[Overlap, ...]
    unseen: tuple[HeldOutCount, ...]

    def size(self, part: str) -> int:
        """Return the number of tasks in the space of a part."""
        return sum(self.sizes[part].values())

    @property
    def leaks(self) -> tuple[Overlap, ...]:
        """The pairs of parts that share tasks without declaring it."""
        return tuple(each for each in self.shared if each.tasks and not each.declared)


def space_of(suite: Suite, part: SuitePart, *, limits: Limits = UNLIMITED) -> TaskSpace:
    """Return the space of a part."""
    return TaskSpace(suite.domain, part.lengths, limits=limits).where(*part.where)


def count_suite(suite: Suite, *, limits: Limits = UNLIMITED, progress: Counted = report_progress) -> Figures:
    """Count the tasks of all parts, the tasks that each pair of parts shares, and the held-out tasks in each part.

    Raises:
        QueryError: a part requests more tasks than its space has.
        LimitReached: a limit ended a count.
    """
    count = _SuiteCounter(suite, limits, progress)
    sizes = {}
    for name, part in suite.parts.items():
        sizes[name] = count.by_length(name, part.where, part.lengths, [part])
        total = sum(sizes[name].values())
        if total < part.tasks:
            problem = f"{plural(part.tasks, 'task')} requested for {name}, but its space has {total}"
            raise QueryError(
                f"{suite.place('parts', name, 'tasks')}: {problem}; ask for fewer, or give other conditions"
            )
    shared = []
    for one, other in combinations(suite.parts.values(), 2):
        both = [length for length in one.lengths if length in other.lengths]
        if other.name in one.distance or one.name in other.distance:
            both = []  # a shared task would be at distance 0
        tasks = count.by_length(f"{one.name} and {other.name}", (*one.where, *other.where), both, [one, other])
        shared.append(Overlap(one.name, other.name, digits_of(sum(tasks.values())), one.declares(other)))
    unseen = []
    for held in suite.held:
        for part in suite.parts.values():
            if held.what not in part.unseen:
                what = f"{held.what} in {part.name}"
                tasks = count.by_length(what, (*part.where, held.having), part.lengths, [part])
                unseen.append(HeldOutCount(held.what, part.name, digits_of(sum(tasks.values()))))
    return Figures(sizes, tuple(shared), tuple(unseen))


class _SuiteCounter:
    """A counter of tasks under conditions; each number is computed only once."""

    def __init__(self, suite: Suite, limits: Limits, progress: Counted) -> None:
        self._suite, self._progress = suite, progress
        self._domain = TaskSpace(suite.domain, 0, limits=limits)
        self._counts: dict[tuple[frozenset[str], int], int] = {}
        self._lengths: dict[frozenset[str], set[int]] = {}
        for part in suite.parts.values():
            self._lengths.setdefault(frozenset(part.where), set()).update(part.lengths)
        parts = len(suite.parts)
        self._done, self._total = 0, parts + parts * (parts - 1) // 2 + parts * len(suite.held)

    def by_length(
        self, what: str, clauses: Sequence[str], lengths: Sequence[int], parts: Sequence[SuitePart]
    ) -> dict[int, int]:
        """Return, for each length, the number of tasks that satisfy `clauses` and the distances required by `parts`."""
        self._progress(f"counting {what}", self._done, self._total)
        self._done += 1
        conditions = frozenset(clauses)
        if any({held.having, held.without} <= conditions for held in self._suite.held):
            return dict.fromkeys(lengths, 0)  # the conditions are negations of each other
        if apart := [each for part in parts for each in self._suite.apart_from(part)]:
            spaces = (self._domain.at(length).where(*dict.fromkeys(clauses)) for length in lengths)
            return {space.length: count_apart(space, apart) for space in spaces}
        if any((conditions, length) not in self._counts for length in lengths):
            # Exploring the longest plans covers shorter ones, including those in other parts with these conditions.
            lengths_needed = self._lengths.get(conditions, set()).union(lengths)
            missing = sorted(length for length in lengths_needed if (conditions, length) not in self._counts)
            space = self._domain.at(missing[-1]).where(*dict.fromkeys(clauses))
            for length in reversed(missing):
                self._counts[conditions, length] = space.at(length).count()
        return {length: self._counts[conditions, length] for length in lengths}


def count_apart(space: TaskSpace, apart: Sequence[ApartSpec]) -> int:
    """Return the number of tasks of a space of one length that are far from all tasks in the given sets.

    Raises:
        QueryError: the space and a set have different interchangeable entities.
        LimitReached: a limit was reached.
    """
    from prag_asp.analysis.distant_tasks import tasks_apart_from_all

    return tasks_apart_from_all(space, [(each.space(space), each.distance) for each in apart]).count()


def refuse_leaks(suite: Suite, figures: Figures) -> None:
    """Refuse a suite in which parts share tasks without declaring it.

    Raises:
        QueryError: two parts share tasks that the suite does not declare.
    """
    problems = []
    for leak in figures.leaks:
        what = f"{leak.one} and {leak.other} have {plural(leak.tasks, 'task')} in common"
        remedy = f'separate them by conditions, or add shares = "{leak.one}" to [parts.{leak.other}]'
        problems.append(f"{suite.place('parts', leak.other)}: {what}; {remedy}")
    if problems:
        raise QueryError(*problems)
