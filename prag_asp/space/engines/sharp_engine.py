"""The sharp engine: an exact model counter on the unrolled program, for state graphs that are too large to explore.

`estimate_words` uses an approximate counter, for spaces that no engine can count.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import takewhile

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.approximate import Estimate, Tolerance, estimate_models
from prag_asp.logic.formula.counter import count_models, require_counter
from prag_asp.processes.progress_events import stage
from prag_asp.space.engines.engine import Letters, Level, Progress, count_each
from prag_asp.space.engines.sat_engine import SatEngine
from prag_asp.space.engines.word_formula import word_formula
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.weights.weights import Weighed, Weights


class SharpEngine:
    """An engine for one domain at one level that counts the models of a formula.

    It enumerates words with the sat engine, and computes ranks by counting the words with a given prefix.

    Raises:
        EngineError: the model counter is not installed; each query raises this error if the program cannot be
        translated to clauses, or if a count exceeds the time limit.
    """

    def __init__(
        self, model: DomainLogic, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
    ) -> None:
        require_counter()
        self._progress = progress
        self._level = level
        self._limits = limits
        self._sat = SatEngine(model, level, limits=limits)
        self._totals: dict[int, int] = {}

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a given length."""
        if not prefix and length in self._totals:
            return self._totals[length]
        formula = self._sat.formula(length)
        beginning = formula.beginning(prefix)
        if beginning is None:
            return 0
        if self._progress:
            self._progress(f"counting the models of {len(formula.cnf.clauses):,} clauses")
        stage("counting models")
        models = count_models(formula.cnf, beginning, self._limits.begin().left())
        if not prefix:
            self._totals[length] = models
        return models

    def following(self, length: int, prefix: Letters = ()) -> dict[str, int]:
        """Return, for each letter that can follow `prefix`, the number of words that continue with it."""
        return count_each(self, length, prefix)

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a given length in order, lazily."""
        return self._sat.words(length, prefix)

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        return self._sat.contains(word)

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to count - 1, with one model count per step and possible letter."""
        word: Letters = ()
        while len(word) < length:
            for letter in self._sat.formula(length).letters:
                below = (*word, letter)
                if not self._sat.begins(length, below):
                    continue
                skipped = self.count(length, below)
                if rank < skipped:
                    word = below
                    break
                rank -= skipped
        return word

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among the words of its length, or None if it is not a word."""
        length = len(word)
        if not self.contains(word):
            return None
        return sum(
            self.count(length, (*word[:place], smaller))
            for place, letter in enumerate(word)
            for smaller in takewhile(letter.__ne__, self._sat.formula(length).letters)
            if self._sat.begins(length, (*word[:place], smaller))
        )

    @property
    def letters(self) -> Letters:
        """The texts of the letters, in order."""
        return self._sat.letters

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the weighted words of a given length by enumeration, because the counter's weights are not exact."""
        return self._sat.weighed(length, weights, goals=goals)


def estimate_words(
    model: DomainLogic,
    level: Level,
    length: int,
    prefix: Letters,
    tolerance: Tolerance,
    seed: int = 0,
    limits: Limits = UNLIMITED,
) -> Estimate:
    """Return an estimate of the number of words of a given length that begin with a prefix.

    Raises:
        QueryError: the seed is out of range.
        EngineError: ApproxMC is not installed, or the program cannot be translated to clauses.
        LimitReached: the time limit is reached.
    """
    clock = limits.begin()
    formula = word_formula(model, level, length)
    beginning = formula.beginning(prefix)
    if beginning is None:
        return Estimate(0, tolerance)
    stage("estimating the number of models")
    return estimate_models(formula.cnf, tolerance, seed, beginning, clock.left())
