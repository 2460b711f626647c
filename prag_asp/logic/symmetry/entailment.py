"""An incomplete test of whether rules entail another rule.

The body of the rule is assumed, with negated literals as separate atoms, and the rules are applied. If its head or a
contradiction follows, the rule is a consequence of the others in the logic of here-and-there: adding it changes no
answer sets of any larger program (strong equivalence; Lifschitz, Pearce and Valverde 2001). The test finds consequences
of chains of rules, such as those of redundant invariants.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from prag_asp.logic.symmetry.atom_numbering import START, SpelledRule

_Literal = tuple[int, int]


class Consequences:
    """The consequences of some rules."""

    def __init__(self, rules: Iterable[SpelledRule]) -> None:
        self._rules: list[tuple[tuple[int, ...], int]] = []
        self._having: dict[_Literal, list[tuple[int, int]]] = {}
        self._facts: set[int] = set()
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
        consequences = self._follow((atom, sign) for atom, sign, _ in rule.body[2])
        if consequences is None:
            return True
        return len(rule.heads) == 1 and (*rule.heads, 0) in consequences

    def _follow(self, literals: Iterable[_Literal]) -> set[_Literal] | None:
        """Return the consequences of some literals, or None if they contradict the rules or each other."""
        consequences = {*literals, *((atom, 0) for atom in self._facts)}
        waiting = list(consequences)
        reached: Counter[int] = Counter()
        while waiting:
            atom, sign = waiting.pop()
            if (atom, 1 - sign) in consequences:
                return None
            for number, weight in self._having.get((atom, sign), ()):
                heads, bound = self._rules[number]
                if reached[number] < bound <= reached[number] + weight:
                    if not heads:
                        return None
                    if (heads[0], 0) not in consequences:
                        consequences.add((heads[0], 0))
                        waiting.append((heads[0], 0))
                reached[number] += weight
        return consequences
