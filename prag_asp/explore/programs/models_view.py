"""The view of a program's answer sets: their number, their facets with exact numbers, the choices and a sample.

Numbers are strings of digits, because JavaScript's numbers are exact only up to 2^53. Shares are decimal strings.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction

import clingo

from prag_asp.errors import QueryError
from prag_asp.explore.plan_view import share
from prag_asp.explore.programs.explored_program import MOST_COMPARED, AtomNumbers, ExploredProgram, ModelsResult
from prag_asp.explore.programs.models_state import ModelsState
from prag_asp.explore.same_result import SameResult
from prag_asp.integers import digits_of
from prag_asp.models.questions.choices import NOT
from prag_asp.models.questions.facets import Narrowing

SHOWN_FACETS = 200
"""The maximum number of facets that a view lists."""

SHOWN_ATOMS = 1000
"""The maximum number of atoms that a view lists as certain, as impossible, or in a sample."""


@dataclass(frozen=True)
class Significance:
    """The share of facets that a choice removes, as a fraction and as a decimal string."""

    exact: str
    share: str


@dataclass(frozen=True)
class AtomFacet:
    """A shown atom that some answer sets contain and others do not, with links that choose and exclude it.

    `count` answer sets contain it, and `excluded` do not; both are empty strings if they are not counted. The
    significances are None if they are not computed.
    """

    atom: str
    count: str
    share: str
    significance: Significance | None
    choose: str
    excluded: str
    significance_of_excluding: Significance | None
    exclude: str


@dataclass(frozen=True)
class Decision:
    """A choice, and the number of answer sets that remain after it; one link returns to it, and one drops only it."""

    literal: str
    count: str
    back: str
    without: str


@dataclass(frozen=True)
class AtomList:
    """Some atoms: the first of them, which are listed, and their total number."""

    number: int
    atoms: tuple[str, ...]


@dataclass(frozen=True)
class ModelsView:
    """What a page shows of a program.

    `total` is the number of answer sets without choices, and `count` is the number with them; a number that could not
    be computed is an empty string, and `problem` says why. `notes` state what counts as an answer set. `open` is the
    number of facets, of which `matching` contain the text to find; the first of them are listed. The atoms in `certain`
    are in all answer sets that remain, and those in `impossible` are in none. `sample` is None without a seed.
    """

    query: str
    title: str
    notes: tuple[str, ...]
    total: str
    count: str
    share: str
    problem: str
    decisions: tuple[Decision, ...]
    undo: str
    open: int
    matching: int
    facets: tuple[AtomFacet, ...]
    certain: AtomList
    impossible: AtomList
    sample: AtomList | None
    same: tuple[SameResult, ...]


@dataclass(frozen=True)
class ModelsConflictView:
    """Lines of the program (``file:line: text``) and choices that together exclude every answer set.

    If `optimal` is true, some answer sets agree with the choices, but none of them is optimal. The set of lines is
    `minimal` unless the solver gave up on a smaller one.
    """

    lines: tuple[str, ...]
    minimal: bool
    optimal: bool
    same: SameResult


def models_view(explored: ExploredProgram, state: ModelsState) -> ModelsView:
    """Return what a page shows of a program.

    Raises:
        PragError: a literal does not fit the program, or a newer request ended this one.
    """
    choices = explored.where(state.where).choices
    state = replace(state, where=tuple(map(str, choices)))
    result, whole = explored.result(state.where), explored.result(())
    known = result.count is not None
    atoms = result.atoms if known else dict.fromkeys(explored.symbols, AtomNumbers(0, None, None))
    decided = {each.symbol for each in choices}
    free = [symbol for symbol, each in atoms.items() if _is_open(symbol, each, result, decided)]
    matching = [symbol for symbol in free if state.find in str(symbol)]
    matching.sort(key=lambda symbol: -_order(state, atoms[symbol]))
    certain = (symbol for symbol, each in atoms.items() if known and each.count == result.count)
    impossible = (symbol for symbol, each in atoms.items() if known and not each.count)
    return ModelsView(
        state.query,
        explored.title,
        tuple(_notes(explored)),
        _digits(whole.count),
        _digits(result.count),
        "" if result.count is None or whole.count is None else share(result.count, whole.count),
        result.problem,
        tuple(_decisions(explored, state)),
        replace(state, where=state.where[:-1], seed=None).query,
        len(free),
        len(matching),
        tuple(_facet(symbol, atoms[symbol], result, state) for symbol in matching[:SHOWN_FACETS]),
        _listed(certain),
        _listed(impossible),
        _sample(explored, state, result),
        tuple(_same(explored, state, known=bool(result.count))),
    )


def models_conflict_view(explored: ExploredProgram, state: ModelsState) -> ModelsConflictView:
    """Return why no answer set agrees with the choices of a page.

    Raises:
        QueryError: a literal does not fit the program, or an answer set remains.
    """
    found = explored.where(state.where)
    if explored.result(state.where).count != 0:
        raise QueryError("nothing excludes every answer set; an answer set may be left")
    conflict = found.explain()
    by_statement = found.project and found.ground.projected is not None
    same = SameResult(
        "why",
        "" if by_statement else _shell("explain", explored.words, state),
        f"{_python(explored, state)}found.explain()",
    )
    if conflict is None:
        return ModelsConflictView((), True, True, same)
    return ModelsConflictView(tuple(map(str, conflict.lines)), conflict.minimal, False, same)


def _is_open(symbol: clingo.Symbol, atom: AtomNumbers, result: ModelsResult, decided: set[clingo.Symbol]) -> bool:
    return symbol not in decided if result.count is None else 0 < atom.count < result.count


def _order(state: ModelsState, atom: AtomNumbers) -> Fraction | int:
    """Return the number by which facets are sorted, largest first; equal ones remain in clingo's order."""
    if state.sort == "share":
        return atom.count
    if state.sort == "significance" and atom.chosen is not None and atom.excluded is not None:
        return max(atom.chosen.of_facets, atom.excluded.of_facets)
    return 0


