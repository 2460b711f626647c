"""The composites that every state rejects, and a test whether a composite or a free action can come first.

A sequence of actions that is rejected in the state where only the static values are known is rejected in every state.
The invariants yield candidates with reasons; the encodings confirm them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

import clingo

from prag_asp.program.composition import Actions, composite_actions
from prag_asp.program.facts import Assignment, Facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.invariants import FluentValue, Graph, conflict, entailed, invariant_graph, spell
from prag_asp.program.predicates import OCCURS
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Statement
from prag_asp.pruning.rejected_actions import STEP, RejectedActions, fluent_values, holding, state_predicates_of

KnownValues = frozenset[FluentValue]


class StageFailure(NamedTuple):
    """Why a sequence of actions is rejected: the index of the action to blame, and the reason as text."""

    place: int
    reason: str


class RejectedComposites(NamedTuple):
    """The composites that can never occur, and the reasons for those whose actions can each occur on their own.

    `none_can_begin` is true if no composite and no free action can begin in the initial state.
    """

    composites: frozenset[clingo.Symbol]
    failures: Mapping[clingo.Symbol, StageFailure]
    none_can_begin: bool


def find_rejected_composites(
    program: Program, facts: Facts, actions: RejectedActions, statements: Sequence[Statement]
) -> RejectedComposites:
    """Return the composites that every state rejects.

    If user rules of a step derive states, only the rejected `actions` reject composites.
    """
    sequences = composite_actions(facts)
    rejected = actions.rejections.keys()
    broken = {composite for composite, sequence in sequences.items() if not rejected.isdisjoint(sequence)}
    if any(map(any, map(state_predicates_of, statements))):
        return RejectedComposites(frozenset(broken), {}, none_can_begin=False)
    runner = _SequenceRunner(facts)
    whole = {composite: sequence for composite, sequence in sequences.items() if composite not in broken}
    failures = runner.failures(whole, frozenset(actions.static))
    confirmed = _confirmed(program, {composite: sequences[composite] for composite in failures}, actions.static)
    failures = {composite: failures[composite] for composite in confirmed}
    initial = fluent_values(facts.initially)
    free = set(facts.free).difference(sequences, rejected)
    units = {**whole, **{action: (action,) for action in free}}
    stuck = len(runner.failures(units, frozenset(initial))) == len(units) == len(_confirmed(program, units, initial))
    return RejectedComposites(frozenset({*broken, *failures}), failures, stuck)


class _SequenceRunner:
    """A simulator of sequences of actions on known values, as in the encodings; it simulates common prefixes once."""

    def __init__(self, facts: Facts) -> None:
        self._graph: Graph = invariant_graph(facts)
        self._needed = {a: frozenset(entailed(_of(facts.preconditions, a), self._graph)) for a in facts.actions}
        self._made = {a: _of(facts.postconditions, a) for a in facts.actions}
        self._changed = {a: {fluent for fluent, _ in facts.postconditions.get(a, ())} for a in facts.actions}

    def failures(
        self, sequences: Mapping[clingo.Symbol, Actions], values: KnownValues
    ) -> dict[clingo.Symbol, StageFailure]:
        """Return the sequences that are rejected in a state in which only some values are known, with the reasons."""
        results: dict[Actions, KnownValues | StageFailure] = {(): frozenset(entailed(values, self._graph))}
        failures: dict[clingo.Symbol, StageFailure] = {}
        for key, sequence in sequences.items():
            for index, action in enumerate(sequence):
                before = results[sequence[:index]]
                if sequence[: index + 1] not in results:
                    results[sequence[: index + 1]] = (
                        before if isinstance(before, StageFailure) else self._after(index, action, before)
                    )
            last = results[sequence]
            if isinstance(last, StageFailure):
                failures[key] = last
        return failures

    def _after(self, index: int, action: clingo.Symbol, values: KnownValues) -> KnownValues | StageFailure:
        needed = self._needed[action]
        for fluent, value in sorted(needed):
            if (fluent, not value) in values or (fluent, not value) in needed:
                return StageFailure(index, f"needs {spell((fluent, value))}, but by then {spell((fluent, not value))}")
        unchanged = {literal for literal in values | needed if literal[0] not in self._changed[action]}
        after = entailed([*unchanged, *self._made[action]], self._graph)
        pair = conflict(after)
        if pair:
            return StageFailure(index, f"leads to {spell(pair[0])} and {spell(pair[1])}, which the invariants forbid")
        return frozenset(after)


def _of(table: Mapping[clingo.Symbol, Assignment], action: clingo.Symbol) -> list[FluentValue]:
    return fluent_values(table.get(action, ()))


def _confirmed(
    program: Program, sequences: Mapping[clingo.Symbol, Actions], values: Collection[FluentValue]
) -> list[clingo.Symbol]:
    """Return the keys of the sequences that the encodings reject in a state in which only some values are known."""
    confirmed = []
    by_length = sorted(sequences, key=lambda key: len(sequences[key]))
    for length, keys in groupby(by_length, key=lambda key: len(sequences[key])):
        grounder = Grounder(program)
        steps = [clingo.Number(STEP + index) for index in range(length)]
        grounder.ground([("base", [])])
        grounder.state(holding(values, STEP - 1))
        grounder.ground([("step", [step]) for step in steps])
        atoms = grounder.control.symbolic_atoms
        for key in keys:
            occurring = [atoms[OCCURS(action, step)] for action, step in zip(sequences[key], steps, strict=True)]
            assumed = [atom.literal for atom in occurring if atom is not None]
            if len(assumed) < length or grounder.control.solve(assumptions=assumed).unsatisfiable:
                confirmed.append(key)
    return confirmed
