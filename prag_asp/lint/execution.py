"""Composites that can never occur, and a start at which no composite and no free action can begin.

A sequence of actions that is rejected from a state where nothing is known but what never changes is rejected from
every state. The invariants tell which sequences are suspect and why; the encodings have the last word.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

import clingo

from prag_asp.lint.composites import Complaint, grouped
from prag_asp.lint.occurrence import STEP, Occurrence, fluent_values, holding, stated_of_steps
from prag_asp.lint.rule_origin import Origins
from prag_asp.program.composition import Actions, composite_actions
from prag_asp.program.facts import Assignment, Facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.invariants import FluentValue, Graph, conflict, entailed, invariant_graph, spell
from prag_asp.program.problem import Problem
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Statement

Known = frozenset[FluentValue]


class _Failure(NamedTuple):
    """Why a sequence is rejected: the place of the action in it, and the reason in words."""

    place: int
    reason: str


class Execution(NamedTuple):
    """Which composites can never occur, why those that are no matter of a single action, and whether none can begin."""

    never: frozenset[clingo.Symbol]
    failures: Mapping[clingo.Symbol, _Failure]
    stuck: bool


def find_execution(
    program: Program, facts: Facts, occurrence: Occurrence, statements: Sequence[Statement]
) -> Execution:
    """Return the composites that are rejected in every state, and whether a plan can begin with any.

    What own rules of a step may change is not second-guessed: then only actions that never occur tell of composites.
    """
    words = composite_actions(facts)
    broken = {composite for composite, word in words.items() if not occurrence.rejected.keys().isdisjoint(word)}
    if any(map(any, map(stated_of_steps, statements))):
        return Execution(frozenset(broken), {}, stuck=False)
    execution = _Execution(facts)
    whole = {composite: word for composite, word in words.items() if composite not in broken}
    failures = execution.failures(whole, frozenset(occurrence.fixed))
    confirmed = _confirmed(program, {composite: words[composite] for composite in failures}, occurrence.fixed)
    failures = {composite: failures[composite] for composite in confirmed}
    initial = fluent_values(facts.initially)
    free = set(facts.free).difference(words, occurrence.rejected)
    units = {**whole, **{action: (action,) for action in free}}
    stuck = len(execution.failures(units, frozenset(initial))) == len(units) == len(_confirmed(program, units, initial))
    return Execution(frozenset({*broken, *failures}), failures, stuck)


def execution_problems(found: Execution, facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield the composites that are rejected in every state, or that the start lets none of all begin."""
    complaints = list(_never(facts, composite_actions(facts), found.failures, origins))
    hopeless = found.stuck and bool(complaints) and len(found.never) == len(facts.composites)
    yield from grouped(complaints, "no-plan" if hopeless else "never-occurs")
    if found.stuck and not hopeless:
        yield Problem(
            *origins.place("composite", facts.composites[0]),
            "no composite and no free action can begin at the start, so there is no plan; "
            "change the start, or declare more with free(...)",
            "no-plan",
        )


class _Execution:
    """Runs sequences of actions through what is known, as the encodings do, one start of a sequence once."""

    def __init__(self, facts: Facts) -> None:
        self._graph: Graph = invariant_graph(facts)
        self._needed = {a: frozenset(entailed(_of(facts.preconditions, a), self._graph)) for a in facts.actions}
        self._made = {a: _of(facts.postconditions, a) for a in facts.actions}
        self._changed = {a: {fluent for fluent, _ in facts.postconditions.get(a, ())} for a in facts.actions}

    def failures(self, words: Mapping[clingo.Symbol, Actions], known: Known) -> dict[clingo.Symbol, _Failure]:
        """Return which words are rejected from a state where just `known` is known, and why."""
        reached: dict[Actions, Known | _Failure] = {(): frozenset(entailed(known, self._graph))}
        found: dict[clingo.Symbol, _Failure] = {}
        for key, word in words.items():
            for place, action in enumerate(word):
                before = reached[word[:place]]
                if word[: place + 1] not in reached:
                    reached[word[: place + 1]] = (
                        before if isinstance(before, _Failure) else self._after(place, action, before)
                    )
            last = reached[word]
            if isinstance(last, _Failure):
                found[key] = last
        return found

    def _after(self, place: int, action: clingo.Symbol, known: Known) -> Known | _Failure:
        needed = self._needed[action]
        for fluent, value in sorted(needed):
            if (fluent, not value) in known or (fluent, not value) in needed:
                now = spell((fluent, not value))
                return _Failure(place, f"needs {spell((fluent, value))}, but by then {now}")
        kept = {literal for literal in known | needed if literal[0] not in self._changed[action]}
        after = entailed([*kept, *self._made[action]], self._graph)
        pair = conflict(after)
        if pair:
            return _Failure(place, f"leads to {spell(pair[0])} and {spell(pair[1])}, which the invariants forbid")
        return frozenset(after)


def _of(table: Mapping[clingo.Symbol, Assignment], action: clingo.Symbol) -> list[FluentValue]:
    return fluent_values(table.get(action, ()))


def _confirmed(
    program: Program, words: Mapping[clingo.Symbol, Actions], known: Collection[FluentValue]
) -> list[clingo.Symbol]:
    """Return those of some words that the encodings reject where just `known` is known."""
    found = []
    for length, keys in groupby(sorted(words, key=lambda key: len(words[key])), key=lambda key: len(words[key])):
        grounder = Grounder(program)
        steps = [clingo.Number(STEP + place) for place in range(length)]
        grounder.ground([("base", [])])
        grounder.state(holding(known, STEP - 1))
        grounder.ground([("step", [step]) for step in steps])
        atoms = grounder.control.symbolic_atoms
        for key in keys:
            occurring = [atoms[clingo.Function("occurs", [a, s])] for a, s in zip(words[key], steps, strict=True)]
            assumed = [atom.literal for atom in occurring if atom is not None]
            if len(assumed) < length or grounder.control.solve(assumptions=assumed).unsatisfiable:
                found.append(key)
    return found


def _never(
    facts: Facts,
    words: Mapping[clingo.Symbol, Actions],
    failures: Mapping[clingo.Symbol, _Failure],
    origins: Origins,
) -> Iterator[Complaint]:
    """Yield the innermost composites that are rejected, each at the stage that its rejected action belongs to."""
    for composite, failure in failures.items():
        stages = facts.stages[composite]
        if any(part in failures for _, part in stages):
            continue
        at = 0
        for number, part in stages:
            at += len(words.get(part, (part,)))
            if failure.place < at:
                place = origins.place("stage", composite, number, part)
                words_ = f"can never occur: its action {failure.place + 1}, {words[composite][failure.place]}, "
                yield Complaint(composite, place, words_ + failure.reason, "mend its stages, or leave it out")
                break
