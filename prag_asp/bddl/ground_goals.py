"""Goals without quantifiers: facts with values, and bounds on how many formulas are true.

The quantifiers ``forn``, ``forpairs`` and ``fornpairs`` have the same meaning as in https://github.com/StanfordVL/bddl,
``bddl/condition_evaluation.py``: exactly N objects; and, of each of two classes, at least N objects that are in a pair.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

from prag_asp.atom import Atom
from prag_asp.bddl.bddl_problem import BddlFact, BddlFormula, BddlProblem, Connective, Quantifier

OPPOSITES = {"close": "open", "closed": "open", "turnoff": "turnon"}
"""Predicates of LIBERO, each with its opposite, which is false if and only if it is true."""


@dataclass(frozen=True)
class FactValue:
    """A ground fact that is true, or false if `value` is false."""

    fact: Atom
    value: bool = True

    def __str__(self) -> str:
        return str(self.fact) if self.value else f"not {self.fact}"


@dataclass(frozen=True)
class Threshold:
    """A formula: at least `low` and at most `high` of its parts are true."""

    low: int
    high: int
    parts: tuple[GroundFormula, ...]


GroundFormula: TypeAlias = "FactValue | Threshold"


def every(*parts: GroundFormula) -> GroundFormula:
    """Return the conjunction of formulas, with nested conjunctions flattened and each part only once."""
    flat = dict.fromkeys(inner for part in parts for inner in conjuncts(part))
    return next(iter(flat)) if len(flat) == 1 else Threshold(len(flat), len(flat), tuple(flat))


def some(*parts: GroundFormula) -> GroundFormula:
    """Return the disjunction of formulas, with nested disjunctions flattened and each part only once."""
    flat = dict.fromkeys(inner for part in parts for inner in disjuncts(part))
    return next(iter(flat)) if len(flat) == 1 else Threshold(1, len(flat), tuple(flat))


def negation(formula: GroundFormula) -> GroundFormula:
    """Return the negation of a formula, in which only facts are negated."""
    if isinstance(formula, FactValue):
        return FactValue(formula.fact, not formula.value)
    total, negated = len(formula.parts), tuple(map(negation, formula.parts))
    sides = [
        *([at_least(total - formula.low + 1, negated)] if formula.low > 0 else []),
        *([at_least(formula.high + 1, formula.parts)] if formula.high < total else []),
    ]
    return some(*sides)


def at_least(number: int, parts: tuple[GroundFormula, ...]) -> GroundFormula:
    """Return the formula that at least a given number of parts are true."""
    if number >= len(parts) > 0:
        return every(*parts) if number == len(parts) else some()
    return some(*parts) if number == 1 else Threshold(number, len(parts), parts)


def conjuncts(formula: GroundFormula) -> tuple[GroundFormula, ...]:
    """Return the parts of a conjunction; any other formula is its own only conjunct."""
    if isinstance(formula, Threshold) and formula.low == formula.high == len(formula.parts):
        return formula.parts
    return (formula,)


def disjuncts(formula: GroundFormula) -> tuple[GroundFormula, ...]:
    """Return the parts of a disjunction; any other formula is its own only disjunct."""
    if isinstance(formula, Threshold) and formula.low == 1 and formula.high == len(formula.parts):
        return formula.parts
    return (formula,)


def fact_values(formula: GroundFormula) -> Iterator[FactValue]:
    """Yield the facts of a formula with their values, in order."""
    if isinstance(formula, FactValue):
        yield formula
    else:
        for part in formula.parts:
            yield from fact_values(part)


def is_true(formula: GroundFormula, facts: Set[Atom]) -> bool:
    """Return whether a formula is true if exactly these facts are true."""
    if isinstance(formula, FactValue):
        return (formula.fact in facts) == formula.value
    return formula.low <= sum(is_true(part, facts) for part in formula.parts) <= formula.high


def literal_of(fact: BddlFact, value: bool = True) -> FactValue:
    """Return a ground fact with its value; closed and turned-off are stated as not open and not turned on."""
    opposite = OPPOSITES.get(fact.predicate)
    return FactValue(Atom(opposite or fact.predicate, fact.terms), value if opposite is None else not value)


def ground_goal(problem: BddlProblem) -> GroundFormula:
    """Return the goal of a problem, ground over its objects and fixtures."""
    members: dict[str, list[str]] = {}
    for name, of_class in problem.classes.items():
        members.setdefault(of_class, []).append(name)
    return _ground(problem.goal, {}, members)


def _ground(formula: BddlFormula, scope: Mapping[str, str], members: Mapping[str, list[str]]) -> GroundFormula:
    """Replace the free variables of a formula with the objects in `scope`; `members` maps each class to its objects."""
    if isinstance(formula, BddlFact):
        terms = tuple(scope[term[1:]] if term.startswith("?") else term for term in formula.terms)
        return literal_of(BddlFact(formula.predicate, terms))
    if isinstance(formula, Connective):
        parts = [_ground(part, scope, members) for part in formula.parts]
        return CONNECTIVES[formula.kind](*parts)
    names = [name for name, _ in formula.variables]
    objects = [members.get(of_class, []) for _, of_class in formula.variables]

    def part_with(*chosen: str) -> GroundFormula:
        return _ground(formula.part, {**scope, **dict(zip(names, chosen, strict=True))}, members)

    if formula.kind in ("forpairs", "fornpairs"):
        return _pairs(formula, objects, part_with)
    parts = [part_with(*chosen) for chosen in product(*objects)]
    if formula.number is None:
        return every(*parts) if formula.kind == "forall" else some(*parts)
    return _exactly(formula.number, tuple(parts))


def _exactly(number: int, parts: tuple[GroundFormula, ...]) -> GroundFormula:
    if number > len(parts):
        return some()
    return every(*parts) if number == len(parts) else Threshold(number, number, parts)


def _pairs(
    formula: Quantifier, objects: list[list[str]], part_with: Callable[[str, str], GroundFormula]
) -> GroundFormula:
    """Return a formula that enough objects of each class are in a pair; an object does not pair with itself."""
    first, second = objects
    number = min(len(first), len(second)) if formula.number is None else formula.number
    rows = tuple(some(*(part_with(one, other) for other in second if one != other)) for one in first)
    columns = tuple(some(*(part_with(one, other) for one in first if one != other)) for other in second)
    return every(at_least(number, rows), at_least(number, columns)) if number else every()


CONNECTIVES: Mapping[str, Callable[..., GroundFormula]] = {
    "and": every,
    "or": some,
    "not": negation,
    "imply": lambda condition, result: some(negation(condition), result),
}
