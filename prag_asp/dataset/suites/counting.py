"""How many tasks the parts of a suite have, exactly, and that they are apart: by counting what would lie in both."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from prag_asp.errors import QueryError
from prag_asp.space.limits import UNLIMITED
from prag_asp.space.task_space import TaskSpace
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.suites.suite_spec import Part, Suite
    from prag_asp.space.limits import Limits

Counted = Callable[[str, int, int], None]
"""Is told what is being counted, how much was counted, and how much there is to count."""


@dataclass(frozen=True)
class Shared:
    """How many tasks two parts have in common, and whether one of them says that it may."""

    one: str
    other: str
    tasks: int
    declared: bool


@dataclass(frozen=True)
class Unseen:
    """How many tasks of a part have something that is held out from it."""

    what: str
    part: str
    tasks: int


@dataclass(frozen=True)
class Figures:
    """The exact figures of a suite: the sizes of its parts by length, what parts share, and what is unseen in them."""

    sizes: Mapping[str, Mapping[int, int]]
    shared: tuple[Shared, ...]
    unseen: tuple[Unseen, ...]

    def size(self, part: str) -> int:
        """Return how many tasks there are of a part."""
        return sum(self.sizes[part].values())

    @property
    def leaks(self) -> tuple[Shared, ...]:
        """The parts that share tasks, and do not say so."""
        return tuple(each for each in self.shared if each.tasks and not each.declared)


def space_of(suite: Suite, part: Part, *, limits: Limits = UNLIMITED, engine: str = "auto") -> TaskSpace:
    """Return the space of a part."""
    return _space(suite, part.where, part.lengths, limits, engine)


def count_suite(
    suite: Suite, *, limits: Limits = UNLIMITED, progress: Counted = lambda words, done, total: None
) -> Figures:
    """Count all parts, what each two have in common, and what is held out from each.

    Raises:
        QueryError: a part has fewer tasks than it wants.
        LimitReached: a limit ended a count.
    """
    count = _Counting(suite, limits, progress)
    sizes = {}
    for name, part in suite.parts.items():
        sizes[name] = count.by_length(name, part.where, part.lengths)
        there = sum(sizes[name].values())
        if there < part.tasks:
            told = f"{name} wants {plural(part.tasks, 'task')}, but there are {there}"
            raise QueryError(f"{suite.place('parts', name, 'tasks')}: {told}; ask for fewer, or give other conditions")
    shared = []
    for one, other in combinations(suite.parts.values(), 2):
        both = [length for length in one.lengths if length in other.lengths]
        tasks = count.by_length(f"{one.name} and {other.name}", (*one.where, *other.where), both)
        shared.append(Shared(one.name, other.name, sum(tasks.values()), one.declares(other)))
    unseen = []
    for held in suite.held:
        for part in suite.parts.values():
            if held.what not in part.unseen:
                tasks = count.by_length(f"{held.what} in {part.name}", (*part.where, held.having), part.lengths)
                unseen.append(Unseen(held.what, part.name, sum(tasks.values())))
    return Figures(sizes, tuple(shared), tuple(unseen))


class _Counting:
    """Counts tasks under conditions, each number once."""

    def __init__(self, suite: Suite, limits: Limits, progress: Counted) -> None:
        self._suite, self._limits, self._progress = suite, limits, progress
        self._known: dict[tuple[frozenset[str], int], int] = {}
        self._wanted: dict[frozenset[str], set[int]] = {}
        for part in suite.parts.values():
            self._wanted.setdefault(frozenset(part.where), set()).update(part.lengths)
        parts = len(suite.parts)
        self._done, self._total = 0, parts + parts * (parts - 1) // 2 + parts * len(suite.held)

    def by_length(self, what: str, clauses: Sequence[str], lengths: Sequence[int]) -> dict[int, int]:
        """Return the number of tasks of each length that satisfy all of some conditions."""
        self._progress(f"counting {what}", self._done, self._total)
        self._done += 1
        asked = frozenset(clauses)
        if any({held.having, held.without} <= asked for held in self._suite.held):
            return dict.fromkeys(lengths, 0)  # each is the negation of the other
        if any((asked, length) not in self._known for length in lengths):
            # What is explored for the longest holds for all, those of other parts under the same conditions among them.
            wanted = self._wanted.get(asked, set()).union(lengths)
            missing = sorted(length for length in wanted if (asked, length) not in self._known)
            space = _space(self._suite, tuple(dict.fromkeys(clauses)), missing, self._limits)
            for length in reversed(missing):
                self._known[asked, length] = space.at(length).count()
        return {length: self._known[asked, length] for length in lengths}


def _space(
    suite: Suite, clauses: Sequence[str], lengths: Sequence[int], limits: Limits, engine: str = "auto"
) -> TaskSpace:
    """Return the tasks of some lengths that satisfy all of some conditions."""
    return TaskSpace(suite.domain, lengths, engine=engine, limits=limits).where(*clauses)


def refuse_leaks(suite: Suite, figures: Figures) -> None:
    """Refuse parts that have tasks in common and do not say so.

    Raises:
        QueryError: there are some.
    """
    told = []
    for leak in figures.leaks:
        what = f"{leak.one} and {leak.other} have {plural(leak.tasks, 'task')} in common"
        mend = f'tell them apart by conditions, or add shares = "{leak.one}" to [parts.{leak.other}]'
        told.append(f"{suite.place('parts', leak.other)}: {what}; {mend}")
    if told:
        raise QueryError(*told)
