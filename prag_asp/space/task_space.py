"""The task space of a domain at one length: the one face that users see.

What only some questions need is imported where they are asked, so that a count starts at once.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, overload

from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.engines import Draw, Level
from prag_asp.space.engines.prefix import parse_plan
from prag_asp.space.plans.canonical_plan import canonical_names
from prag_asp.space.weights.weights import Number, Weights, parse_weights
from prag_asp.space.word_space import Prefix, WordSpace, checked_level
from prag_asp.task import Task

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from prag_asp.space.parts.ranked_tasks import RankedTasks
    from prag_asp.space.plans.readings import Readings
    from prag_asp.space.sampling.samplers import Drawer, Over
    from prag_asp.space.sampling.statistics import Statistics
    from prag_asp.space.weights.temperature import Temperature

LISTED, LONGEST_LISTED = 500, 30
"""Skeletons up to which parts of whole skeletons are made of single ones, and their length."""

WORD = re.compile(r"\w+")
"""A name that regular expressions can spell."""


class TaskSpace(WordSpace):
    """All tasks of a domain with a given number of actions: counted, enumerated, tested and drawn exactly.

    `engine` is ``automaton``, ``clingo``, ``sat``, ``sharp``, ``symbolic`` or ``auto``; `limits` say what each question
    may take.
    There is no ``len()``: counts outgrow it.

    Raises:
        QueryError: the length is no whole number or negative, or there is no such engine.
        EngineError: the engine asked for cannot express the domain; it is raised by the first question.
    """

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

    @overload
    def __getitem__(self, rank: int) -> Task: ...
    @overload
    def __getitem__(self, rank: slice) -> RankedTasks: ...
    def __getitem__(self, rank: int | slice) -> Task | RankedTasks:
        """Return the task of a rank, or a lazy range: actions in clingo's order of terms, tasks lexicographically.

        Raises:
            IndexError: the rank is not below the number of tasks; a negative one counts from the end.
        """
        return self._ranked()[rank]

    def _ranked(self) -> RankedTasks:
        from prag_asp.space.parts.ranked_tasks import Interval, RankedTasks

        return RankedTasks(Interval(range(self.count())), self)

    def split(self, shares: Mapping[str, Number | float], *, seed: int = 0) -> dict[str, RankedTasks]:
        """Return disjoint random parts that have these shares of the tasks, each rounded by less than one task.

        Raises:
            QueryError: the shares do not add up to 1.
        """
        from prag_asp.space.parts.ranked_tasks import Interval, RankedTasks, Shuffled
        from prag_asp.space.parts.shares import divided, parse_shares
        from prag_asp.space.parts.shuffle import Shuffle

        order = Shuffle(self.count(), seed)
        parts = divided(order.size, parse_shares(shares))
        return {name: RankedTasks(Shuffled(order, Interval(places)), self) for name, places in parts.items()}

    def split_skeletons(self, shares: Mapping[str, Number | float], *, seed: int = 0) -> dict[str, TaskSpace]:
        """Return disjoint random parts without a common skeleton, each a task space of this length.

        Their shares of the tasks are within two points of what is asked for, or, where whole skeletons allow no such
        choice, as near as one was found; a warning says so.

        Raises:
            QueryError: the shares do not add up to 1.
        """
        from prag_asp.space.conditions.whole_skeletons import divide_skeletons
        from prag_asp.space.parts.shares import parse_shares

        spaces: dict[Condition, TaskSpace] = {}

        def count(condition: Condition) -> int:
            if condition not in spaces:
                spaces[condition] = self._part(condition)
            return spaces[condition].count()

        parts = divide_skeletons(parse_shares(shares), seed, count, self._tasks_by_skeleton)
        return {name: spaces[condition] for name, condition in parts.items()}

    def _tasks_by_skeleton(self) -> dict[tuple[str, ...], int] | None:
        """Return the number of tasks of each skeleton, None where they are many or cannot be spelled."""
        if self.length > LONGEST_LISTED or self.count("skeleton") > LISTED:
            return None
        if not all(map(WORD.fullmatch, self.letters("skeleton"))):
            return None
        return {skeleton: self.count("task", skeleton) for skeleton in self.words("skeleton")}

    def hold_out(self, what: str) -> tuple[TaskSpace, TaskSpace]:
        """Return the tasks without and those with something: an entity, a class, an action's name or a pair of names.

        The first part is for training; the second has a composition that training never showed. Their tasks are those
        of this space, whatever is interchangeable in a part alone.

        Raises:
            QueryError: there is no such thing, or the entity is interchangeable with one that training shows.
        """
        from prag_asp.space.parts.shares import held_out

        without, having = held_out(what, self.domain.facts, self.symmetries.orbits)
        return self._part(without), self._part(having)

    def index(self, task: Task | Sequence[str | Atom]) -> int:
        """Return the rank of a task, or of its plan; interchangeable entities may have any of their names.

        Raises:
            QueryError: it is no task of this space, or has something that is no action.
        """
        plan = parse_plan(task.actions if isinstance(task, Task) else task, self.domain.facts)
        names = canonical_names(plan, self.symmetries)
        word = tuple(str(renamed(action, names)) for action in plan)
        rank = self._engine("task").rank(word) if len(word) == self.length else None
        if rank is None:
            told = f"no task of {self.title}: {' '.join(map(str, plan))}"
            raise QueryError(f"{told}; prag-asp explain says why it is no plan, where it is none")
        return rank

    def rank_of(self, word: tuple[str, ...]) -> int:
        """Return the rank of a task given as the texts of its actions, at once where it has its canonical names.

        Raises:
            QueryError: it is no task of this space.
        """
        rank = self._engine("task").rank(word)
        return self.index(word) if rank is None else rank

    def readings(self, task: Task) -> Readings:
        """Return the ways to read a task's plan as whole composites and free actions; its validity is not checked."""
        from prag_asp.space.plans.readings import Readings

        return Readings(task.actions, self._shared.hierarchy)

    def narrate(self, plans: Iterator[tuple[str, ...]]) -> Iterator[Task]:
        """Yield the task of each of some valid plans, given as texts of actions."""
        return self._shared.narrator.tasks((plan, None) for plan in plans)

    def narrate_draws(self, draws: Iterable[Draw]) -> Iterator[Task]:
        """Yield the task of each of some draws, with the logarithm of its probability."""
        from prag_asp.space.sampling.draws import log_probability

        return self._shared.narrator.tasks((draw.word, log_probability(draw.probability)) for draw in draws)

    def tasks_of(self, draws: Sequence[Draw]) -> list[Task]:
        """Return the tasks of some draws, which are told together: that is faster than one by one."""
        from prag_asp.space.sampling.draws import log_probability

        return self._shared.narrator.told([(draw.word, log_probability(draw.probability)) for draw in draws])

    def sample(
        self,
        count: int,
        *,
        seed: int,
        weights: Mapping[str, Number] | None = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
        distinct: bool = False,
    ) -> list[Task]:
        """Return tasks drawn independently, each with a probability proportional to its weight, exactly.

        `weights` maps action names, pairs (``grasp>move``), entities and classes to exact numbers; None takes those
        of the domain, and an empty mapping draws uniformly. At `temperature` T each weight w becomes about w^(1/T):
        ``"inf"`` makes all alike. With ``over="skeletons"`` (or ``"goals"``), a skeleton (or what is known of the last
        state) is drawn uniformly, and then a task that has it by weight. With ``by="plan"``, plans are drawn in place
        of tasks. With `distinct`, a uniformly random set of tasks is drawn, in random order, without replacement.

        Raises:
            QueryError: there is nothing to draw, or a weight fits nothing.
        """
        if distinct:
            if over or self._tempered(weights, temperature):
                raise QueryError("distinct tasks are drawn uniformly; give weights={}, and no over")
            return self._shared.draw_distinct(_drawn(by), self.length, _drawable(count), seed)
        drawn = self.draw(seed=seed, weights=weights, by=by, temperature=temperature, over=over)
        return list(islice(drawn, _drawable(count)))

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
        return self.narrate_draws(
            self.draw_words(seed=seed, weights=weights, by=_drawn(by), temperature=temperature, over=over)
        )

    def draw_words(
        self,
        *,
        seed: int,
        weights: Mapping[str, Number] | None = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
    ) -> Iterator[Draw]:
        """Yield words drawn as by `sample`, as texts with their exact probability, without end.

        Skeletons are drawn uniformly alone.
        """
        from prag_asp.random_bits import SeededBits
        from prag_asp.space.sampling.draws import drawn_words

        drawer = self.drawer(weights=weights, by=by, temperature=temperature, over=over)
        return drawn_words(drawer, self._engine(by), SeededBits(seed))

    def draw_array(
        self,
        count: int,
        *,
        seed: int,
        weights: Mapping[str, Number] | None = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
        first: int = 0,
    ) -> NDArray[np.int32]:
        """Return the words that `draw_words` yields from number `first` on, as an array of shape (count, length).

        It holds places in `letters`. Draws are independent of each other, so portions may be made apart.
        """
        from prag_asp.random_bits import SeededBits

        drawer = self.drawer(weights=weights, by=by, temperature=temperature, over=over)
        return drawer.draw(SeededBits(seed), first, _drawable(count), tell=False).letters

    def drawer(
        self,
        *,
        weights: Mapping[str, Number] | None = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
    ) -> Drawer:
        """Return the way in which `draw_words` and `draw_array` draw.

        Raises:
            QueryError: there is nothing to draw, or a weight fits nothing.
        """
        return self._shared.drawer_for(checked_level(by), self.length, self._tempered(weights, temperature), over)

    def total_weight(
        self, *, weights: Mapping[str, Number] | None = None, by: Level = "task", temperature: Temperature = 1
    ) -> Fraction:
        """Return the exact sum of the weights of all tasks or plans; with ``weights={}``, their number."""
        weighed = self._engine(by).weighed(self.length, self._tempered(weights, temperature))
        return weighed.total(self.length) * weighed.unit

    def weight_without(
        self, what: Collection[str], *, weights: Mapping[str, Number] | None = None, by: Level = "task"
    ) -> Fraction:
        """Return the exact sum of the weights of all tasks that have none of some names, nor pairs (``grasp>move``).

        Raises:
            QueryError: one of them is no action's name, nor a pair of such.
        """
        from prag_asp.space.sampling.statistics import weight_of_words_without

        facts = self.domain.facts
        return weight_of_words_without(self._engine(by), facts, by, self.length, self.weights(weights), what)

    def statistics(
        self, *, weights: Mapping[str, Number] | None = None, by: Level = "task", temperature: Temperature = 1
    ) -> Statistics:
        """Return what tasks are like on average, where they are drawn by weight: all exact, at any length.

        Raises:
            QueryError: there is nothing to draw, or a weight fits nothing.
        """
        from prag_asp.space.sampling.statistics import statistics_of

        return statistics_of(self._engine(by), self.domain.facts, by, self.length, self._tempered(weights, temperature))

    def _tempered(self, weights: Mapping[str, Number] | None, temperature: Temperature) -> Weights:
        from prag_asp.space.weights.temperature import tempered

        return tempered(self.weights(weights), temperature)

    def weights(self, weights: Mapping[str, Number] | None = None) -> Weights:
        """Return weights as the engines take them; None are those of the domain.

        Raises:
            QueryError: a weight fits nothing in the domain.
        """
        given = self.domain.settings.weights if weights is None else weights
        return parse_weights(given, self.domain.facts)


def _drawn(by: Level) -> Level:
    if by == "skeleton":
        raise QueryError("tasks and plans are drawn, skeletons are not; choose task or plan")
    return by


def _drawable(count: int) -> int:
    if count < 0:
        raise QueryError(f"cannot draw {count} tasks; give a number of at least 0")
    return count
