"""Effects of one action that may speak of the same fluent: what is both added and deleted is added."""

from __future__ import annotations

from collections.abc import Iterable

from prag_asp.pddl.conditions import Vocabulary
from prag_asp.pddl.formula import Variable, conjuncts
from prag_asp.pddl.model import DomainFile, Effect, ProblemFile


def is_conditional(effect: Effect) -> bool:
    """Tell whether an effect depends on anything."""
    return next(conjuncts(effect.condition), None) is not None


class Rivals:
    """Finds effects that may speak of the same fluent, by the types of their terms."""

    def __init__(self, domain: DomainFile, problem: ProblemFile) -> None:
        self._objects = problem.objects
        self._above = [domain.above(name) for name in domain.types]
        self._known: dict[tuple[tuple[str, ...], tuple[str, ...]], bool] = {}

    def of(self, effect: Effect, others: Iterable[Effect]) -> list[Effect]:
        """Return which of some other effects may speak of the fluent of an effect."""
        found = effect.literal
        return [
            each
            for each in others
            if each.literal.predicate == found.predicate and all(map(self._may_be_one, found.terms, each.literal.terms))
        ]

    def _may_be_one(self, left: Variable | str, right: Variable | str) -> bool:
        if isinstance(left, str) and isinstance(right, str):
            return left == right
        types = self._types(left), self._types(right)
        if types not in self._known:
            first, second = types
            self._known[types] = any(
                not above.isdisjoint(first) and not above.isdisjoint(second) for above in self._above
            )
        return self._known[types]

    def _types(self, term: Variable | str) -> tuple[str, ...]:
        return term.types if isinstance(term, Variable) else (self._objects[term],)


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
