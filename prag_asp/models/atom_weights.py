"""Exact weights of atoms, defined by facts ``weight(Atom, W)``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import prod

import clingo
from clingo.ast import AST, ASTType

from prag_asp.errors import DomainError, QueryError
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.models.answer_set_formula import ModelFormula
from prag_asp.models.ground_program import GroundModels
from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import Program
from prag_asp.wording import did_you_mean, plural

FRACTION = re.compile(r"\d{1,100}(/\d{1,100}|\.\d{1,100})?")
ADVICE = 'write a whole number such as 2, or a fraction such as (1,3) or "0.25"'


@dataclass(frozen=True)
class LiteralWeights:
    """Integer weights of literals; the product over a model's literals, times `scale`, is the weight of the model."""

    weights: dict[Literal, int]
    scale: Fraction


PLAIN = LiteralWeights({}, Fraction(1))
"""The weights with which every model has weight 1."""


def stated_weights(ground: GroundModels, program: Program) -> dict[clingo.Symbol, Fraction]:
    """Return the weights that a program states.

    Raises:
        DomainError: a weight is not a fact, not a number, negative or ambiguous, or all have a wrong arity.
        QueryError: the program states no weight.
    """
    weights: dict[clingo.Symbol, Fraction] = {}
    for symbol, atom in ground.names:
        if not symbol.match("weight", 2) or symbol.negative:
            continue
        weighed, value = symbol.arguments
        if atom not in ground.facts:
            raise DomainError(f"{place_of(symbol, program)}{symbol} depends on other atoms; a weight has to be a fact")
        weight = _fraction(value)
        if weight is None:
            raise DomainError(f"{place_of(symbol, program)}{symbol}: {value} is not a weight; {ADVICE}")
        if weights.setdefault(weighed, weight) != weight:
            raise DomainError(
                f"{place_of(symbol, program)}{symbol}: {weighed} has another weight as well; state only one"
            )
    if not weights:
        for symbol, _ in ground.names:
            if symbol.type == clingo.SymbolType.Function and symbol.name == "weight":
                problem = f"{symbol} has {plural(len(symbol.arguments), 'argument')}, and a weight has 2"
                if symbol.negative:
                    problem = f"{symbol} is negated, so it is not a weight"
                raise DomainError(
                    f"{place_of(symbol, program)}{problem}; write weight(Atom,W), such as weight(in(1),2)"
                )
        raise QueryError("--weighted: the program states no weight; add facts such as weight(in(1),2).")
    return weights


def unknown_weights(stated: Iterable[clingo.Symbol], ground: GroundModels, program: Program) -> str:
    """Return a note on weighted atoms that no rule derives, with the place of the first one, or an empty text."""
    atoms = {symbol for symbol, _ in ground.names}
    missing = sorted(atom for atom in stated if atom not in atoms)
    if not missing:
        return ""
    weights = (symbol for symbol, _ in ground.names if symbol.match("weight", 2) and symbol.arguments[0] == missing[0])
    others = plural(len(missing) - 1, "other weight")
    others_text = f", and {others} {'has' if len(missing) == 2 else 'have'} none either" if len(missing) > 1 else ""
    hint = did_you_mean(str(missing[0]), map(str, atoms), "leave the weight out, or add a rule for the atom")
    problem = f"no rule derives {missing[0]}, so its weight has no effect{others_text}"
    return f"{place_of(next(weights), program)}{problem}; {hint}"


def _fraction(term: clingo.Symbol) -> Fraction | None:
    """Return the weight that a term denotes, or None if it is not a weight."""
    if term.type == clingo.SymbolType.Number:
        return Fraction(term.number) if term.number >= 0 else None
    if term.type == clingo.SymbolType.String:
        denominator = term.string.partition("/")[2]
        is_weight = FRACTION.fullmatch(term.string) and (not denominator or int(denominator))
        return Fraction(term.string) if is_weight else None
    numbers = term.arguments if term.type == clingo.SymbolType.Function and not term.name else []
    if len(numbers) != 2 or any(number.type != clingo.SymbolType.Number for number in numbers):
        return None
    over, under = (number.number for number in numbers)
    return Fraction(over, under) if over >= 0 and under > 0 else None


def projected_away(atom: clingo.Symbol, ground: GroundModels, program: Program) -> QueryError:
    """Return the error about a weighted atom that is not a projection variable."""
    weights = (symbol for symbol, _ in ground.names if symbol.match("weight", 2) and symbol.arguments[0] == atom)
    place = place_of(next(weights), program)
    return QueryError(f"{place}--weighted: {atom} has a weight, but is projected away; show it, or leave it out")


def literal_weights(
    formula: ModelFormula, stated: Mapping[clingo.Symbol, Fraction], ground: GroundModels, program: Program
) -> LiteralWeights:
    """Return the weights of literals; atoms that are impossible are ignored.

    Raises:
        QueryError: equivalent answer sets may have different weights.
    """
    projection = frozenset(formula.cnf.shown)
    weights: dict[Literal, int] = {}
    scale = Fraction(1)
    for symbol, weight in stated.items():
        literal = formula.cnf.literal(symbol)
        if literal == TRUE:
            scale *= weight
        elif literal != -TRUE:
            if abs(literal) not in projection:
                raise projected_away(symbol, ground, program)
            weights[literal] = weights.get(literal, 1) * weight.numerator
            weights[-literal] = weights.get(-literal, 1) * weight.denominator
            scale /= weight.denominator
    return LiteralWeights(weights, scale)


def weight_of(stated: Mapping[clingo.Symbol, Fraction], atoms: Iterator[clingo.Symbol]) -> Fraction:
    """Return the weight of an answer set, given its atoms."""
    return prod((stated[atom] for atom in atoms if atom in stated), start=Fraction(1))


def place_of(symbol: clingo.Symbol, program: Program) -> str:
    """Return the place ``file:line: `` of a rule that may derive an atom, preferably a rule with a matching head.

    The result is empty if no head has the name and arity of the atom.
    """
    statements, _ = parse_sources((source, True) for source in program.sources)
    signature = ("-" * symbol.negative + symbol.name, len(symbol.arguments))
    places = [
        (not all(map(_may_be, head.terms, symbol.arguments)), place, f"{statement.path}:{statement.line}: ")
        for place, statement in enumerate(statements)
        for head in statement.heads
        if head.signature == signature
    ]
    return min(places)[2] if places else ""


def _may_be(term: AST, symbol: clingo.Symbol) -> bool:
    """Return whether a term may match a ground term; computed terms match everything."""
    if term.ast_type == ASTType.SymbolicTerm:
        return bool(term.symbol == symbol)
    if term.ast_type != ASTType.Function or term.external:
        return True
    if symbol.type != clingo.SymbolType.Function or symbol.name != term.name:
        return False
    return len(symbol.arguments) == len(term.arguments) and all(map(_may_be, term.arguments, symbol.arguments))
