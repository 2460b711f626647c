"""The clingo engine, the reference: it unrolls all steps and enumerates answer sets, and supports all rules."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from itertools import islice
from time import monotonic
from weakref import WeakValueDictionary

import clingo

from prag_asp.errors import EngineError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.ground.ground_step import unrolled
from prag_asp.processes.progress_events import Note, stage
from prag_asp.processes.workers import uninterrupted
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import OCCURS, STEP_NAME, EncodingPredicate
from prag_asp.program.sources import Program
from prag_asp.space.automaton.walks import words_along
from prag_asp.space.engines.engine import Letters, Level, Progress, all_letters, count_each, name_in_prefix
from prag_asp.space.engines.listed_words import weigh_words
from prag_asp.space.limits import UNLIMITED, LimitClock, Limits, limit_error, within
from prag_asp.space.weights.weights import Weighed, Weights
from prag_asp.stop_reason import StopReason

POLL = 0.2
"""Seconds between two checks of a running solver, so that Ctrl-C takes effect."""


MOST_LISTED, REPORTED = 300_000, 2.0
"""Maximum number of words listed for sampling, at about 4,000 words per second, and seconds between progress reports.
"""

Ask = Callable[[], "int | None"]
"""A function that returns the count that another process computed, or None while that process is running."""

Beside = Callable[[int, Letters], AbstractContextManager[Ask]]
"""A function that starts counting, in parallel with clingo, the words of a given length that begin with a prefix; the
first of the two counts to finish is used."""


class ClingoEngine:
    """The clingo engine for one domain at one level; it caches the ground program for the latest length."""

    def __init__(
        self,
        model: DomainLogic,
        level: Level,
        progress: Progress | None = None,
        limits: Limits = UNLIMITED,
        beside: Beside | None = None,
    ) -> None:
        self._beside: Beside = beside or (lambda length, prefix: nullcontext(lambda: None))
        self._model = model
        self._limits = limits
        self._level = level
        self._progress = progress
        self._unrolled: tuple[int, _UnrolledPlans] | None = None
        self._symbols = all_letters(model, level)
        self.letters = tuple(self._symbols)

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a given length, by enumerating them all.

        Raises:
            LimitReached: a limit ended the search; the error gives the number of words counted so far.
        """
        clock = self._limits.begin()
        plans = self._plans(length)
        assumptions = plans.assume(prefix)
        if assumptions is None:
            return 0
        if self._progress:
            self._progress(f"enumerating answer sets for length {length}")
        stage("enumerating answer sets")
        with self._beside(length, prefix) as ask:
            counted, stop = plans.count(assumptions, clock, ask)
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

        def search() -> Iterator[Letters]:
            plans = self._plans(length)
            stage("searching for words")
            beginning: Letters = ()

            def onward(word: Letters, _: int) -> Iterator[tuple[str, Letters]]:
                return ((letter, (*word, letter)) for letter in plans.following(word, prefix[len(word) :]))

            if length or plans.possible(prefix):
                yield from words_along(beginning, length, onward)

        return within(self._limits, search(), self._level, length)

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        if not all(letter in self.letters for letter in word):
            return False
        return self._plans(len(word)).possible(word)

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to count - 1, by enumerating the words before it."""
        return next(islice(self.words(length), rank, None))

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among the words of its length, or None if it is not a word."""
        return next((rank for rank, other in enumerate(self.words(len(word))) if other == word), None)

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the words of a given length with their weights, by enumerating them all.

        Raises:
            EngineError: there are too many words to list.
            LimitReached: a limit ended the search; the error gives the number of words found so far.
        """
        return weigh_words(self._listed(length), self.letters, self._model, self._level, length, weights, goals)

    def _listed(self, length: int) -> list[Letters]:
        """Return all words of a given length in order, listed in the order of clingo's search for speed."""
        clock = self._limits.begin()
        numbers = {letter: number for number, letter in enumerate(self.letters)}
        words: list[Letters] = []
        stage(f"listing {self._level}s")
        report = self._reports(length)

        def check() -> None:
            report(len(words))
            if stop := clock.reached_limit():
                raise limit_error(stop, len(words), self._level, length)

        for word in self._plans(length).models(check):
            if word is None:  # user-defined encodings may allow steps with no action or with several actions
                return list(self.words(length))
            if len(words) == MOST_LISTED:
                raise EngineError(
                    f"to sample, the engine clingo lists all words, and length {length} has more than {MOST_LISTED:,} "
                    f"{self._level}s; choose a smaller length, or leave out the rule that needs this engine"
                )
            words.append(word)
        return sorted(words, key=lambda word: [numbers[letter] for letter in word])

    def _reports(self, length: int) -> Callable[[int], None]:
        """Return a function that reports the number of listed words every `REPORTED` seconds, first as a note."""
        due, noted = monotonic() + REPORTED, False

        def report(found: int) -> None:
            nonlocal due, noted
            if self._progress is None or monotonic() < due:
                return
            if not noted:
                self._progress(
                    Note(
                        f"note: the engine clingo lists all {self._level}s of length {length}, at most "
                        f"{MOST_LISTED:,}, and has {found:,} after {REPORTED:g} s; ask for a shorter length, or set "
                        "--time"
                    )
                )
            due, noted = monotonic() + REPORTED, True
            self._progress(f"listing {self._level}s of length {length}: {found:,} of at most {MOST_LISTED:,}")

        return report

    def _plans(self, length: int) -> _UnrolledPlans:
        if self._unrolled is None or self._unrolled[0] != length:
            program = self._model.program if self._level == "plan" else self._model.task_program(length)
            shown = STEP_NAME if self._level == "skeleton" else OCCURS
            plans = _in_use.get((id(program), length, shown))
            if plans is None:
                plans = _in_use[id(program), length, shown] = _UnrolledPlans(program, length, shown, self._symbols)
            self._unrolled = (length, plans)
        return self._unrolled[1]


