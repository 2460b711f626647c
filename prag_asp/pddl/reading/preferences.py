"""Preferences: conditions that a plan need not satisfy, and which are dropped because they exclude no plans."""

from __future__ import annotations

from prag_asp.pddl.reading.pddl_source import PddlSource
from prag_asp.pddl.syntax.expressions import Expression
from prag_asp.pddl.syntax.sections import unsupported

PREFERENCE = "preference"


def without_preferences(source: PddlSource, tree: Expression) -> Expression:
    """Return a condition without its preferences, which may be nested in ``and`` and ``forall``; warn about them."""
    if tree.head == PREFERENCE:
        source.warn(tree.line, "preferences are ignored: plans need not meet them", "ignored")
        return Expression((), tree.line, tree.end)
    if tree.head == "and" or (tree.head == "forall" and len(tree.parts) == 3):
        last = 2 if tree.head == "forall" else 1
        parts = (
            without_preferences(source, part) if isinstance(part, Expression) and place >= last else part
            for place, part in enumerate(tree.parts)
        )
        return Expression(tuple(parts), tree.line, tree.end)
    return tree


def check_constraints(source: PddlSource, section: Expression | None) -> None:
    """Refuse constraints on whole plans that are not preferences."""
    for each in section.rest if section else ():
        found = without_preferences(source, source.list_of([each], each.line))
        conditions = [found]
        while conditions:
            condition = conditions.pop()
            if condition.head == "and":
                conditions += (source.list_of([part], condition.line) for part in condition.rest)
            elif condition.head == "forall" and len(condition.parts) == 3:
                conditions.append(source.list_of(condition.parts[2:], condition.line))
            elif condition.parts:
                source.refuse(condition.line, unsupported(":constraints"))
