"""Effects of one action that may speak of the same fluent: what is both added and deleted is added."""

from __future__ import annotations

from collections.abc import Iterable

from prag_asp.pddl.conditions import Vocabulary
from prag_asp.pddl.formula import Variable, conjuncts
from prag_asp.pddl.model import Effect


def is_conditional(effect: Effect) -> bool:
    """Tell whether an effect depends on anything."""
    return next(conjuncts(effect.condition), None) is not None


def may_be_same(effect: Effect, other: Effect) -> bool:
    """Tell whether two effects may speak of the same fluent."""
    one, two = effect.literal, other.literal
    return one.predicate == two.predicate and all(
        left == right or isinstance(left, Variable) or isinstance(right, Variable)
        for left, right in zip(one.terms, two.terms, strict=True)
    )


def told_apart(words: Vocabulary, effect: Effect, rivals: Iterable[Effect]) -> list[str] | None:
    """Return what keeps a deletion from what is added at once, None where it is always added.

    Terms differ; an empty text stands for what has to be looked up, for the rival has variables or conditions.
    """
    found = []
    for rival in rivals:
        pairs = [
            (words.term(left), words.term(right))
            for left, right in zip(effect.literal.terms, rival.literal.terms, strict=True)
            if left != right
        ]
        if rival.variables or is_conditional(rival):
            found.append("")
        elif not pairs:
            return None
        elif len(pairs) == 1:
            found.append(f"{pairs[0][0]} != {pairs[0][1]}")
        else:
            left, right = (",".join(side) for side in zip(*pairs, strict=True))
            found.append(f"({left}) != ({right})")
    return list(dict.fromkeys(found))