class _UnrolledPlans:
    """The ground program of all plans of one length; queries do not change it."""

    def __init__(
        self, program: Program, length: int, shown: EncodingPredicate, letters: Mapping[str, clingo.Symbol]
    ) -> None:
        self._program = program  # keeps the program alive, so that its id stays unique
        self._shown = shown
        self._letters = letters
        projected = f"{shown.name}(X,t) : {shown.name}(X,t)"
        grounder = Grounder(program, "0", "--project=project")
        self._control = grounder.control
        self._control.add("step", ["t"], f"#project {projected}. #show {shown.name}/{shown.arity}.")
        grounder.ground([("base", [])])
        grounder.ground(unrolled(length))
        self._length = length

    def assume(self, letters: Sequence[str]) -> list[int] | None:
        """Return the literals that assert that a word begins with `letters`, or None if no word does."""
        if len(letters) > self._length:
            return None
        literals = []
        for step, letter in enumerate(letters, 1):
            name = name_in_prefix(letter, self._letters)
            term = self._letters[letter] if name is None else clingo.Function(name)
            symbol = (self._shown if name is None else STEP_NAME)(term, clingo.Number(step))
            atom = self._control.symbolic_atoms[symbol]
            if atom is None:
                return None
            literals.append(atom.literal)
        return literals

    def possible(self, letters: Sequence[str]) -> bool:
        """Return whether any word begins with `letters`."""
        assumptions = self.assume(letters)
        return assumptions is not None and self.satisfiable(assumptions)

    def satisfiable(self, assumptions: Sequence[int]) -> bool:
        """Return whether some answer set satisfies the assumptions."""
        return self._true_literals(assumptions, ()) is not None

    def following(self, word: Letters, prefix: Letters) -> Iterator[str]:
        """Yield, in order and as soon as known, the letters that follow `word` in words that continue with `prefix`.

        Each letter is tried separately. After each failure, twice as many searches as before, starting with one, look
        for any other letters or prove that there are none. Thus n letters take at most n + 1 successful searches, and
        one failed search for each doubling.
        """
        assumptions = self.assume((*word, *prefix))
        if assumptions is None:
            return
        time = clingo.Number(len(word) + 1)
        atoms = self._control.symbolic_atoms
        at_step = ((name, atoms[self._shown(term, time)]) for name, term in self._letters.items())
        literals = {letter: atom.literal for letter, atom in at_step if atom is not None}
        possible: set[int] = set()
        searches, complete = 1, False
        for letter, literal in literals.items():
            if not complete and literal not in possible:
                new = self._true_literals([*assumptions, literal], literals.values())
                if new is not None:
                    possible |= new
                elif searches:
                    complete, searches = self._find_others(assumptions, literals.values(), possible, searches)
            if literal in possible:
                yield letter

    def _find_others(
        self, assumptions: Sequence[int], literals: Collection[int], possible: set[int], searches: int
    ) -> tuple[bool, int]:
        """Add possible literals to `possible`; return whether it is complete, and how many searches to try next time.

        User-defined encodings may allow steps with no action or with several actions; such searches are not continued.
        """
        for _ in range(searches):
            new = self._true_literals([*assumptions, *(-literal for literal in possible)], literals)
            if new is None:
                return True, 0
            possible |= new
            if len(new) != 1:
                return False, 0
        return False, 2 * searches

    def _true_literals(self, assumptions: Sequence[int], literals: Iterable[int]) -> set[int] | None:
        """Return the literals that hold in some answer set under the assumptions, or None if there is none.

        The call is not interruptible because clingo aborts the process if a callback raises an error at the end.
        """
        self._limit(1)
        with uninterrupted(), self._control.solve(assumptions=list(assumptions), yield_=True) as handle:
            model = handle.model()
            return None if model is None else {literal for literal in literals if model.is_true(literal)}

    def models(self, check: Callable[[], None]) -> Iterator[Letters | None]:
        """Yield all words in no particular order, or None for a word with a step that does not have exactly one letter.

        `check` is called regularly; an error that it raises ends the search.
        """
        texts = {term: text for text, term in self._letters.items()}
        self._limit(0)
        with self._control.solve(yield_=True, async_=True) as handle:
            while True:
                handle.resume()
                check()
                while not handle.wait(POLL):
                    check()
                model = handle.model()
                if model is None:
                    return
                atoms = sorted(
                    (atom.arguments[1].number, texts.get(atom.arguments[0], ""))
                    for atom in model.symbols(shown=True)
                    if atom.name == self._shown.name and len(atom.arguments) == self._shown.arity
                )
                steps = [step for step, _ in atoms]
                yield tuple(text for _, text in atoms) if steps == list(range(1, self._length + 1)) else None

    def count(self, assumptions: Sequence[int], clock: LimitClock, ask: Ask) -> tuple[int, StopReason | None]:
        """Return the number of projected answer sets under assumptions, and the limit that was reached, if any.

        If a limit was reached, the number is a lower bound. If `ask` returns a count first, that count is the result.
        """
        self._limit(0)
        stop: StopReason | None = None
        answer: int | None = None
        with self._control.solve(assumptions=list(assumptions), async_=True) as handle:
            try:
                while not handle.wait(POLL):
                    stop, answer = clock.reached_limit(), ask()
                    if stop or answer is not None:
                        handle.cancel()
                        break
            except BaseException:
                handle.cancel()
                raise
            handle.get()
            # Models are numbered; the statistics also contain the number of models, but take milliseconds to read.
            last = handle.last()
        if answer is not None:
            return answer, None
        return last.number if last is not None else 0, stop

    def _limit(self, models: int) -> None:
        solving = self._control.configuration.solve
        assert isinstance(solving, clingo.Configuration)
        solving.models = str(models)


_in_use: WeakValueDictionary[tuple[int, int, EncodingPredicate], _UnrolledPlans] = WeakValueDictionary()
"""The ground programs in use, by program, length and shown predicate; without interchangeable entities, the levels plan
and task share one."""
