"""Values that contradict each other or follow from others by the invariants of a domain."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import clingo

from prag_asp.planners.ground_action import CARRIED, Proposition, Value
from prag_asp.program.facts import Facts
from prag_asp.program.invariants import FluentValue, conflict, entailed, invariant_graph


class ImpliedValues:
    """The invariants; `unknown` are the fluents that need not be known, whose propositions say what is."""

    def __init__(self, facts: Facts, unknown: Collection[clingo.Symbol]) -> None:
        self._graph = invariant_graph(facts, impossible=True)
        self._unknown = unknown

    def possible(self, values: Iterable[Value]) -> bool:
        """Return whether some values do not contradict each other."""
        return conflict(self._known(values)) is None

    def fixed(self, before: Mapping[Proposition, bool], propositions: Iterable[Proposition]) -> dict[int, bool]:
        """Return the values, by number, of those of some propositions that are given, or follow."""
        known = self._known(before.items())
        found = {}
        for number, each in enumerate(propositions):
            if each in before:
                found[number] = before[each]
            elif not each.role and each.term not in self._unknown:
                follows = [value for value in (True, False) if (each.term, value) in known]
                found.update((number, value) for value in follows)
        return found

    def needed(self, before: Mapping[Proposition, bool], stated: Collection[Value]) -> dict[Proposition, bool]:
        """Return the values that a precondition has to name: those stated, and those that do not follow from others."""
        found = dict(before)
        for each in reversed([*before.items()]):
            (term, role), value = each
            if each not in stated and not role and term not in self._unknown:
                others = ((one, so) for one, so in found.items() if one != each[0])
                if (term, value) in self._known(others):
                    del found[each[0]]
        return found

    def units(
        self, clauses: Iterable[Sequence[Value]]
    ) -> tuple[dict[Proposition, bool], tuple[tuple[Value, ...], ...]]:
        """Return the values that clauses demand, and the clauses that are left: an empty one if there is no way."""
        before: dict[Proposition, bool] = {}
        left = [*dict.fromkeys(map(tuple, clauses))]
        while True:
            known = self._known(before.items())
            if conflict(known) is not None:
                return before, ((),)
            fails = {each: self._fails(each, before, known) for clause in left for each in _both(clause)}
            left = [clause for clause in left if not any(fails[one, not value] for one, value in clause)]
            left = [*dict.fromkeys(tuple(each for each in clause if not fails[each]) for clause in left)]
            new = dict(clause[0] for clause in left if len(clause) == 1)
            if () in left or not new:
                return before, tuple(left)
            before |= new

    def _fails(self, value: Value, before: Mapping[Proposition, bool], known: Collection[FluentValue]) -> bool:
        """Return whether a value contradicts others, of which the fluents' values are known."""
        proposition, demanded = value
        meaning = self._meaning(value)
        return before.get(proposition, demanded) != demanded or (
            meaning is not None and (meaning[0], not meaning[1]) in known
        )

    def _known(self, values: Iterable[Value]) -> Mapping[FluentValue, FluentValue]:
        """Return what some values, and the invariants, tell of fluents."""
        return entailed((meaning for each in values if (meaning := self._meaning(each)) is not None), self._graph)

    def _meaning(self, value: Value) -> FluentValue | None:
        """Return what a value tells of a fluent, if it does."""
        (term, role), so = value
        if role == CARRIED or (term in self._unknown and not so):
            return None
        return term, so == (role == "")


def _both(clause: Iterable[Value]) -> Iterable[Value]:
    return ((each, value) for each, _ in clause for value in (True, False))
