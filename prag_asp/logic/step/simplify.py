"""What is left of ground bodies where it is known which action occurs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from prag_asp.logic.step.normal import Body

Constants = dict[int, bool]
"""Atoms of known truth."""


def simplified(body: Body, constants: Constants) -> Body | bool:
    """Return a body without its literals of known truth, or its truth where that decides it."""
    if body.weights:
        return _simplified_sum(body, constants)
    unknown = []
    for literal in body.literals:
        known = constants.get(abs(literal))
        if known is None:
            unknown.append(literal)
        elif known == (literal < 0):
            return False
    if len(unknown) == len(body.literals):
        return body if unknown else True
    return Body(tuple(unknown)) if unknown else True


def _simplified_sum(body: Body, constants: Constants) -> Body | bool:
    bound, literals, weights = body.bound, [], []
    for literal, weight in zip(body.literals, body.weights, strict=True):
        known = constants.get(abs(literal))
        if known is None:
            literals.append(literal)
            weights.append(weight)
        elif known == (literal > 0):
            bound -= weight
    if bound <= 0:
        return True
    if sum(weights) < bound:
        return False
    return Body(tuple(literals), bound, tuple(weights))


def as_bodies(left: Iterable[Body | bool]) -> Iterator[Body]:
    """Yield what is left of bodies, an empty one for what is true, and none for what is false."""
    for body in left:
        if isinstance(body, Body):
            yield body
        elif body:
            yield Body(())


@dataclass(frozen=True)
class ActionSum:
    """A body that sums weights: what is left of it without actions, and what each action adds."""

    bound: int
    literals: tuple[int, ...]
    weights: tuple[int, ...]
    added: Mapping[int, int]

    @classmethod
    def of(cls, body: Body, actions: frozenset[int]) -> ActionSum:
        """Return a body taken apart."""
        pairs = list(zip(body.literals, body.weights, strict=True))
        added: dict[int, int] = {}
        for literal, weight in pairs:
            if abs(literal) in actions:
                added[abs(literal)] = added.get(abs(literal), 0) + (weight if literal > 0 else -weight)
        always = sum(weight for literal, weight in pairs if literal < 0 and -literal in actions)
        rest = [(literal, weight) for literal, weight in pairs if abs(literal) not in actions]
        literals, weights = (tuple(each[i] for each in rest) for i in (0, 1))
        return cls(body.bound - always, literals, weights, added)

    def with_action(self, action: int) -> list[Body]:
        """Return what is left of the body where an action occurs: an empty body where it is true, none where false."""
        bound = self.bound - self.added.get(action, 0)
        if bound <= 0:
            return [Body(())]
        return [Body(self.literals, bound, self.weights)] if self.literals else []
