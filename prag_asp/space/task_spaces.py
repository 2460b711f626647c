"""The task spaces of a domain at several lengths, as one: counted, enumerated, tested and drawn exactly."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from fractions import Fraction
from itertools import chain, groupby, islice
from typing import TYPE_CHECKING, Any

from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.engines import Draw, Level
from prag_asp.space.engines.engine import Progress
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.weights.weights import Number
from prag_asp.space.word_space import Prefix
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.space.sampling.lengths import Portion
    from prag_asp.space.sampling.samplers import Over
    from prag_asp.space.weights.temperature import Temperature


class TaskSpaces:
    """All tasks of a domain whose number of actions is one of `lengths`, such as ``range(3, 7)``.

    The other arguments are those of a task space. What is computed for one length is used for the others.

    Raises:
        QueryError: there is no length, one is negative or given twice, or there is no such engine.
    """

    def __init__(
        self,
        domain: Domain,
        lengths: Sequence[int],
        *,
        engine: str = "auto",
        progress: Progress | None = None,
        limits: Limits = UNLIMITED,
    ) -> None:
        if not lengths or len(set(lengths)) < len(lengths):
            raise QueryError(f"lengths {lengths}: give at least one, and each once")
        self._space = TaskSpace(domain, min(lengths), engine=engine, progress=progress, limits=limits)
        self.lengths = lengths
        self._portioned: tuple[tuple[str | None, ...], list[Portion]] | None = None

    def __copy__(self) -> TaskSpaces:
        spaces = object.__new__(type(self))
        spaces.__dict__.update(self.__dict__)
        return spaces

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_portioned": None}

    @property
    def domain(self) -> Domain:
        """The domain."""
        return self._space.domain

    @property
    def condition(self) -> Condition:
        """What all tasks satisfy."""
        return self._space.condition

    def at(self, length: int) -> TaskSpace:
        """Return the space of one length, which shares all that was computed."""
        return self._space.at(length)

    def where(self, *conditions: str | Condition) -> TaskSpaces:
        """Return the spaces of those tasks that satisfy all of some conditions, each a value or its words.

        Raises:
            QueryError: a condition is none, or speaks of something that the domain does not have.
        """
        spaces = copy(self)
        spaces._portioned = None
        spaces._space = self._space.where(*conditions)
        return spaces

    def __repr__(self) -> str:
        return f"TaskSpaces({self.domain.label!r}, lengths={self.lengths})"

    def __iter__(self) -> Iterator[Task]:
        return self.narrate(self.words())

    def __contains__(self, task: object) -> bool:
        return isinstance(task, (Task, Sequence)) and len(task) in self.lengths and task in self.at(len(task))

    def count(self, by: Level = "task", prefix: Prefix = ()) -> int:
        """Return the exact number of plans, tasks or skeletons of all lengths together that begin with `prefix`.

        Raises:
            QueryError: no such level, or the prefix names no action of the domain.
            LimitReached: a limit ended the count of a length; the error has the number that was found of that one.
        """
        return sum(self.at(length).count(by, prefix) for length in self.lengths)

    def words(self, by: Level = "task", prefix: Prefix = ()) -> Iterator[tuple[str, ...]]:
        """Yield plans, tasks or skeletons length by length, each in rank order, lazily.

        Raises:
            QueryError: no such level, or the prefix names no action of the domain.
        """
        first = self.at(self.lengths[0]).words(by, prefix)
        return chain(first, *(self.at(length).words(by, prefix) for length in self.lengths[1:]))

    def narrate(self, plans: Iterator[tuple[str, ...]]) -> Iterator[Task]:
        """Yield the task of each of some valid plans, given as texts of actions."""
        for _, several in groupby(plans, key=len):
            yield from self._space.narrate(several)

    def sample(
        self,
        count: int,
        *,
        seed: int,
        weights: Mapping[str, Number] | None = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
    ) -> list[Task]:
        """Return tasks drawn independently, each with its share of the weight of all tasks of all lengths, exactly.

        The arguments are those of `TaskSpace.sample`. A task's weight is a product over its actions, so among tasks of
        several lengths weights above 1 favour long ones. With ``over="skeletons"``, a skeleton of any length is drawn
        uniformly first; goals are not, for one may end tasks of two lengths.

        Raises:
            QueryError: there is nothing to draw, or a weight fits nothing.
        """
        if count < 0:
            raise QueryError(f"cannot draw {count} tasks; give a number of at least 0")
        return list(islice(self.draw(seed=seed, weights=weights, by=by, temperature=temperature, over=over), count))

    def draw(
        self,
        *,
        seed: int,
        weights: Mapping[str, Number] | None = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
    ) -> Iterator[Task]:
        """Yield tasks drawn as by `sample`, without end."""
        if len(self.lengths) == 1:
            only = self.at(self.lengths[0])
            return only.draw(seed=seed, weights=weights, by=by, temperature=temperature, over=over)
        if by == "skeleton":
            raise QueryError("tasks and plans are drawn, skeletons are not; choose task or plan")
        return self._told(self._batches(seed, weights, by, temperature, over))

    def draw_words(
        self,
        *,
        seed: int,
        weights: Mapping[str, Number] | None = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
    ) -> Iterator[Draw]:
        """Yield words drawn as by `sample`, as texts with their exact probability among all lengths, without end."""
        if len(self.lengths) == 1:
            only = self.at(self.lengths[0])
            return only.draw_words(seed=seed, weights=weights, by=by, temperature=temperature, over=over)
        batches = self._batches(seed, weights, by, temperature, over)
        return (draw for batch in batches for draw in batch)

    def _batches(
        self,
        seed: int,
        weights: Mapping[str, Number] | None,
        by: Level,
        temperature: Temperature,
        over: Over | None,
    ) -> Iterator[list[Draw]]:
        """Return the draws in batches that grow; what cannot be drawn is told at once.

        Raises:
            QueryError: there is nothing to draw, or it cannot be drawn so.
        """
        from prag_asp.space.sampling.lengths import drawn_batches

        if over == "goals":
            raise QueryError("over goals, tasks of one length are drawn; give one, or draw over skeletons")
        key = (repr(weights), by, str(temperature), over)
        if self._portioned is None or self._portioned[0] != key:
            self._portioned = (key, self._portions(weights, by, temperature, over))
        portions = self._portioned[1]
        if not portions:
            raise QueryError(f"there is no {by} of the lengths {', '.join(map(str, self.lengths))} to draw")
        return drawn_batches(portions, self._space.letters(by), seed)

    def _portions(
        self, weights: Mapping[str, Number] | None, by: Level, temperature: Temperature, over: Over | None
    ) -> list[Portion]:
        """Return what is drawn of each length, without those that weigh nothing."""
        from prag_asp.space.sampling.lengths import Portion
        from prag_asp.space.sampling.samplers import OverSkeletons

        portions = []
        for length in sorted(self.lengths, reverse=True):  # what is explored for the longest holds for all
            space = self.at(length)
            weight = space.total_weight(weights=weights, by=by, temperature=temperature)
            if weight:
                drawer = space.drawer(weights=weights, by=by, temperature=temperature, over=over)
                share = Fraction(drawer.count) if isinstance(drawer, OverSkeletons) else weight
                portions.append(Portion(length, share, drawer))
        return portions[::-1]

    def _told(self, batches: Iterable[Sequence[Draw]]) -> Iterator[Task]:
        """Yield the task of each draw; those of one length are told together."""
        for batch in batches:
            alike: dict[int, list[Draw]] = {}
            for draw in batch:
                alike.setdefault(len(draw.word), []).append(draw)
            tasks = {length: iter(self._space.tasks_of(draws)) for length, draws in alike.items()}
            for draw in batch:
                yield next(tasks[len(draw.word)])
