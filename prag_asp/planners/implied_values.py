"""Contradictions and consequences of values under the invariants of a domain."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import product

import clingo

from prag_asp.planners.ground_action import CARRIED, Proposition, Value
from prag_asp.program.facts import Facts
from prag_asp.program.invariants import FluentValue, conflict, entailed, invariant_graph


class ImpliedValues:
    """The invariants; `unknown` holds the fluents that may be unknown, whose propositions state known values."""

    def __init__(self, facts: Facts, unknown: Collection[clingo.Symbol]) -> None:
        self._graph = invariant_graph(facts, impossible=True)
        self._unknown = unknown

    def possible(self, values: Iterable[Value]) -> bool:
        """Return whether the given values are consistent."""
        return conflict(self._known(values)) is None

    def fixed(self, before: Mapping[Proposition, bool], propositions: Iterable[Proposition]) -> dict[int, bool]:
        """Return the values, by number, of the propositions that `before` states or entails."""
        entailed_values = self._known(before.items())
        values = {}
        for number, proposition in enumerate(propositions):
            if proposition in before:
                values[number] = before[proposition]
            elif not proposition.role and proposition.term not in self._unknown:
                follows = [value for value in (True, False) if (proposition.term, value) in entailed_values]
                values.update((number, value) for value in follows)
        return values

    def needed(self, before: Mapping[Proposition, bool], stated: Collection[Value]) -> dict[Proposition, bool]:
        """Return the values of a precondition that are stated or do not follow from the others."""
        precondition = dict(before)
        for each in reversed([*before.items()]):
            (term, role), value = each
            if each not in stated and not role and term not in self._unknown:
                others = ((other, truth) for other, truth in precondition.items() if other != each[0])
                if (term, value) in self._known(others):
                    del precondition[each[0]]
        return precondition

    def units(
        self, clauses: Iterable[Sequence[Value]]
    ) -> tuple[dict[Proposition, bool], tuple[tuple[Value, ...], ...]]:
        """Propagate units; return the values and the remaining clauses, one of which is empty at a contradiction."""
        before: dict[Proposition, bool] = {}
        left = [*dict.fromkeys(map(tuple, clauses))]
        while True:
            known = self._known(before.items())
            if conflict(known) is not None:
                return before, ((),)
            # A value fails if it contradicts others, given the fluent values that they entail.
            fails = {}
            for proposition, value in product({each for clause in left for each, _ in clause}, (True, False)):
                meaning = self._meaning((proposition, value))
                fails[proposition, value] = before.get(proposition, value) != value or (
                    meaning is not None and (meaning[0], not meaning[1]) in known
                )
            left = [clause for clause in left if not any(fails[one, not value] for one, value in clause)]
            left = [*dict.fromkeys(tuple(each for each in clause if not fails[each]) for clause in left)]
            new = dict(clause[0] for clause in left if len(clause) == 1)
            if () in left or not new:
                return before, tuple(left)
            before |= new

    def _known(self, values: Iterable[Value]) -> Mapping[FluentValue, FluentValue]:
        """Return the fluent values that the given values entail under the invariants."""
        return entailed((meaning for each in values if (meaning := self._meaning(each)) is not None), self._graph)

    def _meaning(self, value: Value) -> FluentValue | None:
        """Return the fluent value that a value of a proposition represents, if there is one."""
        (term, role), truth = value
        if role == CARRIED or (term in self._unknown and not truth):
            return None
        return term, truth == (role == "")
