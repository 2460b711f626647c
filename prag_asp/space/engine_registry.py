"""What the task spaces of one domain share: its logic, its engines, and what was drawn with last."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from prag_asp.errors import QueryError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.processes.progress_events import Note
from prag_asp.space.engines import AUTO, Engine, Level, select
from prag_asp.space.engines.engine import Letters, Progress
from prag_asp.space.engines.listed_words import NoWords
from prag_asp.space.limits import Limits

if TYPE_CHECKING:
    from prag_asp.space.plans.readings import Hierarchy
    from prag_asp.space.plans.task_builder import Narrator
    from prag_asp.space.reduced_count import ReducedCounter
    from prag_asp.space.sampling.samplers import Drawer, Over
    from prag_asp.space.weights.weights import Weights
    from prag_asp.task import Task


BY_ONE_STEP, CLINGO = (AUTO, "automaton", "symbolic"), "clingo"
"""The engines that know one step for all, and one that knows each."""


@dataclass
class Shared:
    """The logic of a domain and its engines, each made when first asked for.

    No plan is shorter than `fewest_actions`: what is asked of shorter ones is answered without an engine.
    """

    model: DomainLogic
    engine: str
    progress: Progress | None
    limits: Limits
    fewest_actions: int = 0
    _engines: dict[tuple[Level, str], Engine] = field(default_factory=dict)
    _counts: dict[tuple[Level, int, Letters], int] = field(default_factory=dict)
    _drawer: tuple[tuple[Any, ...], Drawer] | None = None

    def engine_for(self, by: Level, length: int) -> Engine:
        """Return the engine of a level, for a length."""
        if length < self.fewest_actions:
            return NoWords(self.model, by)
        name = CLINGO if length == 0 and self._judged_after_steps_alone else self.engine
        if (by, name) not in self._engines:
            self._tell_all_ground()
            self._engines[by, name] = select(name, self.model, by, self.progress, self.limits)
        return self._engines[by, name]

    @cached_property
    def _judged_after_steps_alone(self) -> bool:
        """Whether the engine would judge a plan without actions as if there had been a step."""
        if self.engine not in BY_ONE_STEP or self.model.obstacles:
            return False
        return self.model.ground.after_steps_alone

    def count(self, by: Level, length: int, prefix: Letters = ()) -> int:
        """Return the number of words, and keep it."""
        key = (by, length, prefix)
        if key not in self._counts:
            found = self._reduced_counter.count(by, length, prefix) if self._reduced_counter else None
            self._counts[key] = self.engine_for(by, length).count(length, prefix) if found is None else found
        return self._counts[key]

    @cached_property
    def _reduced_counter(self) -> ReducedCounter | None:
        """The counter with the small-model reduction of the domain, if it has one."""
        domain = self.model.domain
        if domain.reduction is None:
            return None
        from prag_asp.space.reduced_count import ReducedCounter

        return ReducedCounter(domain, domain.reduction, self.engine, self.progress, self.limits)

    def _tell_all_ground(self) -> None:
        """Note which statement prevents the small-model reduction of a large domain."""
        domain = self.model.domain
        if not domain.irreducible or not self.progress:
            return
        from prag_asp.reduction.reduction import is_large

        if is_large(domain.facts):
            self.progress(Note(f"note: all entities are ground, though many are alike: {domain.irreducible}"))

    def drawer_for(self, by: Level, length: int, weights: Weights, over: Over | None) -> Drawer:
        """Return the way to draw words, and keep the last one made."""
        from prag_asp.space.sampling.draws import make_drawer

        key = (by, length, weights, over)
        if self._drawer is None or self._drawer[0] != key:
            made = make_drawer(self.engine_for(by, length), self.model.domain.facts, by, length, weights, over)
            self._drawer = (key, made)
        return self._drawer[1]

    def draw_distinct(self, by: Level, length: int, count: int, seed: int) -> list[Task]:
        """Return different tasks, every set of them equally likely.

        Raises:
            QueryError: there are fewer.
        """
        from prag_asp.random_bits import SeededBits
        from prag_asp.space.parts.ranked_tasks import distinct_ranks
        from prag_asp.space.sampling.draws import log_probability

        total = self.count(by, length)
        if count > total:
            raise QueryError(f"cannot draw {count} distinct {by}s: there are {total}")
        engine = self.engine_for(by, length)
        share = log_probability(Fraction(1, total)) if total else None
        ranks = distinct_ranks(SeededBits(seed), total, count)
        return list(self.narrator.tasks((engine.unrank(length, rank), share) for rank in ranks))

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """The composites of the domain."""
        from prag_asp.space.plans.readings import hierarchy_of

        return hierarchy_of(self.model.domain.facts)

    @cached_property
    def narrator(self) -> Narrator:
        """Tells tasks from plans."""
        from prag_asp.space.plans.task_builder import Narrator

        return Narrator(self.model)
