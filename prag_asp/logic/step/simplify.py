"""The simplification of ground bodies for a known action."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from prag_asp.logic.step.normal import RuleBody

Constants = dict[int, bool]
"""Atoms of known truth."""


def simplify(body: RuleBody, constants: Constants) -> RuleBody | bool:
    """Return a body without the literals whose truth is known, or its truth value if these literals determine it."""
    if body.weights:
        return _simplified_sum(body, constants)
    unknown = []
    for literal in body.literals:
        truth = constants.get(abs(literal))
        if truth is None:
            unknown.append(literal)
        elif truth == (literal < 0):
            return False
    if len(unknown) == len(body.literals):
        return body if unknown else True
    return RuleBody(tuple(unknown)) if unknown else True


def _simplified_sum(body: RuleBody, constants: Constants) -> RuleBody | bool:
    bound, literals, weights = body.bound, [], []
    for literal, weight in zip(body.literals, body.weights, strict=True):
        truth = constants.get(abs(literal))
        if truth is None:
            literals.append(literal)
            weights.append(weight)
        elif truth == (literal > 0):
            bound -= weight
    if bound <= 0:
        return True
    if sum(weights) < bound:
        return False
    return RuleBody(tuple(literals), bound, tuple(weights))


def as_bodies(simplified: Iterable[RuleBody | bool]) -> Iterator[RuleBody]:
    """Yield simplified bodies: an empty one for a true body, nothing for a false one."""
    for body in simplified:
        if isinstance(body, RuleBody):
            yield body
        elif body:
            yield RuleBody(())


@dataclass(frozen=True)
class ActionSum:
    """A body that sums weights, split into the part without actions and the weight of each action."""

    bound: int
    literals: tuple[int, ...]
    weights: tuple[int, ...]
    added: Mapping[int, int]

    @classmethod
    def of(cls, body: RuleBody, actions: frozenset[int]) -> ActionSum:
        """Return the split form of a body."""
        pairs = list(zip(body.literals, body.weights, strict=True))
        added: dict[int, int] = {}
        for literal, weight in pairs:
            if abs(literal) in actions:
                added[abs(literal)] = added.get(abs(literal), 0) + (weight if literal > 0 else -weight)
        always = sum(weight for literal, weight in pairs if literal < 0 and -literal in actions)
        rest = [(literal, weight) for literal, weight in pairs if abs(literal) not in actions]
        literals, weights = (tuple(each[i] for each in rest) for i in (0, 1))
        return cls(body.bound - always, literals, weights, added)

    def with_action(self, action: int) -> list[RuleBody]:
        """Return the body for an action: an empty body if it is true, no body if it is false."""
        bound = self.bound - self.added.get(action, 0)
        if bound <= 0:
            return [RuleBody(())]
        return [RuleBody(self.literals, bound, self.weights)] if self.literals else []
