"""Effects of one action that may set the same fluent. An atom that an action both adds and deletes becomes true."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prag_asp.pddl.conditions import Vocabulary
from prag_asp.pddl.definitions import DomainFile, ProblemFile, SchemaEffect
from prag_asp.pddl.formulas import Variable, conjuncts


def is_plain(effect: SchemaEffect) -> bool:
    """Return whether an effect has neither a condition nor quantified variables."""
    return not effect.variables and next(conjuncts(effect.condition), None) is None


class ConflictingEffects:
    """Finds effects that may set the same fluent, by the types of their terms."""

    def __init__(self, domain: DomainFile, problem: ProblemFile) -> None:
        self._objects = problem.objects
        self._above = [domain.above(name) for name in domain.types]
        self._overlaps: dict[tuple[tuple[str, ...], tuple[str, ...]], bool] = {}

    def of(self, effect: SchemaEffect, others: Iterable[SchemaEffect]) -> list[SchemaEffect]:
        """Return the effects among others that may set the fluent of an effect."""
        literal = effect.literal
        return [
            each
            for each in others
            if each.literal.predicate == literal.predicate
            and all(map(self._may_be_one, literal.terms, each.literal.terms))
        ]

    def _may_be_one(self, left: Variable | str, right: Variable | str) -> bool:
        if isinstance(left, str) and isinstance(right, str):
            return left == right
        types = self._types(left), self._types(right)
        if types not in self._overlaps:
            first, second = types
            self._overlaps[types] = any(
                not above.isdisjoint(first) and not above.isdisjoint(second) for above in self._above
            )
        return self._overlaps[types]

    def _types(self, term: Variable | str) -> tuple[str, ...]:
        return term.types if isinstance(term, Variable) else (self._objects[term],)


def is_overruled(effect: SchemaEffect, conflicting: Iterable[SchemaEffect]) -> bool:
    """Return whether another effect always adds the fluent that an effect deletes."""
    return any(is_plain(each) and each.literal.terms == effect.literal.terms for each in conflicting)


def differences(words: Vocabulary, effect: SchemaEffect, conflicting: Iterable[SchemaEffect]) -> Iterator[str]:
    """Yield the inequalities that separate a delete effect from each plain add effect of the same action."""
    for other in filter(is_plain, conflicting):
        pairs = zip(effect.literal.terms, other.literal.terms, strict=True)
        unlike = [(words.term(left), words.term(right)) for left, right in pairs if left != right]
        left, right = (",".join(side) for side in zip(*unlike, strict=True))
        yield f"{left} != {right}" if len(unlike) == 1 else f"({left}) != ({right})"
