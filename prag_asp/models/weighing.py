"""Exact weights of atoms, which a program states by facts ``weight(Atom, W)``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import prod

import clingo

from prag_asp.errors import DomainError, QueryError
from prag_asp.logic.formula.clauses import TRUE, Literal
from prag_asp.models.formula import ModelFormula
from prag_asp.models.ground import GroundModels

FRACTION = re.compile(r"\d{1,100}(/\d{1,100}|\.\d{1,100})?")
ADVICE = 'write a whole number such as 2, or a fraction such as (1,3) or "0.25"'


@dataclass(frozen=True)
class LiteralWeights:
    """Whole numbers for literals; the weight of a model is their product, times `scale`."""

    weights: dict[Literal, int]
    scale: Fraction


PLAIN = LiteralWeights({}, Fraction(1))
"""All models are alike."""


def stated_weights(ground: GroundModels) -> dict[clingo.Symbol, Fraction]:
    """Return the weights that a program states.

    Raises:
        DomainError: one depends on a choice, is no number or negative, or an atom has two.
        QueryError: there is none.
    """
    found: dict[clingo.Symbol, Fraction] = {}
    for symbol, atom in ground.names:
        if not symbol.match("weight", 2) or symbol.negative:
            continue
        weighed, given = symbol.arguments
        if atom not in ground.facts:
            raise DomainError(f"{symbol}: it depends on other atoms; a weight has to be a fact")
        weight = _fraction(given)
        if weight is None:
            raise DomainError(f"{symbol}: {given} is no weight; {ADVICE}")
        if found.setdefault(weighed, weight) != weight:
            raise DomainError(f"{symbol}: {weighed} has another weight too; state one")
    if not found:
        raise QueryError("--weighted: the program states no weight; add facts such as weight(in(1),2).")
    return found


def _fraction(term: clingo.Symbol) -> Fraction | None:
    """Return the weight that a term states, None where it states none."""
    if term.type == clingo.SymbolType.Number:
        return Fraction(term.number) if term.number >= 0 else None
    if term.type == clingo.SymbolType.String:
        return _read(term.string)
    numbers = term.arguments if term.type == clingo.SymbolType.Function and not term.name else []
    if len(numbers) != 2 or any(each.type != clingo.SymbolType.Number for each in numbers):
        return None
    over, under = (each.number for each in numbers)
    return Fraction(over, under) if over >= 0 and under > 0 else None


def _read(text: str) -> Fraction | None:
    if not FRACTION.fullmatch(text):
        return None
    try:
        return Fraction(text)
    except ZeroDivisionError:
        return None


def literal_weights(formula: ModelFormula, stated: Mapping[clingo.Symbol, Fraction]) -> LiteralWeights:
    """Return the weights of literals; an atom that no answer set can have weighs on none.

    Raises:
        QueryError: answer sets that count as one may have different weights.
    """
    telling = frozenset(formula.cnf.shown)
    weights: dict[Literal, int] = {}
    scale = Fraction(1)
    for symbol, weight in stated.items():
        literal = formula.cnf.literal(symbol)
        if literal == TRUE:
            scale *= weight
        elif literal != -TRUE:
            if abs(literal) not in telling:
                raise QueryError(f"--weighted: {symbol} has a weight, but is projected away; show it, or leave it out")
            weights[literal] = weights.get(literal, 1) * weight.numerator
            weights[-literal] = weights.get(-literal, 1) * weight.denominator
            scale /= weight.denominator
    return LiteralWeights(weights, scale)


def weight_of(stated: Mapping[clingo.Symbol, Fraction], atoms: Iterator[clingo.Symbol]) -> Fraction:
    """Return the weight of an answer set by its atoms."""
    return prod((stated[atom] for atom in atoms if atom in stated), start=Fraction(1))
