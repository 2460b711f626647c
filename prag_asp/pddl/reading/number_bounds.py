"""Bounds for numbers that actions change, if an atom records each change that another action may undo.

If each action that decreases f(z) by w(y) requires and deletes p(y,z), and each action that adds p(y,z) increases f(z)
by w(y), then f(z) minus the sum of w over the true atoms p(_,z) never decreases. The sum is not negative, so f(z) never
falls below the initial difference. With the signs exchanged, the same holds for upper bounds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from prag_asp.pddl.definitions import NumericEffect, ProblemFile, Schema, SchemaEffect
from prag_asp.pddl.formulas import Arithmetic, FunctionTerm, Literal, Quantity, Variable, conjuncts, demanded

SIGNS: Mapping[str, int] = {"increase": 1, "decrease": -1}


class ValueBounds(NamedTuple):
    """The least and the greatest value of a function; None stands for an unknown bound."""

    least: Fraction | None
    most: Fraction | None

    def hold(self, value: Fraction) -> bool:
        """Return whether a value lies within these bounds."""
        return not (self.least is not None and value < self.least) and not (self.most is not None and value > self.most)


@dataclass(frozen=True)
class _RememberedChange:
    """A predicate that records changes to a function, and the positions of the function's terms in its arguments.

    `weight` is the size of a change: a number, or a function and the arguments of the predicate that are its terms.
    """

    predicate: str
    function_terms: tuple[int, ...]
    weight: Fraction | tuple[str, tuple[int, ...]]

    def agrees(self, effect: NumericEffect, terms: tuple[Variable | str, ...]) -> bool:
        """Return whether a change has the terms and the size that an atom records."""
        if isinstance(self.weight, Fraction):
            size: Quantity = self.weight
        else:
            size = FunctionTerm(self.weight[0], tuple(terms[place] for place in self.weight[1]))
        return effect.value == size and effect.function.terms == tuple(terms[place] for place in self.function_terms)


def value_bounds(function: str, actions: Sequence[Schema], problem: ProblemFile, changing: set[str]) -> ValueBounds:
    """Return the bounds that the initial state and the actions imply for the values of a function."""
    changes = [(action, each) for action in actions for each in action.numeric if each.function.function == function]
    names = [action.name for action, _ in changes]
    plain = all(is_unconditional(each) and each.operator in SIGNS for _, each in changes) and len(set(names)) == len(
        names
    )
    sizes_known = all(_is_positive(each.value, problem, changing) for _, each in changes)
    if not plain or not sizes_known:
        return ValueBounds(None, None)
    stated = {terms: value for (name, terms), value in problem.values.items() if name == function}
    bounds: list[Fraction | None] = []
    for sign in (1, -1):
        memory = next((each for each in _memories(changes, sign) if _is_kept(each, function, actions, sign)), None)
        if memory is None or not stated:
            bounds.append(None)
            continue
        first = (sign * value - _remembered(memory, terms, problem) for terms, value in stated.items())
        bounds.append(sign * min(first))
    return ValueBounds(*bounds)


def is_unconditional(effect: NumericEffect | SchemaEffect) -> bool:
    """Return whether an effect has neither a condition nor quantified variables."""
    return not effect.variables and next(conjuncts(effect.condition), None) is None


def _is_positive(value: Quantity, problem: ProblemFile, changing: set[str]) -> bool:
    """Return whether a quantity is a nonnegative number, or a constant function with a nonnegative value."""
    if isinstance(value, Fraction):
        return value >= 0
    if not isinstance(value, FunctionTerm) or value.function in changing:
        return False
    return all(number >= 0 for (name, _), number in problem.values.items() if name == value.function)


def _memories(changes: Sequence[tuple[Schema, NumericEffect]], sign: int) -> Iterator[_RememberedChange]:
    """Yield predicates that may record changes with the opposite sign, inferred from the first such change."""
    taking = next(((action, each) for action, each in changes if SIGNS[each.operator] == -sign), None)
    if taking is None:
        return
    action, effect = taking
    for literal in demanded(action.precondition):
        places = {term: place for place, term in enumerate(literal.terms)}
        value = effect.value
        needed = (*effect.function.terms, *(value.terms if isinstance(value, FunctionTerm) else ()))
        if all(term in places for term in needed):
            weight = (
                (value.function, tuple(places[term] for term in value.terms))
                if isinstance(value, FunctionTerm)
                else value
            )
            assert not isinstance(weight, Arithmetic)
            yield _RememberedChange(literal.predicate, tuple(places[term] for term in effect.function.terms), weight)


def _is_kept(memory: _RememberedChange, function: str, actions: Sequence[Schema], sign: int) -> bool:
    """Return whether actions keep a record correct: a new atom comes with its change, a reverse change deletes one."""
    for action in actions:
        change = next((each for each in action.numeric if each.function.function == function), None)
        added = [
            each for each in action.effects if each.literal.predicate == memory.predicate and each.literal.positive
        ]
        taken = change is not None and SIGNS[change.operator] == -sign
        if added and (
            len(added) > 1
            or change is None
            or taken
            or added[0].variables
            or not memory.agrees(change, added[0].literal.terms)
        ):
            return False
        if (
            taken
            and change is not None
            and not any(memory.agrees(change, literal.terms) for literal in _lost(action, memory.predicate))
        ):
            return False
    return True


def _lost(action: Schema, predicate: str) -> Iterator[Literal]:
    """Yield the atoms of a predicate that an action requires and deletes."""
    deleted = {
        each.literal.terms
        for each in action.effects
        if is_unconditional(each) and not each.literal.positive and each.literal.predicate == predicate
    }
    return (each for each in demanded(action.precondition) if each.predicate == predicate and each.terms in deleted)


def _remembered(memory: _RememberedChange, terms: tuple[str, ...], problem: ProblemFile) -> Fraction:
    """Return the sum of the changes to a function term that the initial atoms record."""
    total = Fraction(0)
    for atom in {tuple(map(str, each.terms)) for each in problem.initial if each.predicate == memory.predicate}:
        if tuple(atom[place] for place in memory.function_terms) == terms:
            if isinstance(memory.weight, Fraction):
                total += memory.weight
            else:
                name, places = memory.weight
                total += problem.values.get((name, tuple(atom[place] for place in places)), Fraction(0))
    return total
