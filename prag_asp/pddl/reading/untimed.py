"""Durative actions, turned into instantaneous ones with the effect of running from start to end without overlap.

The effects at the start come first. The conditions over all and at the end are read in the state after these effects,
so they are regressed over the effects at the start (Reiter 1991). The effects at the end come last, and override the
other effects. A condition at the start of an effect at the end is read before all effects.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from prag_asp.pddl.definitions import NumericEffect, Schema, SchemaEffect
from prag_asp.pddl.formulas import (
    Comparison,
    Equality,
    Formula,
    Junction,
    Literal,
    Quantified,
    function_terms,
    literals,
    negated,
    subformulas,
)
from prag_asp.pddl.reading.pddl_source import PddlSource


class EarlyCondition(Junction):
    """The part of the condition of an effect at the end that is read at the start."""


def untimed_schema(
    source: PddlSource,
    schema: Schema,
    derived: frozenset[str],
    conditions: tuple[Formula, Formula],
    effects: Sequence[Sequence[SchemaEffect | NumericEffect]],
) -> Schema:
    """Return an instantaneous action, given a durative one's conditions and effects at its start and its end.

    Raises:
        DomainError: a condition at the end reads a derived predicate, although there are effects at the start.
    """
    first, last = ([each for each in part if isinstance(each, SchemaEffect)] for part in effects)
    ended = [each for each in effects[1] if isinstance(each, NumericEffect)]
    later = [conditions[1], *(_without_early(each.condition) for each in effects[1])]
    for literal in literals(Junction(True, tuple(later), schema.line)):
        if first and literal.predicate in derived:
            text = f"{literal.predicate} is derived, and read after effects at the start"
            source.refuse(literal.line, f"{text}; read it at the start, or write its rule out")

    started = {each.function.function for each in effects[0] if isinstance(each, NumericEffect)}
    quantities = [
        side
        for formula in later
        for part in subformulas(formula)
        if isinstance(part, Comparison)
        for side in (part.left, part.right)
    ]
    for quantity in (*quantities, *(each.value for each in ended)):
        for term in function_terms(quantity):
            if term.function in started:
                text = f"{term.function} changes at the start, and is read after it"
                source.refuse(schema.line, f"{text}; read it at the start, or change it at the end")

    last = [replace(each, condition=_before(each.condition, first)) for each in last]
    ended = [replace(each, condition=_before(each.condition, first)) for each in ended]
    kept = []
    for each in first:
        opposed = (each.literal.predicate, not each.literal.positive)
        opposite = (other for other in last if (other.literal.predicate, other.literal.positive) == opposed)
        overruled = [_made(each.literal, other) for other in opposite]
        guard = (each.condition, *(map(negated, overruled) if each.literal.positive else ()))
        kept.append(replace(each, condition=Junction(True, guard, each.literal.line)))
    return replace(
        schema,
        precondition=Junction(True, (conditions[0], _before(conditions[1], first)), schema.line),
        effects=(*kept, *last),
        numeric=(*(each for each in effects[0] if isinstance(each, NumericEffect)), *ended),
    )


def _without_early(formula: Formula) -> Formula:
    """Return a condition without the parts that are read at the start."""
    if isinstance(formula, Junction):
        parts = () if isinstance(formula, EarlyCondition) else tuple(map(_without_early, formula.parts))
        return Junction(formula.every, parts, formula.line)
    return replace(formula, part=_without_early(formula.part)) if isinstance(formula, Quantified) else formula


def _before(formula: Formula, effects: Sequence[SchemaEffect]) -> Formula:
    """Return the condition before the effects at the start that is equivalent to one after them."""
    if isinstance(formula, Junction):
        is_early = isinstance(formula, EarlyCondition)
        parts = formula.parts if is_early else tuple(_before(each, effects) for each in formula.parts)
        return Junction(formula.every, parts, formula.line)
    if isinstance(formula, Quantified):
        return replace(formula, part=_before(formula.part, effects))
    return _regressed(formula, effects) if isinstance(formula, Literal) else formula


def _made(literal: Literal, effect: SchemaEffect) -> Formula:
    """Return the condition under which an effect changes the atom of a literal."""
    pairs = zip(literal.terms, effect.literal.terms, strict=True)
    same = tuple(Equality(one, other, True, literal.line) for one, other in pairs if one != other)
    part = Junction(True, (effect.condition, *same), literal.line)
    return Quantified(False, effect.variables, part, literal.line) if effect.variables else part


def _regressed(literal: Literal, effects: Iterable[SchemaEffect]) -> Formula:
    """Return the condition that must hold before the given effects for a literal to hold after them."""
    same = [each for each in effects if each.literal.predicate == literal.predicate]
    if not same:
        return literal
    added = (_made(literal, each) for each in same if each.literal.positive)
    deleted = (negated(_made(literal, each)) for each in same if not each.literal.positive)
    stays = Junction(True, (replace(literal, positive=True), *deleted), literal.line)
    holds = Junction(False, (*added, stays), literal.line)
    return holds if literal.positive else negated(holds)
