"""The task space of a domain at one or several lengths: the public interface to its tasks.

Modules that only some methods need are imported there, so that counting starts fast.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from copy import copy
from functools import cache
from itertools import chain, count, islice
from typing import TYPE_CHECKING, Any, overload

from prag_asp.atom import Atom
from prag_asp.batches import growing_batches
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.exact_numbers import Number
from prag_asp.logic.domain_logic import logic_of
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.domain_engines import DomainEngines
from prag_asp.space.engines import Level
from prag_asp.space.engines.engine import Letters, Progress
from prag_asp.space.engines.prefix import Prefix, checked_level, engine_prefix, parse_plan
from prag_asp.space.lengths import checked_length, parse_lengths, spelled_lengths
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.weights.weights import Weights, parse_weights
from prag_asp.space.word_set import WordSet
from prag_asp.task import Task
from prag_asp.wording import unknown

if TYPE_CHECKING:
    from prag_asp.logic.formula.approximate import Estimate
    from prag_asp.similarity.background import Background
    from prag_asp.space.final_states import Ending
    from prag_asp.space.parts.ranked_tasks import RankedTasks
    from prag_asp.space.plans.readings import Readings
    from prag_asp.space.sampling.samplers import Over
    from prag_asp.space.sampling.statistics import Statistics
    from prag_asp.space.sampling.streams import ProbablePlan
    from prag_asp.space.task_sampling import TaskSampling
    from prag_asp.space.weights.temperature import Temperature

SHOWN_LENGTHS, LONG_COUNT = 50, 10**60
"""The maximum number of lengths in a notebook's table, and the smallest count that is too long for the table."""

GivenWeights = Mapping[str, Number] | Weights | None
"""Weights keyed by action names, pairs (``grasp>move``), entities and classes; None means the weights of the domain."""


