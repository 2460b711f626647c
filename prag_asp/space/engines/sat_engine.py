"""The sat engine: a SAT solver on the clauses of the unrolled program, as an independent check of clingo."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import islice

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.clause_builder import TRUE
from prag_asp.logic.formula.solver import Solver
from prag_asp.processes.progress_events import stage
from prag_asp.space.engines.engine import Letters, Level, Progress, all_letters, count_each
from prag_asp.space.engines.listed_words import weigh_words
from prag_asp.space.engines.word_formula import WordFormula, word_formula
from prag_asp.space.limits import UNLIMITED, Limits, limit_error, within
from prag_asp.space.weights.weights import Weighed, Weights

REPORTED = 1000
"""The number of words between two progress reports."""


class SatEngine:
    """The sat engine for one domain at one level; it caches the formula for the latest length.

    Raises:
        EngineError: raised by each query if the program cannot be translated to clauses.
    """

    def __init__(
        self, model: DomainLogic, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
    ) -> None:
        self._model = model
        self._limits = limits
        self._level = level
        self._progress = progress
        self._search: _WordSearch | None = None
        self.letters = tuple(all_letters(model, level))

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a given length, by finding each word and blocking it with a clause.

        Raises:
            LimitReached: a limit ended the search; the error gives the number of words counted so far.
        """
        clock = self._limits.begin()
        counted = 0
        for _ in self._all(length, prefix):
            counted += 1
            if self._progress and counted % REPORTED == 0:
                self._progress(f"{counted:,} {self._level}s found")
            stop = clock.reached_limit()
            if stop:
                raise limit_error(stop, counted, self._level, length)
        return counted

    def following(self, length: int, prefix: Letters = ()) -> dict[str, int]:
        """Return, for each letter that can follow `prefix`, the number of words that continue with it."""
        return count_each(self, length, prefix)

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a given length in order, lazily, by one search for each extension of a prefix.

        Raises:
            LimitReached: a limit ended the search; the error gives the number of words counted so far.
        """
        return within(self._limits, self._searching(length).words(prefix), self._level, length)

    def begins(self, length: int, prefix: Letters) -> bool:
        """Return whether a word of a given length begins with `prefix`."""
        return self._searching(length).some_word(prefix) is not None

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        search = self._searching(len(word))
        return all(letter in search.formula.letters for letter in word) and search.some_word(word) is not None

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to count - 1, by enumerating the words before it."""
        return next(islice(self.words(length), rank, None))

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among the words of its length, or None if it is not a word."""
        if not self.contains(word):
            return None
        return next(rank for rank, other in enumerate(self.words(len(word))) if other == word)

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return all words of a given length, which the solver finds one by one, with their weights."""
        return weigh_words(self.words(length), self.letters, self._model, self._level, length, weights, goals)

    def formula(self, length: int) -> WordFormula:
        """Return the formula whose models are the words of a given length."""
        return self._searching(length).formula

    def _all(self, length: int, prefix: Letters) -> Iterator[Letters]:
        """Yield each word that begins with `prefix` once, in any order; a clause then blocks it.

        A word has one letter at each step, so a clause that excludes one of its letters blocks only this word.
        """
        formula = self.formula(length)
        beginning = formula.beginning(prefix)
        if beginning is None:
            return
        with Solver(formula.cnf.variables, formula.cnf.clauses) as solver:
            while solver.satisfiable(beginning):
                model = solver.model()
                yield formula.word(model)
                solver.add([-TRUE, *(-variable for variable in formula.cnf.shown if model[variable - 1] > 0)])

    def _searching(self, length: int) -> _WordSearch:
        if self._search is None or self._search.formula.length != length:
            self._search = _WordSearch(word_formula(self._model, self._level, length))
            stage("searching for words")
        return self._search


class _WordSearch:
    """A solver for the words of one level and length."""

    def __init__(self, formula: WordFormula) -> None:
        self.formula = formula

    @cached_property
    def _solver(self) -> Solver:
        return Solver(self.formula.cnf.variables, self.formula.cnf.clauses)

    def some_word(self, prefix: Sequence[str]) -> Letters | None:
        """Return a word that begins with `prefix`, or None if there is none."""
        beginning = self.formula.beginning(prefix)
        if beginning is None or not self._solver.satisfiable(beginning):
            return None
        return self.formula.word(self._solver.model())

    def words(self, prefix: Letters) -> Iterator[Letters]:
        """Yield the words that begin with `prefix`, in order."""
        first = self.some_word(prefix)
        if first is None:
            return
        if not first:
            yield first
            return
        ways = [self._ways(0, first, prefix)]
        while ways:
            word = next(ways[-1], None)
            if word is None:
                ways.pop()
            elif len(ways) == len(word):
                yield word
            else:
                ways.append(self._ways(len(ways), word, prefix))

    def _ways(self, place: int, word: Letters, prefix: Letters) -> Iterator[Letters]:
        """Yield a word for each letter that can occur at index `place`, in order of these letters."""
        for letter in self.formula.letters:
            if letter == word[place]:
                yield word
            elif self.formula.fits(letter, prefix[place:]):
                other = self.some_word((*word[:place], letter, *prefix[place + 1 :]))
                if other is not None:
                    yield other
