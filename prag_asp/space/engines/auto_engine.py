"""The choice of an engine: states are listed if they fit into memory; otherwise they are represented by diagrams.

A forecast, based on the number of new states in each step, decides which. If a step is not a function of the state,
clingo enumerates; if that takes a long time, a model counter runs in parallel, and the first to finish answers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from prag_asp.errors import EngineError, LimitReached
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.processes.machine import usual_memory
from prag_asp.processes.progress_events import Note
from prag_asp.space.automaton.bounded_count import count_within
from prag_asp.space.automaton.exploration import Extent
from prag_asp.space.automaton.outlook import forecast_states
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.engine import Engine, Letters, Level, Progress
from prag_asp.space.engines.reachability import Reach, TooManyStates
from prag_asp.space.limits import UNLIMITED, Limits, limit_error
from prag_asp.space.weights.weights import Weighed, Weights

if TYPE_CHECKING:
    from prag_asp.logic.formula.clause_builder import Literal
    from prag_asp.logic.formula.cnf import Cnf
    from prag_asp.logic.formula.counter import CountBeside
    from prag_asp.space.engines.clingo_engine import ClingoEngine

PATIENCE = 2.0
"""Seconds for which clingo enumerates alone, at about 100,000 words per second."""

EARLY, SURE = 64, 4
"""A forecast is used once states take 1/`EARLY` of the memory limit, if the forecast exceeds `SURE` times this limit.
"""


Answer = TypeVar("Answer")


@dataclass
class Growth:
    """The number of states after each number of steps, and the memory that exploration may take, in bytes."""

    memory: int
    states: dict[int, int] = field(default_factory=dict)

    def hopeless(self, extent: Extent, length: int) -> bool:
        """Return whether exploration is forecast to exceed the memory within `length` steps.

        The forecast assumes that memory is proportional to the number of states; see `forecast_states`.
        """
        if self.states and extent.depth < max(self.states):
            self.states.clear()
        self.states[extent.depth] = extent.states
        if extent.nbytes * EARLY < self.memory:
            return False
        return self.forecast(extent, length) > SURE * self.memory

    def forecast(self, extent: Extent, length: int) -> int:
        """Return the forecast memory of an exploration of `length` steps, in bytes."""
        depths = sorted(self.states)[:-1]  # the last step is incomplete
        sizes = [self.states[depth] for depth in depths]
        layers = [later - sooner for sooner, later in zip([0, *sizes], sizes, strict=False)]
        if len(layers) < 3 or not (layers[-2] and layers[-3]):
            return extent.nbytes
        states = forecast_states(sizes, length - depths[-1])
        return int(extent.nbytes * max(states / extent.states, 1.0))


class AutoEngine:
    """The automaton engine, or diagrams for lengths at which the automaton would have too many states.

    Raises:
        EngineError: the step is not a function of the state and the action.
    """

    def __init__(
        self, model: DomainLogic, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
    ) -> None:
        self._request = (model, level, progress, limits)
        growth = Growth(usual_memory() if limits.memory_bytes is None else limits.memory_bytes)
        self._listing = AutomatonEngine(model, level, progress, limits, hopeless=growth.hopeless)
        self._diagrams: Engine | None = None
        self._exceeded: tuple[int, Reach] | None = None

    @property
    def letters(self) -> Letters:
        """The texts of the letters, in order."""
        return self._listing.letters

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a given length.

        Raises:
            LimitReached: a limit ended the count; the error gives the number of words counted so far.
        """
        try:
            return self._answer(length, lambda engine: engine.count(length, prefix))
        except LimitReached as reached:
            if self._exceeded is None or length < self._exceeded[0]:
                raise
            _, level, _, limits = self._request
            counted, listed = reached.at_least, self._exceeded[1].completions
            if not prefix and level != "skeleton":  # the listed states are states of plans
                counted = max(counted, count_within(listed, length, limits.begin().to_close().reached_limit)[0])
            raise limit_error(reached.reason, counted, level, length) from None

    def following(self, length: int, prefix: Letters = ()) -> dict[str, int]:
        """Return, for each letter that can follow `prefix`, the number of words that continue with it."""
        return self._answer(length, lambda engine: engine.following(length, prefix))

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a given length in order, lazily."""

        def explored(engine: Engine) -> Engine:
            if engine is self._listing:
                self._listing.known(length)
            return engine

        yield from self._answer(length, explored).words(length, prefix)

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        return self._answer(len(word), lambda engine: engine.contains(word))

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to count - 1."""
        return self._answer(length, lambda engine: engine.unrank(length, rank))

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among the words of its length, or None if it is not a word."""
        return self._answer(len(word), lambda engine: engine.rank(word))

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the weighted words of a given length."""
        return self._answer(length, lambda engine: engine.weighed(length, weights, goals=goals, plain=plain))

    def _answer(self, length: int, ask: Callable[[Engine], Answer]) -> Answer:
        """Return the answer from the automaton engine, or from diagrams if the automaton has too many states."""
        if self._exceeded is None or length < self._exceeded[0]:
            try:
                return ask(self._listing)
            except TooManyStates as error:
                self._exceeded = (length, error.reach)
                _, _, progress, _ = self._request
                if progress:
                    why = f"{error.reach.states:,} states are listed, and {length} steps reach more than memory holds"
                    progress(Note(f"note: engine symbolic, because {why}"))
        if self._diagrams is None:
            from prag_asp.space.engines.symbolic_engine import symbolic_engine

            self._diagrams = symbolic_engine(*self._request)
        return ask(self._diagrams)


def searching_engine(
    model: DomainLogic, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
) -> ClingoEngine:
    """Return the clingo engine, with a parallel model counter if one is installed."""
    from prag_asp.logic.formula.counter import CountBeside, has_counter
    from prag_asp.space.engines.clingo_engine import ClingoEngine
    from prag_asp.space.engines.word_formula import word_formula

    def beside(length: int, prefix: Letters) -> CountBeside:
        def formula() -> tuple[Cnf, Sequence[Literal]]:
            words = word_formula(model, level, length)
            beginning = words.beginning(prefix)
            if beginning is None:
                raise EngineError("no word begins with the prefix")
            return words.cnf, beginning

        def begins() -> None:
            if progress:
                why = f"clingo has not found all words after {PATIENCE:g} s; the first to finish answers"
                progress(Note(f"note: engine sharp as well, because {why}"))

        return CountBeside(formula, PATIENCE, begins)

    return ClingoEngine(model, level, progress, limits, beside if has_counter() else None)
