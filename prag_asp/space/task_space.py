"""The task space of a domain at one or several lengths: the one face that users see.

Modules that only some questions need are imported by their methods, so that a count starts at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from fractions import Fraction
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, Protocol, overload

from prag_asp.atom import Atom
from prag_asp.batches import growing_batches
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.program.entity_names import action_name
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.domain_engines import DomainEngines
from prag_asp.space.engines import LEVELS, Level
from prag_asp.space.engines.engine import Progress
from prag_asp.space.engines.prefix import parse_plan, parse_prefix
from prag_asp.space.lengths import checked_length, parse_lengths, spelled_lengths
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.plans.canonical_plan import canonical_prefix
from prag_asp.space.weights.weights import Number, Weights, parse_weights
from prag_asp.space.word_set import WordSet
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.logic.formula.approximate import Estimate
    from prag_asp.space.parts.ranked_tasks import RankedTasks
    from prag_asp.space.plans.readings import Readings
    from prag_asp.space.sampling.samplers import Over
    from prag_asp.space.sampling.statistics import Statistics
    from prag_asp.space.task_sampling import TaskSampling
    from prag_asp.space.weights.temperature import Temperature

Prefix = Sequence[str | Atom]
"""What a plan begins with: for each of the first steps an action or the name of one."""

GivenWeights = Mapping[str, Number] | Weights | None
"""Weights by action names, pairs (``grasp>move``), entities and classes; None are those of the domain."""


class ProbablePlan(Protocol):
    """A plan that was sampled, as the texts of its actions, with its probability."""

    @property
    def word(self) -> tuple[str, ...]:
        """The texts of its actions."""
        ...

    @property
    def probability(self) -> Fraction:
        """The probability of the draw."""
        ...


class TaskSpace:
    """All tasks of a domain with a given number of actions: counted, enumerated, tested and sampled exactly.

    `length` is that number, several (``range(3, 7)``), or a text (``"3..6"``). `engine` is ``automaton``, ``clingo``,
    ``sat``, ``sharp``, ``symbolic`` or ``auto``; `limits` say what each question may take. Ranks, statistics, splits
    and estimates are those of one length. There is no ``len()``: counts outgrow it.

    Raises:
        QueryError: a length is no whole number or negative, there is none, or there is no such engine.
        EngineError: the engine cannot express the domain; it is raised by the first question.
    """

    def __init__(
        self,
        domain: Domain,
        length: int | str | Iterable[int],
        *,
        engine: str = "auto",
        progress: Progress | None = None,
        limits: Limits = UNLIMITED,
    ) -> None:
        if not isinstance(domain, Domain):
            raise QueryError(f"{domain!r} is no domain; give load_domain({domain!r})")
        self.engines = DomainEngines(DomainLogic(domain), engine, progress, limits)
        self.domain = domain
        self.lengths = parse_lengths(length)
        self.condition = Condition()
        self._part_of: TaskSpace | None = None

    def __copy__(self) -> TaskSpace:
        space = object.__new__(type(self))
        space.__dict__.update(self.__dict__)
        return space

    def __reduce__(self) -> tuple[Any, ...]:
        """Allow pickling; the copy computes anew and reports no progress."""
        engines = self.engines
        return _unpickled, (self.domain, self.lengths, engines.name, engines.limits, self.condition, self._part_of)

    @property
    def length(self) -> int:
        """The number of actions of all tasks.

        Raises:
            QueryError: the space has several lengths.
        """
        if len(self.lengths) > 1:
            raise QueryError(f"a space of the lengths {spelled_lengths(self.lengths)}: choose one, such as "
                             f"space.at({self.lengths[0]})")  # fmt: skip
        return self.lengths[0]

    @property
    def title(self) -> str:
        """The domain, the lengths and the conditions in words."""
        where = "".join(f", where {clause}" for clause in self.condition.clauses)
        return f"{self.domain.label} of length {spelled_lengths(self.lengths)}{where}"

    @property
    def symmetries(self) -> Symmetries:
        """The interchangeable entities, alone and in units: tasks are plans up to the renamings that they generate."""
        return self.engines.model.symmetries(self.length)

    def __repr__(self) -> str:
        length = self.lengths[0] if len(self.lengths) == 1 else spelled_lengths(self.lengths)
        where = "".join(f".where({str(clause)!r})" for clause in self.condition.clauses)
        return f"TaskSpace({self.domain.label!r}, length={length!r}){where}"

    def at(self, length: int) -> TaskSpace:
        """Return the space of one length, which may be another one, with the same conditions and engines."""
        space = copy(self)
        space.lengths = (checked_length(length),)
        return space

    def where(self, *conditions: str | Condition) -> TaskSpace:
        """Return the space of the tasks that satisfy all of some conditions, each a value or its text.

        Entities that a condition distinguishes are not interchangeable in that space; none become so by it.

        Raises:
            QueryError: a condition cannot be read, or names something that the domain does not have.
        """
        return self._restricted(conditions, None)

    def _restricted(self, conditions: Iterable[str | Condition], part_of: TaskSpace | None) -> TaskSpace:
        """Return the space under further conditions; with `part_of`, up to the renamings of that space."""
        space = copy(self)
        for condition in conditions:
            space.condition &= condition if isinstance(condition, Condition) else Condition.parse(condition)
        if space.condition != self.condition:
            from prag_asp.space.conditions.conditioned_domain import conditioned

            engines = self.engines
            whole = part_of.engines.model if part_of else None
            model = DomainLogic(conditioned(self.domain, space.condition), engines.model.bare or engines.model, whole)
            fewest = space.condition.fewest_actions
            space.engines = DomainEngines(model, engines.name, engines.progress, engines.limits, fewest)
            space._part_of = part_of
        return space

    def part(self, condition: str | Condition) -> TaskSpace:
        """Return the tasks that satisfy a condition which all renamings of tasks keep, up to the same renamings.

        `where` would find more entities interchangeable: where one is on b and one on a, these are.
        """
        return self._restricted([condition], self)

    def same_tasks(self, other: object) -> bool:
        """Return whether another space has the same domain, lengths and conditions, so that its ranks are the same."""
        if not isinstance(other, TaskSpace):
            return False
        request = self.domain, self.lengths, self.condition
        if self is other or request != (other.domain, other.lengths, other.condition):
            return self is other
        return self._part_of is other._part_of or all(
            self.at(length).symmetries == other.at(length).symmetries for length in self.lengths
        )

    def count(self, by: Level = "task", prefix: Prefix = ()) -> int:
        """Return the exact number of plans, tasks or skeletons that begin with `prefix`, of all lengths together.

        Raises:
            QueryError: no such level, or the prefix names no action of the domain.
            LimitReached: a limit ended the count of a length; the error has the number that was found of that one.
        """
        checked_level(by)
        return sum(self.engines.count(by, length, self._prefix(by, prefix, length)) for length in self.lengths)

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
        from prag_asp.space.engines.sharp_engine import estimate_words

        tolerance, engines = Tolerance(epsilon, delta), self.engines
        level, length = checked_level(by), self.length
        first = self._prefix(by, prefix, length)
        if length < engines.fewest_actions:
            return Estimate(0, tolerance)
        return estimate_words(engines.model, level, length, first, tolerance, seed, engines.limits)

    def enumerate(self, by: Level = "task", prefix: Prefix = ()) -> Iterator[tuple[str, ...]]:
        """Yield plans, tasks or skeletons as texts of actions or as names, length by length in rank order, lazily.

        Raises:
            QueryError: no such level, or the prefix names no action of the domain.
        """
        checked_level(by)
        prefixes = {length: self._prefix(by, prefix, length) for length in self.lengths}
        each = (self.engines.engine(by, length).words(length, first) for length, first in prefixes.items())
        return chain(next(each), chain.from_iterable(each))

    def tasks(self, prefix: Prefix = ()) -> Iterator[Task]:
        """Yield the tasks that begin with `prefix`, length by length in rank order, lazily, each once."""
        return self.tasks_of_plans(self.enumerate("task", prefix))

    def __iter__(self) -> Iterator[Task]:
        return self.tasks()

    def __contains__(self, task: object) -> bool:
        actions = task.actions if isinstance(task, Task) else task
        if not isinstance(actions, Sequence) or len(actions) not in self.lengths:
            return False
        return self.engines.engine("plan", len(actions)).contains(tuple(map(str, actions)))

    @overload
    def __getitem__(self, rank: int) -> Task: ...
    @overload
    def __getitem__(self, rank: slice) -> RankedTasks: ...
    def __getitem__(self, rank: int | slice) -> Task | RankedTasks:
        """Return the task of a rank, or a lazy range: actions in clingo's order of terms, tasks lexicographically.

        Raises:
            IndexError: the rank is not below the number of tasks; a negative one counts from the end.
        """
        from prag_asp.space.parts.ranked_tasks import RankedTasks, RankRange

        self.length  # noqa: B018  ranks are those of one length
        return RankedTasks(RankRange(range(self.count())), self)[rank]

    def plan_at(self, rank: int) -> tuple[str, ...]:
        """Return the plan of the task of a rank from 0 to ``count() - 1`` as the texts of its actions."""
        return self._tasks.word(rank)

    def index(self, task: Task | Sequence[str | Atom]) -> int:
        """Return the rank of a task, or of its plan; interchangeable entities may have any of their names.

        Raises:
            QueryError: it is no task of this space, or has something that is no action.
        """
        plan = parse_plan(task.actions if isinstance(task, Task) else task, self.domain.facts)
        rank = self._tasks.rank(tuple(map(str, plan)))
        if rank is None:
            message = f"no task of {self.title}: {' '.join(map(str, plan))}"
            raise QueryError(f"{message}; prag-asp explain says why it is no plan, where it is none")
        return rank

    @property
    def _tasks(self) -> WordSet:
        return WordSet(self.engines, "task", self.length)

    def action_texts(self, by: Level = "task") -> tuple[str, ...]:
        """Return what the numbers of ``sampling().array`` stand for: the texts of actions, or names for skeletons."""
        return self.engines.engine(checked_level(by), self.lengths[0]).letters

    def readings(self, task: Task) -> Readings:
        """Return the ways to read a task's plan as whole composites and free actions; its validity is not checked."""
        from prag_asp.space.plans.readings import Readings

        return Readings(task.actions, self.engines.hierarchy)

    def tasks_of_plans(self, plans: Iterable[Sequence[str]]) -> Iterator[Task]:
        """Yield the task of each of some valid plans, given as texts of actions, lazily."""
        return self.engines.task_builder.tasks((plan, None) for plan in plans)

    def tasks_of_draws(self, draws: Sequence[ProbablePlan]) -> list[Task]:
        """Return the task of each of some draws, with the logarithm of its probability: faster than one by one."""
        from prag_asp.space.sampling.streams import log_probability

        return self.engines.task_builder.build([(draw.word, log_probability(draw.probability)) for draw in draws])

    def sample(
        self,
        count: int,
        *,
        seed: int,
        weights: GivenWeights = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
        distinct: bool = False,
    ) -> list[Task]:
        """Return random tasks, each with a probability proportional to its weight, exactly.

        `weights` maps action names, pairs (``grasp>move``), entities and classes to exact numbers; None takes those
        of the domain, and an empty mapping samples uniformly. A task's weight is a product over its actions, so among
        several lengths weights above 1 favour long tasks. At `temperature` T each weight w becomes about w^(1/T):
        ``"inf"`` makes all alike. With ``over="skeletons"`` (or ``"goals"``, at one length), a skeleton (or what is
        known of the final state) is sampled uniformly, and then a task that has it by weight. With ``by="plan"``,
        plans are sampled in place of tasks. Tasks are independent; with `distinct`, each is sampled among those that
        are left.

        Raises:
            QueryError: there is nothing to sample, fewer distinct tasks than `count`, or a weight fits nothing.
        """
        if count < 0:
            raise QueryError(f"cannot sample {count} tasks; give a number of at least 0")
        if distinct and not (count or self.count(by)):
            return []
        if distinct and not over and count > self.count(by):
            raise QueryError(f"cannot sample {count} distinct {by}s: there are {self.count(by)}")
        tasks = self.stream(seed=seed, weights=weights, by=by, temperature=temperature, over=over, distinct=distinct)
        sampled = list(islice(tasks, count))
        if len(sampled) < count:
            raise QueryError(f"cannot sample {count} distinct {by}s: only {len(sampled)} weigh more than 0")
        return sampled

    def stream(
        self,
        *,
        seed: int,
        weights: GivenWeights = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
        distinct: bool = False,
    ) -> Iterator[Task]:
        """Yield tasks as `sample` returns them, without end; with `distinct`, until all were sampled."""
        if by == "skeleton":
            raise QueryError("tasks and plans are sampled, skeletons are not; choose task or plan")
        sampling = self.sampling(weights=weights, by=by, temperature=temperature, over=over)
        if not distinct:
            return chain.from_iterable(map(self.tasks_of_draws, sampling.batches(seed=seed)))
        from prag_asp.space.distinct_sampling import BATCH, distinct_order

        draws = distinct_order(sampling, seed).draws()
        return chain.from_iterable(map(self.tasks_of_draws, growing_batches(draws, BATCH)))

    def sampling(
        self,
        *,
        weights: GivenWeights = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
    ) -> TaskSampling:
        """Return what `sample` samples as one value: its draws as texts and arrays, its total weight, its statistics.

        Raises:
            QueryError: no such level, or a weight fits nothing in the domain.
        """
        from prag_asp.space.task_sampling import TaskSampling

        return TaskSampling(self.engines, checked_level(by), self.lengths, self.weights(weights, temperature), over)

    def weights(self, weights: GivenWeights = None, temperature: Temperature = 1) -> Weights:
        """Return weights as one parsed value, at a temperature.

        Raises:
            QueryError: a weight fits nothing in the domain, or is no exact number of at least 0.
        """
        from prag_asp.space.weights.temperature import tempered

        if not isinstance(weights, Weights):
            stated = self.domain.settings.weights if weights is None else weights
            weights = parse_weights(stated, self.domain.facts)
        return tempered(weights, temperature)

    def statistics(
        self, *, weights: GivenWeights = None, by: Level = "task", temperature: Temperature = 1
    ) -> Statistics:
        """Return exact figures on the tasks of one length, where they are sampled by weight.

        Raises:
            QueryError: there is nothing to sample, or a weight fits nothing.
        """
        return self.sampling(weights=weights, by=by, temperature=temperature).statistics()

    def split(self, shares: Mapping[str, Number | float], *, seed: int = 0) -> dict[str, RankedTasks]:
        """Return disjoint random parts that have these shares of the tasks, each rounded by less than one task.

        Raises:
            QueryError: the shares do not add up to 1.
        """
        from prag_asp.space.parts.ranked_tasks import RankedTasks, RankRange, ShuffledRanks
        from prag_asp.space.parts.shares import divided, parse_shares
        from prag_asp.space.parts.shuffle import Shuffle

        self.length  # noqa: B018  ranks are those of one length
        order = Shuffle(self.count(), seed)
        parts = divided(order.size, parse_shares(shares))
        return {name: RankedTasks(ShuffledRanks(order, RankRange(places)), self) for name, places in parts.items()}

    def split_skeletons(self, shares: Mapping[str, Number | float], *, seed: int = 0) -> dict[str, TaskSpace]:
        """Return disjoint random parts without a common skeleton, each a task space of this length.

        Their shares of the tasks are within two points of those requested, or, where whole skeletons allow no such
        choice, as near as one was found; a warning says so.

        Raises:
            QueryError: the shares do not add up to 1.
        """
        from prag_asp.space.conditions.whole_skeletons import divide_skeletons
        from prag_asp.space.parts.shares import parse_shares

        spaces: dict[Condition, TaskSpace] = {}

        def count(condition: Condition) -> int:
            if condition not in spaces:
                spaces[condition] = self.part(condition)
            return spaces[condition].count()

        parts = divide_skeletons(parse_shares(shares), seed, count, self._tasks_by_skeleton)
        return {name: spaces[condition] for name, condition in parts.items()}

    def _tasks_by_skeleton(self) -> dict[tuple[str, ...], int] | None:
        """Return the number of tasks of each skeleton, None where they are many or cannot be spelled."""
        from prag_asp.space.conditions.whole_skeletons import LONGEST, MOST_SKELETONS, SPELLABLE

        if self.length > LONGEST or self.count("skeleton") > MOST_SKELETONS:
            return None
        if not all(map(SPELLABLE.fullmatch, self.action_texts("skeleton"))):
            return None
        return {skeleton: self.count("task", skeleton) for skeleton in self.enumerate("skeleton")}

    def hold_out(self, what: str) -> tuple[TaskSpace, TaskSpace]:
        """Return the tasks without and those with something: an entity, a class, an action's name or a pair of names.

        The first part is for training; the second has a composition that training never showed. Their tasks are those
        of this space, whatever is interchangeable in a part alone.

        Raises:
            QueryError: there is no such thing, or the entity is interchangeable with one that training shows.
        """
        from prag_asp.space.parts.shares import held_out

        without, having = held_out(what, self.domain.facts, self.symmetries.orbits)
        return self.part(without), self.part(having)

    def dimacs(self, by: Level = "task") -> Iterator[str]:
        """Yield the lines of a formula with one model for each word, projected on what it shows, for model counters.

        Raises:
            QueryError: no such level.
            EngineError: the domain has no counterpart in clauses.
        """
        from prag_asp.logic.formula.cnf import dimacs
        from prag_asp.space.engines.word_formula import word_formula

        formula = word_formula(self.engines.model, checked_level(by), self.length)
        return dimacs(formula.cnf, [f"the {by}s of {self.title}, by prag_asp"])

    def _prefix(self, by: Level, prefix: Prefix, length: int) -> tuple[str, ...]:
        if isinstance(prefix, str):
            raise QueryError(f"prefix {prefix!r}: give a list, such as [{prefix!r}]")
        if not prefix:
            return ()
        items = [str(item) for item in prefix]
        reduction = self.domain.reduction
        if reduction and {*items} <= {action_name(action) for action in reduction.facts.actions}:
            return parse_prefix(items, by, reduction.facts)
        parsed = parse_prefix(items, by, self.domain.facts)
        if by != "task" or not parsed:
            return parsed
        return canonical_prefix(parsed, self.engines.actions, self.engines.model.symmetries(length))


def _unpickled(
    domain: Domain,
    lengths: tuple[int, ...],
    engine: str,
    limits: Limits,
    condition: Condition,
    part_of: TaskSpace | None,
) -> TaskSpace:
    """Return the space that another process has pickled."""
    return TaskSpace(domain, lengths, engine=engine, limits=limits)._restricted([condition], part_of)


def checked_level(by: Level) -> Level:
    """Return a level.

    Raises:
        QueryError: there is no such level.
    """
    if by not in LEVELS:
        raise QueryError(f"no level {by!r}; there are {', '.join(LEVELS)}")
    return by