def _notes(explored: ExploredProgram) -> Iterable[str]:
    answers = explored.answers
    if answers.project:
        by = "shown symbols" if answers.ground.projected is None else "atoms of #project"
        yield f"Answer sets that agree on the {by} count once."
    if answers.optimum is not None:
        yield f"Only optimal answer sets: {answers.optimum}. Choices do not change the optimum."
    if len(explored.symbols) > MOST_COMPARED:
        yield f"There are more than {MOST_COMPARED:,} atoms, so significance is not computed."


def _decisions(explored: ExploredProgram, state: ModelsState) -> Iterable[Decision]:
    for place, literal in enumerate(state.where, 1):
        back, others = state.where[:place], (*state.where[: place - 1], *state.where[place:])
        yield Decision(
            literal,
            _digits(explored.result(back).count),
            replace(state, where=back, seed=None).query,
            replace(state, where=others, seed=None).query,
        )


def _facet(symbol: clingo.Symbol, atom: AtomNumbers, result: ModelsResult, state: ModelsState) -> AtomFacet:
    text, count = str(symbol), result.count
    return AtomFacet(
        text,
        "" if count is None else digits_of(atom.count),
        "" if count is None else share(atom.count, count),
        _significance(atom.chosen),
        state.choosing(text).query,
        "" if count is None else digits_of(count - atom.count),
        _significance(atom.excluded),
        state.choosing(f"{NOT}{text}").query,
    )


def _significance(narrowing: Narrowing | None) -> Significance | None:
    return None if narrowing is None else Significance(_fraction(narrowing.of_facets), _share(narrowing.of_facets))


def _sample(explored: ExploredProgram, state: ModelsState, result: ModelsResult) -> AtomList | None:
    if state.seed is None or not result.count:
        return None
    explored.watch.begin()
    (symbols,) = explored.where(state.where).sample(1, state.seed)
    return _listed(symbols)


def _same(explored: ExploredProgram, state: ModelsState, *, known: bool) -> Iterable[SameResult]:
    python, words = _python(explored, state), (*explored.words, *explored.options)
    yield SameResult("the number", _shell("count", words, state), f"{python}found.count()")
    if known:
        yield SameResult("the facets", _shell("facets", words, state), f"{python}found.facets()")
    if known and state.seed is not None:
        shell = _shell("sample", words, state, "--count", "1", "--seed", str(state.seed))
        yield SameResult("the sample", shell, f"{python}next(found.sample(1, seed={state.seed}))")


def _shell(command: str, words: tuple[str, ...], state: ModelsState, *options: str) -> str:
    choices = (word for text in state.where for word in ("--where", text))
    return shlex.join(["prag-asp", "models", command, *words, *choices, *options])


def _python(explored: ExploredProgram, state: ModelsState) -> str:
    under = f".where({', '.join(map(repr, state.where))})" if state.where else ""
    return f"from prag_asp import answer_sets\nfound = {explored.call}{under}\n"


def _listed(symbols: Iterable[clingo.Symbol]) -> AtomList:
    texts = tuple(map(str, symbols))
    return AtomList(len(texts), texts[:SHOWN_ATOMS])


def _digits(number: int | None) -> str:
    return "" if number is None else digits_of(number)


def _fraction(number: Fraction) -> str:
    return str(number.numerator) if number.denominator == 1 else f"{number.numerator}/{number.denominator}"


def _share(number: Fraction) -> str:
    return share(number.numerator, number.denominator)
