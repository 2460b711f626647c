"""The engines of a domain, created lazily, and the counts, samplers and task builder shared by its task spaces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

import clingo

from prag_asp.errors import QueryError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.processes.progress_events import Note
from prag_asp.space.engines import AUTO, Engine, Level, select
from prag_asp.space.engines.engine import Letters, Progress
from prag_asp.space.engines.listed_words import NoWords
from prag_asp.space.limits import Limits

if TYPE_CHECKING:
    from prag_asp.logic.formula.approximate import Estimate, Tolerance
    from prag_asp.space.conditions.condition import Condition
    from prag_asp.space.plans.readings import Hierarchy
    from prag_asp.space.plans.task_builder import TaskBuilder
    from prag_asp.space.reduced_count import ReducedCounter

ONE_STEP, CLINGO, SHORTEST = (AUTO, "automaton", "symbolic"), "clingo", "shortest"
"""The engines that use one ground step for all steps, the engine that grounds each step, and the engine for
``shortest``."""

Value = TypeVar("Value")


@dataclass
class DomainEngines:
    """The engines of a domain under given conditions, one for each level and length.

    No plan has fewer than `fewest_actions` actions; shorter lengths need no engine. With `shortest`, only those plans
    of the program whose goal cannot be reached by a shorter plan are words.
    """

    model: DomainLogic
    name: str
    progress: Progress | None
    limits: Limits
    fewest_actions: int = 0
    shortest: bool = False
    _engines: dict[tuple[Level, str], Engine] = field(default_factory=dict)
    _counts: dict[tuple[Level, int, Letters], int] = field(default_factory=dict)
    _latest: dict[str, tuple[Any, Any]] = field(default_factory=dict)

    def engine(self, by: Level, length: int) -> Engine:
        """Return the engine for a level and a length."""
        if length < self.fewest_actions:
            return NoWords(self.model, by)
        model, name = self.model, self.name
        if length == 0 and name in ONE_STEP and not model.obstacles and model.ground.after_steps_alone:
            name = CLINGO  # other engines would apply the rules that hold after a step to the plan without actions
        if self.shortest and length:
            from prag_asp.space.shortest_tasks import ShortestEngine

            if (by, SHORTEST) not in self._engines:
                self._engines[by, SHORTEST] = ShortestEngine(name, model, by, self.progress, self.limits)
            return self._engines[by, SHORTEST]
        if (by, name) not in self._engines:
            if model.domain.irreducible and self.progress:
                from prag_asp.reduction.reduction import is_large

                if is_large(model.domain.facts):
                    why = f"all entities are ground, though many are alike: {model.domain.irreducible}"
                    self.progress(Note(f"note: {why}"))
            self._engines[by, name] = select(name, model, by, self.progress, self.limits)
        return self._engines[by, name]

    def count(self, by: Level, length: int, prefix: Letters = ()) -> int:
        """Return the number of words; it is cached."""
        key = (by, length, prefix)
        if key not in self._counts:
            reduced = self._reduced.count(by, length, prefix) if self._reduced else None
            self._counts[key] = self.engine(by, length).count(length, prefix) if reduced is None else reduced
        return self._counts[key]

    def require_program(self, what: str) -> None:
        """Check that the answer sets of the program are exactly the plans.

        Raises:
            QueryError: a condition is not part of the program; `what` names the request in the message.
        """
        if self.shortest:
            raise QueryError(
                f"{what} reads the logic program, which does not state the condition shortest; leave it out"
            )

    def known_count(self, by: Level, length: int) -> int | None:
        """Return the number of words if it has been counted already, without computing anything."""
        return self._counts.get((by, length, ()))

    def estimate(self, by: Level, length: int, prefix: Letters, tolerance: Tolerance, seed: int) -> Estimate:
        """Return an estimate of the number of words, computed by ApproxMC."""
        from prag_asp.logic.formula.approximate import Estimate
        from prag_asp.space.engines.sharp_engine import estimate_words

        self.require_program("an estimate")
        if length < self.fewest_actions:
            return Estimate(0, tolerance)
        return estimate_words(self.model, by, length, prefix, tolerance, seed, self.limits)

    def under(self, condition: Condition, whole: DomainLogic | None) -> DomainEngines:
        """Return engines for the same domain under another condition; `whole` has the renamings that define tasks."""
        from prag_asp.space.conditions.clause_kinds import SHORTEST as NO_DETOUR
        from prag_asp.space.conditions.conditioned_domain import conditioned

        bare = self.model.bare or self.model
        model = DomainLogic(conditioned(bare.domain, condition), bare, whole)
        return DomainEngines(
            model, self.name, self.progress, self.limits, condition.fewest_actions, NO_DETOUR in condition.clauses
        )

    @cached_property
    def _reduced(self) -> ReducedCounter | None:
        """The counter for the small-model reduction, or None if the domain has no such reduction."""
        domain = self.model.domain
        if domain.reduction is None:
            return None
        from prag_asp.space.reduced_count import ReducedCounter

        return ReducedCounter(domain, domain.reduction, self.name, self.progress, self.limits)

    def latest(self, kind: str, key: Any, make: Callable[[], Value]) -> Value:
        """Return the value for a key; only the latest value of each kind is cached because samplers are large."""
        if kind not in self._latest or self._latest[kind][0] != key:
            self._latest[kind] = (key, make())
        value: Value = self._latest[kind][1]
        return value

    @cached_property
    def actions(self) -> dict[str, clingo.Symbol]:
        """The actions of the domain, by text."""
        return {str(action): action for action in self.model.domain.facts.actions}

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """The composites of the domain."""
        from prag_asp.space.plans.readings import hierarchy_of

        return hierarchy_of(self.model.domain.facts)

    @cached_property
    def task_builder(self) -> TaskBuilder:
        """The object that builds tasks from plans."""
        from prag_asp.space.plans.task_builder import TaskBuilder

        return TaskBuilder(self.model)