class TaskSpace:
    """All tasks of a domain with a given number of actions: counted, enumerated, tested and sampled exactly.

    `length` is this number, several numbers (``range(3, 7)``), or a text (``"3..6"``). `engine` is ``automaton``,
    ``clingo``, ``sat``, ``sharp``, ``symbolic`` or ``auto``; `limits` bound the time and memory of each query. Ranks,
    statistics, splits and estimates need a single length. There is no ``len()`` because counts exceed its range.

    Raises:
        QueryError: a length is negative or not a whole number, there is no length, or there is no such engine.
        EngineError: the engine cannot express the domain; the first query raises it.
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
            raise QueryError(f"{domain!r} is not a domain; give load_domain({domain!r})")
        self.engines = DomainEngines(logic_of(domain), engine, progress, limits)
        self.domain = domain
        self.lengths = parse_lengths(length)
        self.condition = Condition()
        self._part_of: TaskSpace | None = None
        self._longest: int | None = None
        """The greatest length for which the engines can answer, or None if they can answer for all lengths."""

    def __copy__(self) -> TaskSpace:
        space = object.__new__(type(self))
        space.__dict__.update(self.__dict__)
        return space

    def __getstate__(self) -> tuple[Any, ...]:
        """Return the state to pickle; the unpickled copy recomputes results and reports no progress."""
        engines = self.engines
        return self.domain, self.lengths, engines.name, engines.limits, self.condition, self._part_of

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        domain, lengths, engine, limits, condition, part_of = state
        space = TaskSpace(domain, lengths, engine=engine, limits=limits)._restricted([condition], part_of)
        self.__dict__ = space.__dict__

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
        """The domain, the lengths and the conditions as text."""
        where = "".join(f", where {clause}" for clause in self.condition.clauses)
        return f"{self.domain.label} of length {spelled_lengths(self.lengths)}{where}"

    @property
    def symmetries(self) -> Symmetries:
        """The interchangeable entities and units; tasks are plans up to the renamings that these generate."""
        return self.engines.model.symmetries(self.length)

    @property
    def background(self) -> Background:
        """The classes, preconditions and interchangeable entities, for distances between tasks."""
        from prag_asp.space.plans.task_background import background_of

        model, length = self.engines.model, max(self.lengths)
        return self.engines.latest(
            "background", length, lambda: background_of(model.domain.facts, model.symmetries(length))
        )

    def __repr__(self) -> str:
        length = self.lengths[0] if len(self.lengths) == 1 else spelled_lengths(self.lengths)
        where = "".join(f".where({str(clause)!r})" for clause in self.condition.clauses)
        return f"TaskSpace({self.domain.label!r}, length={length!r}){where}"

    def _repr_html_(self) -> str:
        """Return the space for a notebook: its domain, lengths and conditions, and the counts that are known."""
        from prag_asp.html import element, fragment, scroll_table

        known = [(length, self.engines.known_count("task", length)) for length in self.lengths]
        rows = [(str(length), f"{number:,}") for length, number in known if number is not None and number < LONG_COUNT]
        clauses = (element("li", element("code", str(clause))) for clause in self.condition.clauses)
        lengths = f", length {spelled_lengths(self.lengths)}, engine {self.engines.name}"
        return fragment(
            element("p", element("strong", f"The tasks of {self.domain.label}"), lengths),
            *([element("ul", *clauses)] if self.condition else []),
            scroll_table(("length", "tasks"), rows, label="Counts", most=SHOWN_LENGTHS)
            if rows
            else element("p", "count() counts them.", class_="note"),
        )

    def at(self, length: int) -> TaskSpace:
        """Return the space of a single length, even one that this space lacks, with the same conditions and engines."""
        space = copy(self)
        space.lengths = (checked_length(length),)
        if self._longest is not None and length > self._longest:
            space._restrict_engines(self.engines)
        return space

    def where(self, *conditions: str | Condition) -> TaskSpace:
        """Return the space of the tasks that satisfy all `conditions`, given as values or texts.

        Entities that a condition distinguishes are no longer interchangeable in that space.

        Raises:
            QueryError: a condition cannot be parsed, or names something that the domain does not have.
        """
        return self._restricted(conditions, None)

    def _restricted(self, conditions: Iterable[str | Condition], part_of: TaskSpace | None) -> TaskSpace:
        """Return the space with further conditions; `part_of` is the space whose renamings define its tasks."""
        space = copy(self)
        for condition in conditions:
            space.condition &= condition if isinstance(condition, Condition) else Condition.parse(condition)
        if space.condition != self.condition:
            space._part_of = part_of
            space._restrict_engines(self.engines)
        return space

    def _restrict_engines(self, engines: DomainEngines) -> None:
        """Create the engines for the condition from engines of this domain under other conditions."""
        condition = self.condition.up_to(max(self.lengths))
        self.engines = engines.under(condition, self._part_of.engines.model if self._part_of else None)
        self._longest = None if condition == self.condition else max(self.lengths)

    def part(self, condition: str | Condition) -> TaskSpace:
        """Return the tasks that satisfy a condition, up to the renamings of this space, which preserve the condition.

        With `where`, more entities may be interchangeable: for example a and b, if the condition places one entity on
        each.
        """
        return self._restricted([condition], self)

    @property
    def whole(self) -> TaskSpace:
        """The space of which this space is a part, or this space itself if it is not a part."""
        return self if self._part_of is None else self._part_of.whole

    def same_tasks(self, other: object) -> bool:
        """Return whether another space has the same domain, lengths and conditions, and therefore the same ranks."""
        if not isinstance(other, TaskSpace):
            return False
        request = self.domain, self.lengths, self.condition
        if self is other or request != (other.domain, other.lengths, other.condition):
            return self is other
        return self._part_of is other._part_of or all(
            self.at(length).symmetries == other.at(length).symmetries for length in self.lengths
        )

    def count(self, by: Level = "task", prefix: Prefix = ()) -> int:
        """Return the exact number of plans, tasks or skeletons that begin with `prefix`, summed over all lengths.

        Raises:
            QueryError: there is no such level, or the prefix names no action of the domain.
            LimitReached: a limit ended the count of a given length; the error gives the number counted for that length.
        """
        return sum(self.engines.count(by, length, first) for length, first in self._prefixes(by, prefix))

    def next_actions(self, prefix: Prefix = (), by: Level = "task") -> dict[str, int]:
        """Return each action or name that may follow `prefix`, with the exact number of words that begin that way.

        The words are plans, tasks or skeletons. Numbers are above 0, and add up to the number of words that begin with
        `prefix`, unless `prefix` is already as long as the words. The actions of tasks have canonical names of
        entities.

        Raises:
            QueryError: there is no such level, the space has several lengths, or the prefix names no action.
            LimitReached: a limit ended the count.
        """
        self.length  # noqa: B018  a next action belongs to one length
        ((length, first),) = self._prefixes(by, prefix)
        return self.engines.engine(by, length).following(length, first)

    def ending(self, facts: Sequence[Collection[str]], prefix: Prefix = (), by: Level = "task") -> list[Ending | None]:
        """Return, for each set of `facts`, how many plans or tasks begin with `prefix` and end with one of its facts.

        Facts of tasks have canonical names of entities. The result is None for a set with a fact that takes too many
        states to be counted together with the others; the condition ``ends`` can count it separately. If few tasks
        begin with `prefix`, all facts are counted.

        Raises:
            QueryError: there is no such level or fact, or the space has several lengths.
            LimitReached: a limit ended the exploration of the states.
            EngineError: there are too many words to list.
        """
        from prag_asp.space.final_states import FEW_TASKS, Ending, endings_of, final_states

        if by == "skeleton":
            raise QueryError("skeletons have no final states; choose task or plan")
        length, model = self.length, self.engines.model
        ((_, first),) = self._prefixes(by, prefix)
        places = {str(fluent): place for place, fluent in enumerate(self.domain.facts.fluents)}
        for fact in (fact for each in facts for fact in each if fact not in places):
            raise QueryError(unknown(fact, places, "fluent"))
        if not length:
            return [None for _ in facts]
        if length < self.engines.fewest_actions:
            return [Ending(0, 0) for _ in facts]
        if self.engines.engine(by, length).count(length, first) <= FEW_TASKS:
            return endings_of(list(self.tasks_of_plans(self.enumerate(by, prefix))), facts)
        found = self.engines.latest(
            "final states",
            (by, length),
            lambda: final_states(model, self.engines.engine(by, length), by, length, self.engines.limits.begin()),
        )
        if found is None:
            return [None for _ in facts]
        return found.count(first, [[places[fact] for fact in each] for each in facts])

    def _prefixes(self, by: Level, prefix: Prefix) -> list[tuple[int, Letters]]:
        """Return each length with a prefix in the form that the engine for this length expects."""
        checked_level(by)
        model = self.engines.model
        return [(length, engine_prefix(prefix, by, length, self.domain, model)) for length in self.lengths]

    def estimate(
        self, by: Level = "task", prefix: Prefix = (), *, epsilon: float = 0.8, delta: float = 0.2, seed: int = 0
    ) -> Estimate:
        """Return the approximate number of plans, tasks or skeletons that begin with `prefix`, computed by ApproxMC.

        With a probability of at least 1 - `delta`, it is within a factor of 1 + `epsilon` of the exact number.

        Raises:
            QueryError: there is no such level, the prefix names no action of the domain, or a number is out of range.
            EngineError: ApproxMC is not installed or fails, or the program cannot be translated to clauses.
            LimitReached: the time limit is reached.
        """
        from prag_asp.logic.formula.approximate import Tolerance

        tolerance, length = Tolerance(epsilon, delta), self.length
        ((_, first),) = self._prefixes(by, prefix)
        return self.engines.estimate(by, length, first, tolerance, seed)

    def enumerate(self, by: Level = "task", prefix: Prefix = ()) -> Iterator[tuple[str, ...]]:
        """Yield plans and tasks as texts of actions, or skeletons as names, lazily, length by length in order of rank.

        Raises:
            QueryError: there is no such level, or the prefix names no action of the domain.
        """
        words = (self.engines.engine(by, length).words(length, first) for length, first in self._prefixes(by, prefix))
        return chain(next(words), chain.from_iterable(words))

    def tasks(self, prefix: Prefix = ()) -> Iterator[Task]:
        """Yield each task that begins with `prefix` once, lazily, length by length in order of rank."""
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
        """Return the task with a given rank, or a lazy range.

        Tasks are in lexicographic order, with actions in clingo's order.

        Raises:
            IndexError: the rank is out of range; negative ranks count from the end.
        """
        from prag_asp.space.parts.ranked_tasks import RankedTasks, RankRange

        self.length  # noqa: B018  ranks are those of one length
        return RankedTasks(RankRange(range(self.count())), self)[rank]

    def plan_at(self, rank: int) -> tuple[str, ...]:
        """Return the plan of the task with a given rank, from 0 to ``count() - 1``, as the texts of its actions."""
        return WordSet(self.engines, "task", self.length).word(rank)

    def index(self, task: Task | Sequence[str | Atom]) -> int:
        """Return the rank of a task or a plan; the names of interchangeable entities do not matter.

        Raises:
            QueryError: the task is not in this space, or contains something that is not an action.
        """
        plan = parse_plan(task.actions if isinstance(task, Task) else task, self.domain.facts)
        rank = WordSet(self.engines, "task", self.length).rank(tuple(map(str, plan)))
        if rank is None:
            message = f"no task of {self.title}: {' '.join(map(str, plan))}"
            raise QueryError(f"{message}; prag-asp explain shows why a sequence is not a plan")
        return rank

    def action_texts(self, by: Level = "task") -> tuple[str, ...]:
        """Return the texts of the actions, or names for skeletons, to which numbers in ``sampling().array`` refer."""
        return self.engines.engine(checked_level(by), self.lengths[0]).letters

    def readings(self, task: Task) -> Readings:
        """Return the decompositions of a task's plan into composites and free actions; the plan is not validated."""
        from prag_asp.space.plans.readings import Readings

        return Readings(task.actions, self.engines.hierarchy)

    def tasks_of_plans(self, plans: Iterable[Sequence[str]]) -> Iterator[Task]:
        """Yield the task of each valid plan, given as texts of actions, lazily."""
        return self.engines.task_builder.tasks((plan, None) for plan in plans)

    def tasks_of_draws(self, draws: Sequence[ProbablePlan]) -> list[Task]:
        """Return the task of each draw, with the logarithm of its probability; batches are faster than single draws."""
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
        """Return random tasks with probabilities exactly proportional to their weights.

        `weights` maps action names, pairs (``grasp>move``), entities and classes to exact numbers; None stands for the
        weights of the domain, and with an empty mapping, tasks are sampled uniformly. A task's weight is a product over
        its actions, so if there are several lengths, weights above 1 favour long tasks. At `temperature` T each weight
        w becomes about w^(1/T); ``"inf"`` makes all weights equal. With ``over="skeletons"`` (or ``"goals"``, at one
        length), a skeleton (or the known part of a final state) is sampled uniformly, and then one of its tasks by
        weight. With ``by="plan"``, plans are sampled instead of tasks. Samples are independent; with `distinct`, they
        are drawn without replacement.

        Raises:
            QueryError: there is nothing to sample, there are fewer distinct tasks than `count`, or a weight matches
                nothing.
        """
        if count < 0:
            raise QueryError(f"cannot sample {count} tasks; give a number of at least 0")
        if distinct and not (count or self.count(by)):
            return []
        if distinct and count > self.count(by):
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
        """Yield tasks as `sample` returns them, endlessly; with `distinct`, until all tasks are sampled."""
        if by == "skeleton":
            raise QueryError("tasks and plans are sampled, skeletons are not; choose task or plan")
        sampling = self.sampling(weights=weights, by=by, temperature=temperature, over=over)
        if not distinct:
            return chain.from_iterable(map(self.tasks_of_draws, sampling.batches(seed=seed)))
        from prag_asp.space.distinct_sampling import BATCH, distinct_order

        draws = distinct_order(sampling, seed).pick(count())
        return chain.from_iterable(map(self.tasks_of_draws, growing_batches(draws, BATCH)))

    def sampling(
        self,
        *,
        weights: GivenWeights = None,
        by: Level = "task",
        temperature: Temperature = 1,
        over: Over | None = None,
    ) -> TaskSampling:
        """Return the distribution from which `sample` draws: draws as texts or arrays, total weight and statistics.

        Raises:
            QueryError: there is no such level, or a weight matches nothing in the domain.
        """
        from prag_asp.space.task_sampling import TaskSampling

        return TaskSampling(self.engines, checked_level(by), self.lengths, self.weights(weights, temperature), over)

    def weights(self, weights: GivenWeights = None, temperature: Temperature = 1) -> Weights:
        """Return the parsed weights at a given temperature.

        Raises:
            QueryError: a weight matches nothing in the domain, or is not an exact number of at least 0.
        """
        from prag_asp.space.weights.temperature import tempered

        if not isinstance(weights, Weights):
            stated = self.domain.settings.weights if weights is None else weights
            weights = parse_weights(stated, self.domain.facts)
        return tempered(weights, temperature)

    def statistics(
        self, *, weights: GivenWeights = None, by: Level = "task", temperature: Temperature = 1
    ) -> Statistics:
        """Return exact statistics of the tasks of one length when they are sampled by weight.

        Raises:
            QueryError: there is nothing to sample, or a weight matches nothing.
        """
        return self.sampling(weights=weights, by=by, temperature=temperature).statistics()

    def split(self, shares: Mapping[str, Number | float], *, seed: int = 0) -> dict[str, RankedTasks]:
        """Return disjoint random parts with the given shares of the tasks, each rounded by less than one task.

        Raises:
            QueryError: the shares do not add up to 1.
        """
        from prag_asp.space.parts.ranked_tasks import RankedTasks, divided_ranks

        self.length  # noqa: B018  ranks are those of one length
        parts = divided_ranks(self.count(), shares, seed)
        return {name: RankedTasks(ranks, self) for name, ranks in parts.items()}

    def split_skeletons(self, shares: Mapping[str, Number | float], *, seed: int = 0) -> dict[str, TaskSpace]:
        """Return disjoint random parts that share no skeleton, each a task space of this length.

        Their shares of the tasks are within two percentage points of the requested ones. If whole skeletons do not
        allow this, the parts have the closest shares that the search finds, and a `SharesWarning` is issued.

        Raises:
            QueryError: the shares do not add up to 1.
        """
        from prag_asp.space.conditions.whole_skeletons import LONGEST, MOST_SKELETONS, SPELLABLE, divide_skeletons
        from prag_asp.space.parts.shares import parse_shares

        part = cache(self.part)

        def tasks_by_skeleton() -> dict[tuple[str, ...], int] | None:
            few = self.length <= LONGEST and self.count("skeleton") <= MOST_SKELETONS
            if not few or not all(map(SPELLABLE.fullmatch, self.action_texts("skeleton"))):
                return None
            return {skeleton: self.count("task", skeleton) for skeleton in self.enumerate("skeleton")}

        parts = divide_skeletons(
            parse_shares(shares), seed, lambda clause: part(clause).count(), tasks_by_skeleton,
            names=len(self.domain.facts.action_names), length=self.length,
        )  # fmt: skip
        return {name: part(condition) for name, condition in parts.items()}

    def hold_out(self, what: str) -> tuple[TaskSpace, TaskSpace]:
        """Return the tasks without `what` (an entity, class, action's name or pair of names), and the tasks with it.

        The first part is for training; the second contains a composition that never occurs in training. Both keep the
        symmetries of this space, even if more entities are interchangeable within a part.

        Raises:
            QueryError: nothing has that name, or the entity is interchangeable with an entity that occurs in training.
        """
        from prag_asp.space.parts.shares import held_out

        without, having = held_out(what, self.domain.facts, self.symmetries.orbits)
        return self.part(without), self.part(having)

    def dimacs(self, by: Level = "task") -> Iterator[str]:
        """Yield the lines of a DIMACS formula for model counters, with one projected model for each word.

        Raises:
            QueryError: there is no such level.
            EngineError: the domain cannot be translated to clauses.
        """
        from prag_asp.logic.formula.cnf import dimacs
        from prag_asp.space.engines.word_formula import word_formula

        self.engines.require_program("a formula")
        formula = word_formula(self.engines.model, checked_level(by), self.length)
        return dimacs(formula.cnf, [f"the {by}s of {self.title}, by prag_asp"])
