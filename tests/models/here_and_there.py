"""The answer sets of small ground programs with conditional literals, by the logic of here-and-there.

A conditional literal ``H : C`` of a body means that C implies H. The head of a rule is a disjunction: a conditional
literal in it means that C implies H, and that C is true (Ferraris and Lifschitz 2005; clingo translates them so). An
answer set is a total model (Y, Y) without a smaller model (X, Y).
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, combinations

ATOMS = "abcd"

Value = tuple[bool, bool]
"""Whether a formula is true here, and there."""


@dataclass(frozen=True)
class Conditional:
    """A literal, such as ``not a``, under conditions."""

    literal: str
    conditions: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.literal}: {', '.join(self.conditions)}" if self.conditions else self.literal


@dataclass(frozen=True)
class ConditionalRule:
    """A rule with a disjunction or, with `choice`, a choice of one atom as its head."""

    heads: tuple[Conditional, ...]
    body: tuple[Conditional, ...]
    choice: bool = False

    def __str__(self) -> str:
        head, body = "; ".join(map(str, self.heads)), "; ".join(map(str, self.body))
        return f"{{{head}}} :- {body}." if self.choice else f"{head} :- {body}."

    def holds(self, here: frozenset[str], there: frozenset[str]) -> bool:
        """Return whether an interpretation is a model of the rule."""

        def value(literal: str) -> Value:
            atom = literal.removeprefix("not ")
            if atom != literal:
                return atom not in there, atom not in there
            return atom in here, atom in there

        def implied(each: Conditional) -> Value:
            return _implies(_all(map(value, each.conditions)), value(each.literal))

        body = _all(map(implied, self.body))
        if self.choice:
            head = _any([value(self.heads[0].literal), value(f"not {self.heads[0].literal}")])
        else:
            truths = (_all(map(value, each.conditions))[1] for each in self.heads)
            head = _any([_all([implied(each), (true, true)]) for each, true in zip(self.heads, truths, strict=True)])
        return _implies(body, head)[0]


def answer_sets_here_and_there(rules: Iterable[ConditionalRule]) -> list[str]:
    """Return the answer sets, each as its atoms in order, sorted."""
    rules = list(rules)
    subsets = list(map(frozenset, chain.from_iterable(combinations(ATOMS, size) for size in range(len(ATOMS) + 1))))
    return sorted(
        "".join(sorted(there))
        for there in subsets
        if all(rule.holds(there, there) for rule in rules)
        and not any(here < there and all(rule.holds(here, there) for rule in rules) for here in subsets)
    )


def random_rules(source: random.Random) -> Iterator[ConditionalRule]:
    """Yield a few rules, some of which are recursive through conditions."""

    def literal() -> str:
        return source.choice(["", "", "", "not "]) + source.choice(ATOMS)

    def conditional(head: str, share: float) -> Conditional:
        some = source.random() < share
        return Conditional(head, tuple(literal() for _ in range(source.choice([1, 1, 2]))) if some else ())

    for _ in range(source.randint(2, 5)):
        choice = source.random() < 0.25
        heads = 1 if choice else source.choice([0, 1, 1, 1, 1, 2, 2])
        yield ConditionalRule(
            tuple(conditional(source.choice(ATOMS), 0 if choice else 0.4) for _ in range(heads)),
            tuple(conditional(literal(), 0.25) for _ in range(source.choice([0, 0, 1, 1, 2]))),
            choice,
        )


def _all(values: Iterable[Value]) -> Value:
    values = list(values)
    return all(here for here, _ in values), all(there for _, there in values)


def _any(values: Iterable[Value]) -> Value:
    values = list(values)
    return any(here for here, _ in values), any(there for _, there in values)


def _implies(left: Value, right: Value) -> Value:
    there = not left[1] or right[1]
    return there and (not left[0] or right[0]), there
