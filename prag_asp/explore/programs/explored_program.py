"""A program whose answer sets pages explore: counts and facets under choices, within a time limit for each view."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import clingo

from prag_asp.errors import LimitReached, NotFound
from prag_asp.explore.explored_domain import Cache
from prag_asp.models.answer_sets import AnswerSets
from prag_asp.models.questions.choices import conditions_of_symbols
from prag_asp.models.questions.facets import Facet, Narrowing
from prag_asp.space.limits import UNLIMITED, LimitClock, Limits
from prag_asp.stop_reason import StopKind

SECONDS = 60.0
"""The time limit of counting for a view, in seconds."""

RESULTS = 256
"""The number of results that are cached."""

MOST_COMPARED = 2000
"""The maximum number of atoms for which significance is computed, because the cost grows with their number and the size
of the diagram.
"""


class Watch:
    """The limits of the view that is being computed; `look` is called periodically."""

    def __init__(self, limits: Limits = UNLIMITED) -> None:
        self._limits = replace(limits, since=None, seconds=limits.seconds or SECONDS)
        self._clock: LimitClock = self._limits.begin()

    def begin(self) -> None:
        """Start the clock for a view."""
        self._clock = self._limits.begin()

    def look(self, words: str = "") -> None:
        """Check the limits; the text of a progress report is ignored.

        Raises:
            LimitReached: a limit is reached.
        """
        reason = self._clock.reached_limit()
        if reason is not None:
            raise LimitReached(
                f"{reason.prose()} was reached before the answer sets were counted; choose or exclude an atom",
                0,
                reason,
            )


@dataclass(frozen=True)
class AtomNumbers:
    """The number of answer sets with an atom and, if computed, how much each choice about the atom reduces this set."""

    count: int
    chosen: Narrowing | None
    excluded: Narrowing | None


@dataclass(frozen=True)
class ModelsResult:
    """The number of answer sets under choices, and the numbers of each shown atom.

    If there are no answer sets, there are no atoms. If a limit was reached, `count` is None and `problem` says which
    limit.
    """

    count: int | None
    atoms: Mapping[clingo.Symbol, AtomNumbers]
    problem: str = ""


@dataclass
class ExploredProgram:
    """The answer sets of a program; `answers` must report progress to `watch`.

    `words` are the arguments that name the program on a command line, `options` are those of ``prag-asp models``, and
    `call` is the code that reads the program in Python; they are shown beside each view.
    """

    title: str
    answers: AnswerSets
    words: tuple[str, ...]
    options: tuple[str, ...]
    call: str
    watch: Watch = field(default_factory=Watch)
    _results: Cache = field(default_factory=lambda: Cache(RESULTS))
    _too_hard: str = ""

    @property
    def symbols(self) -> tuple[clingo.Symbol, ...]:
        """The symbols that answer sets may show."""
        return tuple(conditions_of_symbols(self.answers.ground, project=self.answers.project))

    def where(self, literals: tuple[str, ...]) -> AnswerSets:
        """Return the answer sets that agree with the given literals.

        Raises:
            QueryError: a text is not a literal, or no answer set can show its symbol.
        """
        return self.answers.where(*literals)

    def result(self, literals: tuple[str, ...]) -> ModelsResult:
        """Return the counts under the given literals.

        All choices share the diagram of the whole program. If compiling this diagram takes too long, the program under
        the choices is compiled, which may be easier.

        Raises:
            QueryError: a text is not a literal, or no answer set can show its symbol.
            LimitReached: a newer request ended this one.
        """
        found = self.where(literals)
        return self._results.get(found.choices, lambda: self._computed(found))

    def _computed(self, found: AnswerSets) -> ModelsResult:
        self._too_hard = problem = self._too_hard or self._compile(self.answers)
        if problem and found.choices:
            problem = self._compile(found)
        if problem:
            return ModelsResult(None, {}, problem)
        try:
            return _numbers(found)
        except LimitReached as error:
            return ModelsResult(None, {}, _problem(error))

    def _compile(self, found: AnswerSets) -> str:
        """Compile a diagram if there is one, and return the limit that was reached, or ""."""
        self.watch.begin()
        try:
            self.watch.look()
            found.compile(self.watch.look)
        except LimitReached as error:
            return _problem(error)
        return ""


def _problem(error: LimitReached) -> str:
    """Return the message about a limit; raise the error if a newer request is the reason."""
    if error.reason.kind is StopKind.CANCEL:
        raise error
    return str(error)


def _numbers(found: AnswerSets) -> ModelsResult:
    count = found.count()
    try:
        if len(conditions_of_symbols(found.ground, project=found.project)) > MOST_COMPARED:
            shares = {symbol: Facet(share, None, None) for symbol, share in found.marginals().items()}
        else:
            shares = found.facets()
    except NotFound:
        return ModelsResult(0, {})
    return ModelsResult(
        count,
        {symbol: AtomNumbers(int(each.share * count), each.chosen, each.excluded) for symbol, each in shares.items()},
    )
