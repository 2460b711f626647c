"""The task space of a domain at one length: the one face that users see.

What only some questions need is imported where they are asked, so that a count starts at once.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from copy import copy
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, Any, overload

from prag_asp.atom import Atom
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.logic.ground.program import action_name
from prag_asp.logic.model import Model
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.engines import LEVELS, Draw, Engine, Level
from prag_asp.space.engines.prefix import parse_plan, parse_prefix
from prag_asp.space.engines.protocol import Progress
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.plans.canonical import canonical_names, canonical_prefix
from prag_asp.space.shared import Shared
from prag_asp.space.weighing.weights import Number, Weights, parse_weights
from prag_asp.task import Task

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from prag_asp.logic.formula.approximate import Estimate
    from prag_asp.space.drawing.drawers import Drawer, Over
    from prag_asp.space.drawing.statistics import Statistics
    from prag_asp.space.parts.ranked import RankedTasks
    from prag_asp.space.plans.readings import Readings
    from prag_asp.space.weighing.temperature import Temperature

LISTED, LONGEST_LISTED = 500, 30
"""Skeletons up to which parts of whole skeletons are made of single ones, and their length."""

WORD = re.compile(r"\w+")
"""A name that regular expressions can spell."""

Prefix = Sequence[str | Atom]
"""What a word begins with: for each of the first steps an action or the name of one."""


class TaskSpace:
    """All tasks of a domain with a given number of actions: counted, enumerated, tested and drawn exactly.

    `engine` is ``automaton``, ``clingo``, ``sat``, ``sharp``, ``symbolic`` or ``auto``; `limits` say what each question
    may take.
    There is no ``len()``: counts outgrow it.

    Raises:
        QueryError: the length is no whole number or negative, or there is no such engine.
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
        if not isinstance(domain, Domain):
            raise QueryError(f"{domain!r} is no domain; give load_domain({domain!r})")
        self._shared = Shared(Model(domain), engine, progress, limits)
        self.domain = domain
        self.length = _checked(length)
        self.condition = Condition()
        self._part_of: TaskSpace | None = None

    def __copy__(self) -> TaskSpace:
        space = object.__new__(type(self))
        space.__dict__.update(self.__dict__)
        return space

    def __reduce__(self) -> tuple[Any, ...]:
        """Let it be sent to other processes, where it computes anew; nobody is told of progress there."""
        shared = self._shared
        return _sent, (self.domain, self.length, shared.engine, shared.limits, self.condition, self._part_of)

    def same_tasks(self, other: object) -> bool:
        """Tell whether another space is of the same domain, length and conditions: its ranks mean the same tasks."""
        if not isinstance(other, TaskSpace):
            return False
        asked = self.domain, self.length, self.condition
        if self is other or asked != (other.domain, other.length, other.condition):
            return self is other
        return self._part_of is other._part_of or self.symmetries == other.symmetries

    def at(self, length: int) -> TaskSpace:
        """Return the space of another length, which shares all that was computed."""
        space = copy(self)
        space.length = _checked(length)
        return space

    def where(self, *conditions: str | Condition) -> TaskSpace:
        """Return the space of those tasks that satisfy all of some conditions, each a value or its words.

        Entities that a condition tells apart are not interchangeable in that space; none become so by it.

        Raises:
            QueryError: a condition is none, or speaks of something that the domain does not have.
        """
        return self._asked(conditions, None)

    def _asked(self, conditions: Iterable[str | Condition], part_of: TaskSpace | None) -> TaskSpace:
        """Return the space under further conditions, as a part of another one where that is given."""
        space = copy(self)
        for condition in conditions:
            space.condition &= condition if isinstance(condition, Condition) else Condition.parse(condition)
        if space.condition != self.condition:
            from prag_asp.space.conditions.conditioned import conditioned

            shared = self._shared
            whole = part_of._shared.model if part_of else None
            model = Model(conditioned(self.domain, space.condition), shared.model.bare or shared.model, whole)
            fewest = space.condition.fewest_actions
            space._shared = Shared(model, shared.engine, shared.progress, shared.limits, fewest)
            space._part_of = part_of
        return space

    def _part(self, condition: str | Condition) -> TaskSpace:
        """Return the tasks that satisfy a condition which all renamings of tasks keep, up to the same renamings.

        Under both conditions, other entities may be interchangeable: where one is on b and one on a, these are.
        """
        return self._asked([condition], self)

    @property
    def title(self) -> str:
        """The domain, the length and the conditions in words."""
        where = "".join(f", where {clause}" for clause in self.condition.clauses)
        return f"{self.domain.label} of length {self.length}{where}"

    @property
    def symmetries(self) -> Symmetries:
        """The interchangeable entities, alone and in units: tasks are plans up to the renamings that they generate."""
        return self._shared.model.symmetries(self.length)

    def __repr__(self) -> str:
        where = "".join(f".where({str(clause)!r})" for clause in self.condition.clauses)
        return f"TaskSpace({self.domain.label!r}, length={self.length}){where}"

    def count(self, by: Level = "task", prefix: Prefix = ()) -> int:
        """Return the exact number of plans, tasks or skeletons that begin with `prefix`.

        Raises:
            QueryError: no such level, or the prefix names no action of the domain.
            LimitReached: a limit ended the count; the error has the number that was found until then.
        """
        return self._shared.count(_level(by), self.length, self._prefix(by, prefix))

    def estimate(
        self, by: Level = "task", prefix: Prefix = (), *, epsilon: float = 0.8, delta: float = 0.2, seed: int = 0
    ) -> Estimate:
        """Return about how many plans, tasks or skeletons begin with `prefix`, whatever the engine: no exact number.

        With a probability of at least 1 - `delta`, it is off by no more than a factor of 1 + `epsilon`.

        Raises:
            QueryError: no such level, the prefix names no action of the domain, or a number is out of range.
            EngineError: ApproxMC is not installed or fails, or the program has no counterpart in clauses.
            LimitReached: it takes too long.
        """
        from prag_asp.logic.formula.approximate import Estimate, Tolerance
        from prag_asp.space.engines.sharp import estimate_words

        tolerance = Tolerance(epsilon, delta)
        level, first = _level(by), self._prefix(by, prefix)
        if self.length < self._shared.fewest_actions:
            return Estimate(0, tolerance)
        shared = self._shared
        return estimate_words(shared.model, level, self.length, first, tolerance, seed, shared.limits)

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
        from prag_asp.space.parts.ranked import Interval, RankedTasks

        return RankedTasks(Interval(range(self.count())), self)

    def split(self, shares: Mapping[str, Number | float], *, seed: int = 0) -> dict[str, RankedTasks]:
        """Return disjoint random parts that have these shares of the tasks, each rounded by less than one task.

        Raises:
            QueryError: the shares do not add up to 1.
        """
        from prag_asp.space.parts.ranked import Interval, RankedTasks, Shuffled
        from prag_asp.space.parts.shuffle import Shuffle
        from prag_asp.space.parts.split import divided, parse_shares

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
        from prag_asp.space.parts.split import parse_shares

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
        from prag_asp.space.parts.split import held_out

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

    def word(self, rank: int) -> tuple[str, ...]:
        """Return the task of a rank from 0 to ``count() - 1`` as the texts of its actions."""
        return self._engine("task").unrank(self.length, rank)

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
        from prag_asp.space.drawing.draws import log_probability

        return self._shared.narrator.tasks((draw.word, log_probability(draw.probability)) for draw in draws)

    def tasks_of(self, draws: Sequence[Draw]) -> list[Task]:
        """Return the tasks of some draws, which are told together: that is faster than one by one."""
        from prag_asp.space.drawing.draws import log_probability

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
        from prag_asp.bits import SeededBits
        from prag_asp.space.drawing.draws import drawn_words

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
        from prag_asp.bits import SeededBits

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
        return self._shared.drawer_for(_level(by), self.length, self._tempered(weights, temperature), over)

    def letters(self, by: Level = "task") -> tuple[str, ...]:
        """Return what the numbers of `draw_array` stand for: the texts of actions, or names."""
        return self._engine(by).letters

    def dimacs(self, by: Level = "task") -> Iterator[str]:
        """Yield the lines of a formula with one model for each word, projected on what it shows, for model counters.

        Raises:
            QueryError: no such level.
            EngineError: the domain has no counterpart in clauses.
        """
        from prag_asp.logic.formula.cnf import dimacs
        from prag_asp.space.engines.formula import word_formula

        formula = word_formula(self._shared.model, _level(by), self.length)
        return dimacs(formula.cnf, [f"the {by}s of {self.title}, by prag_asp"])

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
        from prag_asp.space.drawing.statistics import weight_of_words_without

        facts = self.domain.facts
        return weight_of_words_without(self._engine(by), facts, by, self.length, self.weights(weights), what)

    def statistics(
        self, *, weights: Mapping[str, Number] | None = None, by: Level = "task", temperature: Temperature = 1
    ) -> Statistics:
        """Return what tasks are like on average, where they are drawn by weight: all exact, at any length.

        Raises:
            QueryError: there is nothing to draw, or a weight fits nothing.
        """
        from prag_asp.space.drawing.statistics import statistics_of

        return statistics_of(self._engine(by), self.domain.facts, by, self.length, self._tempered(weights, temperature))

    def _tempered(self, weights: Mapping[str, Number] | None, temperature: Temperature) -> Weights:
        from prag_asp.space.weighing.temperature import tempered

        return tempered(self.weights(weights), temperature)

    def weights(self, weights: Mapping[str, Number] | None = None) -> Weights:
        """Return weights as the engines take them; None are those of the domain.

        Raises:
            QueryError: a weight fits nothing in the domain.
        """
        given = self.domain.settings.weights if weights is None else weights
        return parse_weights(given, self.domain.facts)

    def _engine(self, by: Level) -> Engine:
        return self._shared.engine_for(_level(by), self.length)

    def _prefix(self, by: Level, prefix: Prefix) -> tuple[str, ...]:
        if isinstance(prefix, str):
            raise QueryError(f"prefix {prefix!r}: give a list, such as [{prefix!r}]")
        if not prefix:
            return ()
        items = [str(item) for item in prefix]
        if self.domain.fewer and {*items} <= {action_name(action) for action in self.domain.fewer.facts.actions}:
            return parse_prefix(items, by, self.domain.fewer.facts)
        facts = self.domain.facts
        found = parse_prefix(items, by, facts)
        if by != "task" or not found:
            return found
        return canonical_prefix(found, {str(action): action for action in facts.actions}, self.symmetries)


def _sent(
    domain: Domain, length: int, engine: str, limits: Limits, condition: Condition, part_of: TaskSpace | None
) -> TaskSpace:
    """Return the space that another process has sent."""
    return TaskSpace(domain, length, engine=engine, limits=limits)._asked([condition], part_of)


def _checked(length: int) -> int:
    if not isinstance(length, int) or isinstance(length, bool):
        raise QueryError(f"length {length!r}: give a whole number, such as 4")
    if length < 0:
        raise QueryError(f"length {length}: a plan has at least 0 actions")
    return length


def _level(by: Level) -> Level:
    if by not in LEVELS:
        raise QueryError(f"no level {by!r}; there are {', '.join(LEVELS)}")
    return by


def _drawn(by: Level) -> Level:
    if by == "skeleton":
        raise QueryError("tasks and plans are drawn, skeletons are not; choose task or plan")
    return by


def _drawable(count: int) -> int:
    if count < 0:
        raise QueryError(f"cannot draw {count} tasks; give a number of at least 0")
    return count
