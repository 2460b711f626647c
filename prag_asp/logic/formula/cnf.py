"""The plans of a length as a formula in conjunctive normal form, and its DIMACS text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import clingo

from prag_asp.logic.formula.clauses import TRUE, Literal
from prag_asp.logic.formula.completion import complete
from prag_asp.logic.ground.unroll import unroll
from prag_asp.processes.stage import stage
from prag_asp.program.sources import Program


@dataclass(frozen=True)
class Cnf:
    """A formula with exactly one model for each answer set of a program of some steps.

    `literals` has the literal of every atom; the first variable is true, and stands for what holds in all of them.
    `shown` are the variables of the atoms ``occurs(A,t)`` or ``named(N,t)``, sorted: what they tell apart is a word.
    """

    variables: int
    clauses: tuple[tuple[Literal, ...], ...]
    literals: Mapping[clingo.Symbol, Literal]
    shown: tuple[int, ...]

    def literal(self, symbol: clingo.Symbol) -> Literal:
        """Return the literal of an atom; one that no rule speaks of is false."""
        return self.literals.get(symbol, -TRUE)


KEPT, KEPT_CLAUSES = 4, 100_000
"""How many formulas are kept, and of how many clauses in all: tasks and skeletons of a length have the same."""

_kept: dict[tuple[Program, int], Cnf] = {}


def plan_cnf(program: Program, length: int, shown: str = "occurs") -> Cnf:
    """Return the formula of the answer sets with a number of steps, projected on the atoms of a predicate.

    Raises:
        DomainError: clingo cannot ground the program.
        EngineError: the program has no counterpart in clauses.
    """
    key = (program, length)
    cnf = _kept.pop(key, None) or _written(program, length)
    _kept[key] = cnf
    while len(_kept) > KEPT or (_kept and sum(len(each.clauses) for each in _kept.values()) > KEPT_CLAUSES):
        del _kept[next(iter(_kept))]
    words = (literal for symbol, literal in cnf.literals.items() if symbol.match(shown, 2) and abs(literal) != TRUE)
    return replace(cnf, shown=tuple(sorted(words)))


def _written(program: Program, length: int) -> Cnf:
    """Return the formula of the answer sets with a number of steps, which shows nothing."""
    ground = unroll(program, length)
    stage("writing clauses")
    completion = complete(ground.rules)
    literals = {symbol: completion.values.get(atom, -TRUE) for symbol, atom in ground.atoms.items()}
    return Cnf(completion.clauses.variables, tuple(completion.clauses.clauses), literals, ())


def dimacs(cnf: Cnf, comments: Sequence[str] = ()) -> Iterator[str]:
    """Yield the lines of a formula as model counters read it.

    ``c t pmc`` and ``c p show`` ask for projected counting, as in the Model Counting Competition (2021 and later); each
    line ``c V ATOM`` says what variable V stands for.
    """
    yield from (f"c {line}" for line in comments)
    names = {literal: symbol for symbol, literal in cnf.literals.items() if literal != TRUE and literal > 0}
    yield from (f"c {variable} {names[variable]}" for variable in sorted(names))
    yield "c t pmc"
    yield f"p cnf {cnf.variables} {len(cnf.clauses)}"
    yield " ".join(["c p show", *map(str, cnf.shown), "0"])
    yield from (" ".join([*map(str, clause), "0"]) for clause in cnf.clauses)
