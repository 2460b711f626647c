"""Nondeterministic effects (``oneof``), turned into separate actions, one for each outcome.

This is the all-outcomes determinization (Yoon, Fern and Givan 2007), whose plans are sequences of actions with outcomes
that lead to the goal.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product
from math import prod

from prag_asp.pddl.reading.pddl_source import PddlSource
from prag_asp.pddl.syntax.expressions import Expression, Word
from prag_asp.wording import plural

ONE_OF = "oneof"

MOST_OUTCOMES = 1000
"""The maximum number of outcomes of an action, because each becomes a separate action."""


def outcomes(source: PddlSource, effect: Expression) -> list[Expression]:
    """Return the outcomes of an effect, as effects without ``oneof``, or the effect itself if it has no ``oneof``.

    Raises:
        DomainError: there are too many outcomes, or their number depends on objects or on the state.
    """
    if _number(source, effect) > MOST_OUTCOMES:
        text = f"this effect has more than {MOST_OUTCOMES:,} outcomes; divide them among several actions"
        source.refuse(effect.line, text)
    return [*_outcomes(effect)]


def chosen_effect(parts: Iterable[Expression | Word]) -> Word | None:
    """Return the first ``oneof`` in an effect, or None if there is none."""
    return next((each for part in parts for each in words_of(part) if each == ONE_OF), None)


def words_of(part: Expression | Word) -> Iterator[Word]:
    """Return the words in a part of an expression."""
    return iter([part]) if isinstance(part, Word) else part.all_words


def _number(source: PddlSource, effect: Expression) -> int:
    parts = [each for each in effect.parts if isinstance(each, Expression)]
    if effect.head in ("when", "forall") and (word := chosen_effect(parts)):
        text = f"{ONE_OF} below '{effect.head}' has outcomes that depend on more than the action"
        source.refuse(word.line, f"{text}; write '{effect.head}' below {ONE_OF}")
    numbers = [_number(source, each) for each in parts]
    if effect.head != ONE_OF:
        return prod(numbers)
    if len(numbers) < len(effect.rest) or not numbers:
        found = plural(len(numbers), "effect")
        source.refuse(effect.line, f"{ONE_OF} has {found} and something else; write one (...) for each outcome")
    return sum(numbers)


def _outcomes(effect: Expression) -> Iterator[Expression]:
    if chosen_effect(effect.parts) is None:
        yield effect
    elif effect.head == ONE_OF:
        for part in effect.rest:
            if isinstance(part, Expression):
                yield from _outcomes(part)
    else:
        choices: list[list[Expression | Word]] = []
        for each in effect.parts:
            choices.append([*_outcomes(each)] if isinstance(each, Expression) else [each])
        for parts in product(*choices):
            yield Expression(parts, effect.line, effect.end)
