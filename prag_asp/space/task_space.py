"""The task space of a domain at one length: the one face that users see."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import log

from prag_asp.domain.atom import Atom
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.logic.model import Model
from prag_asp.logic.program import action_name
from prag_asp.space.canonical import canonical_names, canonical_prefix, renamed
from prag_asp.space.engines import LEVELS, Draw, Engine, Level, select
from prag_asp.space.engines.protocol import Progress
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.narrate import Narrator
from prag_asp.space.prefix import parse_prefix
from prag_asp.space.ranks import distinct_ranks
from prag_asp.space.task import Task
from prag_asp.space.weights import Number, Weights, parse_weights

Prefix = Sequence[str | Atom]
"""What a word begins with: for each of the first steps an action or the name of one."""


class TaskSpace:
    """All tasks of a domain with a given number of actions: counted, enumerated, tested and drawn exactly.

    `engine` is ``automaton``, ``clingo`` or ``auto``; `limits` say what each question may take. There is no
    ``len()``: counts outgrow it.

    Raises:
        QueryError: the length is negative, or there is no such engine.
        EngineError: the engine asked for cannot express the domain; it is raised by the first question.
    """

    def __init__(
        self,
        domain: Domain,
        length: int,
        *,
        engine: str = "auto",
        progress: Progress | None = None,
        limits: Limits = UNLIMITED,
    ) -> None:
        self._shared = _Shared(Model(domain), engine, progress, limits)
        self.domain = domain
        self.length = _checked(length)

    def at(self, length: int) -> TaskSpace:
        """Return the space of another length, which shares all that was computed."""
        space = object.__new__(TaskSpace)
        space._shared, space.domain, space.length = self._shared, self.domain, _checked(length)
        return space

    def __repr__(self) -> str:
        return f"TaskSpace({self.domain.name!r}, length={self.length})"

    def count(self, by: Level = "task", prefix: Prefix = ()) -> int:
        """Return the exact number of plans, tasks or skeletons that begin with `prefix`.

        Raises:
            QueryError: no such level, or the prefix names no action of the domain.
            LimitReached: a limit ended the count; the error has the number that was found until then.
        """
        return self._engine(by).count(self.length, self._prefix(by, prefix))

    def words(self, by: Level = "task", prefix: Prefix = ()) -> Iterator[tuple[str, ...]]:
        """Yield plans, tasks or skeletons as texts of actions or as names, in rank order, lazily, each once.

        Raises:
            QueryError: no such level, or the prefix names no action of the domain.
        """
        return self._engine(by).words(self.length, self._prefix(by, prefix))

    def tasks(self, prefix: Prefix = ()) -> Iterator[Task]:
        """Yield the tasks that begin with `prefix`, in rank order, lazily, each once."""
        return self.narrate(self.words("task", prefix))

    def __iter__(self) -> Iterator[Task]:
        return self.tasks()

    def __contains__(self, task: object) -> bool:
        if isinstance(task, Task):
            task = task.actions
        if not isinstance(task, Sequence) or len(task) != self.length:
            return False
        return self._engine("plan").contains(tuple(map(str, task)))

    def __getitem__(self, rank: int) -> Task:
        """Return the task of a rank: actions in clingo's order of terms, tasks in lexicographic order.

        Raises:
            IndexError: the rank is not below the number of tasks; a negative one counts from the end.
        """
        total = self.count()
        if not -total <= rank < total:
            raise IndexError(f"rank {rank} of {total} tasks")
        word = self._engine("task").unrank(self.length, rank % total)
        return next(self.narrate(iter([word])))

    def index(self, task: Task) -> int:
        """Return the rank of a task; interchangeable entities may have any of their names.

        Raises:
            QueryError: it is no task of this space.
        """
        names = canonical_names(task.actions, self._shared.model.groups(self.length))
        word = tuple(str(action) for action in renamed(task.actions, names))
        rank = self._engine("task").rank(word) if len(word) == self.length else None
        if rank is None:
            raise QueryError(f"no task of {self!r}: {task}")
        return rank

    def narrate(self, plans: Iterator[tuple[str, ...]]) -> Iterator[Task]:
        """Yield the task of each of some valid plans, given as texts of actions."""
        return self._shared.narrator.tasks((plan, None) for plan in plans)

    def sample(
        self,
        count: int,
        *,
        seed: int,
        weights: Mapping[str, Number] | None = None,
        by: Level = "task",
        distinct: bool = False,
    ) -> list[Task]:
        """Return tasks drawn independently, each with a probability proportional to its weight, exactly.

        `weights` maps action names, pairs (``grasp>move``), entities and classes to exact numbers; None takes those
        of the domain, and an empty mapping draws uniformly. With ``by="plan"``, plans are drawn in place of tasks. With
        `distinct`, a uniformly random set of tasks is drawn, in random order, without replacement.

        Raises:
            QueryError: there is nothing to draw, or a weight fits nothing.
        """
        if count < 0:
            raise QueryError(f"cannot draw {count} tasks; give a number of at least 0")
        if distinct:
            return self._draw_distinct(count, seed, self.weights(weights), by)
        drawn = self.draw(seed=seed, weights=weights, by=by)
        return [next(drawn) for _ in range(count)]

    def draw(self, *, seed: int, weights: Mapping[str, Number] | None = None, by: Level = "task") -> Iterator[Task]:
        """Yield tasks drawn as by `sample`, without end."""
        draws = self.draw_words(seed=seed, weights=weights, by=by)
        return self._shared.narrator.tasks((draw.word, _log(draw.probability)) for draw in draws)

    def _draw_distinct(self, count: int, seed: int, weights: Weights, by: Level) -> list[Task]:
        if weights:
            raise QueryError("distinct tasks are drawn uniformly; give weights={}")
        if by == "skeleton":
            raise QueryError("tasks and plans are drawn, skeletons are not; choose task or plan")
        engine = self._engine(by)
        total = engine.count(self.length)
        if count > total:
            raise QueryError(f"cannot draw {count} distinct {by}s: there are {total}")
        ranks = distinct_ranks(random.Random(seed), total, count)
        log_probability = -log(total) if total else None
        words = ((engine.unrank(self.length, rank), log_probability) for rank in ranks)
        return list(self._shared.narrator.tasks(words))

    def draw_words(
        self, *, seed: int, weights: Mapping[str, Number] | None = None, by: Level = "task"
    ) -> Iterator[Draw]:
        """Yield plans drawn as by `sample`, as texts of actions with their exact probability, without end."""
        if by == "skeleton":
            raise QueryError("tasks and plans are drawn, skeletons are not; choose task or plan")
        return self._engine(by).draws(self.length, random.Random(seed), self.weights(weights))

    def weights(self, weights: Mapping[str, Number] | None = None) -> Weights:
        """Return weights as the engines take them; None are those of the domain.

        Raises:
            QueryError: a weight fits nothing in the domain.
        """
        given = self.domain.settings.weights if weights is None else weights
        return parse_weights(given, self.domain.facts)

    def _engine(self, by: Level) -> Engine:
        if by not in LEVELS:
            raise QueryError(f"no level {by!r}; there are {', '.join(LEVELS)}")
        return self._shared.engine_for(by)

    def _prefix(self, by: Level, prefix: Prefix) -> tuple[str, ...]:
        facts = self.domain.facts
        found = parse_prefix([str(item) for item in prefix], by, facts)
        if by != "task" or not found:
            return found
        groups = self._shared.model.groups(self.length)
        return canonical_prefix(found, map(action_name, facts.actions), groups)


@dataclass
class _Shared:
    """What the spaces of one domain share: its logic and its engines, made when first asked for."""

    model: Model
    engine: str
    progress: Progress | None
    limits: Limits
    engines: dict[Level, Engine] = field(default_factory=dict)

    def engine_for(self, by: Level) -> Engine:
        if by not in self.engines:
            self.engines[by] = select(self.engine, self.model, by, self.progress, self.limits)
        return self.engines[by]

    @cached_property
    def narrator(self) -> Narrator:
        return Narrator(self.model)


def _checked(length: int) -> int:
    if length < 0:
        raise QueryError(f"length {length}: a plan has at least 0 actions")
    return length


def _log(probability: Fraction) -> float:
    return log(probability.numerator) - log(probability.denominator)
