"""The words of a domain at one length: which there are, under which conditions, how many, and each by its rank.

What only some questions need is imported where they are asked, so that a count starts at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, TypeVar

from prag_asp.atom import Atom
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.program.entity_names import action_name
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.engine_registry import Shared
from prag_asp.space.engines import LEVELS, Engine, Level
from prag_asp.space.engines.engine import Progress
from prag_asp.space.engines.prefix import parse_prefix
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.plans.canonical_plan import canonical_prefix

if TYPE_CHECKING:
    from typing_extensions import Self

    from prag_asp.logic.formula.approximate import Estimate

Space = TypeVar("Space", bound="WordSpace")

Prefix = Sequence[str | Atom]
"""What a word begins with: for each of the first steps an action or the name of one."""


class WordSpace:
    """All plans, tasks and skeletons of a domain with a given number of actions, as words: told apart and counted."""

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
        self._shared = Shared(DomainLogic(domain), engine, progress, limits)
        self.domain = domain
        self.length = _checked(length)
        self.condition = Condition()
        self._part_of: Self | None = None

    def __copy__(self) -> Self:
        space = object.__new__(type(self))
        space.__dict__.update(self.__dict__)
        return space

    def __reduce__(self) -> tuple[Any, ...]:
        """Let it be sent to other processes, where it computes anew; nobody is told of progress there."""
        shared = self._shared
        return _sent, (
            type(self),
            self.domain,
            self.length,
            shared.engine,
            shared.limits,
            self.condition,
            self._part_of,
        )

    def same_tasks(self, other: object) -> bool:
        """Tell whether another space is of the same domain, length and conditions: its ranks mean the same tasks."""
        if not isinstance(other, WordSpace):
            return False
        asked = self.domain, self.length, self.condition
        if self is other or asked != (other.domain, other.length, other.condition):
            return self is other
        return self._part_of is other._part_of or self.symmetries == other.symmetries

    def at(self, length: int) -> Self:
        """Return the space of another length, which shares all that was computed."""
        space = copy(self)
        space.length = _checked(length)
        return space

    def where(self, *conditions: str | Condition) -> Self:
        """Return the space of those tasks that satisfy all of some conditions, each a value or its words.

        Entities that a condition tells apart are not interchangeable in that space; none become so by it.

        Raises:
            QueryError: a condition is none, or speaks of something that the domain does not have.
        """
        return self._asked(conditions, None)

    def _asked(self, conditions: Iterable[str | Condition], part_of: Self | None) -> Self:
        """Return the space under further conditions, as a part of another one where that is given."""
        space = copy(self)
        for condition in conditions:
            space.condition &= condition if isinstance(condition, Condition) else Condition.parse(condition)
        if space.condition != self.condition:
            from prag_asp.space.conditions.conditioned_domain import conditioned

            shared = self._shared
            whole = part_of._shared.model if part_of else None
            model = DomainLogic(conditioned(self.domain, space.condition), shared.model.bare or shared.model, whole)
            fewest = space.condition.fewest_actions
            space._shared = Shared(model, shared.engine, shared.progress, shared.limits, fewest)
            space._part_of = part_of
        return space

    def _part(self, condition: str | Condition) -> Self:
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
        return f"{type(self).__name__}({self.domain.label!r}, length={self.length}){where}"

    def count(self, by: Level = "task", prefix: Prefix = ()) -> int:
        """Return the exact number of plans, tasks or skeletons that begin with `prefix`.

        Raises:
            QueryError: no such level, or the prefix names no action of the domain.
            LimitReached: a limit ended the count; the error has the number that was found until then.
        """
        return self._shared.count(checked_level(by), self.length, self._prefix(by, prefix))

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

        tolerance = Tolerance(epsilon, delta)
        level, first = checked_level(by), self._prefix(by, prefix)
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

    def letters(self, by: Level = "task") -> tuple[str, ...]:
        """Return what the numbers of `draw_array` stand for: the texts of actions, or names."""
        return self._engine(by).letters

    def word(self, rank: int) -> tuple[str, ...]:
        """Return the task of a rank from 0 to ``count() - 1`` as the texts of its actions."""
        return self._engine("task").unrank(self.length, rank)

    def dimacs(self, by: Level = "task") -> Iterator[str]:
        """Yield the lines of a formula with one model for each word, projected on what it shows, for model counters.

        Raises:
            QueryError: no such level.
            EngineError: the domain has no counterpart in clauses.
        """
        from prag_asp.logic.formula.cnf import dimacs
        from prag_asp.space.engines.word_formula import word_formula

        formula = word_formula(self._shared.model, checked_level(by), self.length)
        return dimacs(formula.cnf, [f"the {by}s of {self.title}, by prag_asp"])

    def _engine(self, by: Level) -> Engine:
        return self._shared.engine_for(checked_level(by), self.length)

    def _prefix(self, by: Level, prefix: Prefix) -> tuple[str, ...]:
        if isinstance(prefix, str):
            raise QueryError(f"prefix {prefix!r}: give a list, such as [{prefix!r}]")
        if not prefix:
            return ()
        items = [str(item) for item in prefix]
        reduction = self.domain.reduction
        if reduction and {*items} <= {action_name(action) for action in reduction.facts.actions}:
            return parse_prefix(items, by, reduction.facts)
        facts = self.domain.facts
        found = parse_prefix(items, by, facts)
        if by != "task" or not found:
            return found
        return canonical_prefix(found, {str(action): action for action in facts.actions}, self.symmetries)


def _sent(
    kind: type[Space],
    domain: Domain,
    length: int,
    engine: str,
    limits: Limits,
    condition: Condition,
    part_of: Space | None,
) -> Space:
    """Return the space that another process has sent."""
    return kind(domain, length, engine=engine, limits=limits)._asked([condition], part_of)


def _checked(length: int) -> int:
    if not isinstance(length, int) or isinstance(length, bool):
        raise QueryError(f"length {length!r}: give a whole number, such as 4")
    if length < 0:
        raise QueryError(f"length {length}: a plan has at least 0 actions")
    return length


def checked_level(by: Level) -> Level:
    """Return a level, where there is such a one."""
    if by not in LEVELS:
        raise QueryError(f"no level {by!r}; there are {', '.join(LEVELS)}")
    return by
