"""The consequences of literals under the rules of a ground step, used to find rules that other rules entail."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from prag_asp.logic.symmetry.atom_numbering import START, SpelledRule

SignedAtom = tuple[int, int]
"""The number of an atom, and whether it is negated (1) or not (0)."""

REMEMBERED = 1_000_000
"""The maximum number of cached literals and sums of `Consequences`; they take about 200 MB."""


class Consequences:
    """An incomplete test of whether rules entail another rule.

    The body of the rule is assumed, with negated literals as separate atoms, and the rules are applied. If its head or
    a contradiction follows, the rule is a consequence of the others in the logic of here-and-there: adding it to any
    program that contains the others leaves the answer sets unchanged (strong equivalence; Lifschitz, Pearce and
    Valverde 2001). The test finds consequences of chains of rules, such as those of redundant invariants.
    """

    def __init__(self, rules: Iterable[SpelledRule]) -> None:
        self._rules: list[tuple[tuple[int, ...], int]] = []
        self._having: dict[tuple[int, int], list[tuple[int, int]]] = {}
        self._facts: set[int] = set()
        self._remembered: dict[SignedAtom, _Closure | None] = {}
        self._size = 0
        for rule in rules:
            choice, bound, literals = rule.body
            if choice or bound >= START or len(rule.heads) > 1:
                continue
            if bound <= 0:
                self._facts |= rule.heads
            for atom, sign, weight in literals:
                self._having.setdefault((atom, sign), []).append((len(self._rules), weight))
            self._rules.append((tuple(rule.heads), bound))

    def has(self, rule: SpelledRule) -> bool:
        """Return whether the test finds that a rule is a consequence."""
        if not rule.is_plain:
            return False
        if self._of_facts is None:
            return True
        literals = [(atom, sign) for atom, sign, _ in rule.body[2]]
        largest = self._of_facts
        for literal in literals:
            alone = self._of_literal(literal, self._of_facts)
            if alone is None:
                return True
            largest = max(largest, alone, key=lambda closure: closure.size)
        closure = self._follow(literals, largest)
        return closure is None or (len(rule.heads) == 1 and closure.has((min(rule.heads), 0)))

    @cached_property
    def _of_facts(self) -> _Closure | None:
        return self._follow(((atom, 0) for atom in self._facts), None)

    def _of_literal(self, literal: SignedAtom, facts: _Closure) -> _Closure | None:
        """Return the consequences of one literal and the facts, which many rules share."""
        if literal not in self._remembered:
            if self._size > REMEMBERED:
                self._remembered.clear()
                self._size = 0
            closure = self._remembered[literal] = self._follow([literal], facts)
            self._size += closure.size if closure else 1
        return self._remembered[literal]

    def _follow(self, literals: Iterable[SignedAtom], below: _Closure | None) -> _Closure | None:
        """Return the consequences of literals and of those in `below`, or None if they contradict the rules."""
        closure = _Closure({literal for literal in literals if below is None or not below.has(literal)}, {}, below)
        waiting = list(closure.literals)
        while waiting:
            atom, sign = waiting.pop()
            if closure.has((atom, 1 - sign)):
                return None
            for number, weight in self._having.get((atom, sign), ()):
                heads, bound = self._rules[number]
                before = closure.weight(number)
                if before < bound <= before + weight:
                    if not heads:
                        return None
                    if not closure.has((heads[0], 0)):
                        closure.literals.add((heads[0], 0))
                        waiting.append((heads[0], 0))
                closure.weights[number] = before + weight
        return closure


@dataclass(frozen=True)
class _Closure:
    """The consequences of given literals, and the sums that they reach in the bodies of rules, by rule number.

    Both contain only the differences from the closure `below`.
    """

    literals: set[SignedAtom]
    weights: dict[int, int]
    below: _Closure | None

    @property
    def size(self) -> int:
        return len(self.literals) + len(self.weights)

    def has(self, literal: SignedAtom) -> bool:
        return literal in self.literals or (self.below is not None and self.below.has(literal))

    def weight(self, number: int) -> int:
        """Return the sum that the literals reach in the body of a rule."""
        if number in self.weights:
            return self.weights[number]
        return 0 if self.below is None else self.below.weight(number)
