"""A domain without rules over time, as ground actions with preconditions and effects.

An invariant that an action might break becomes a precondition: if the action makes one literal of a binary clause
false, it requires the other one, unless it makes the other one true.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import clingo

from prag_asp.atom import Atom, symbol_of
from prag_asp.errors import DomainError
from prag_asp.planners.ground_action import Case, ConditionalEffect, GroundAction, PlanningTask, Proposition
from prag_asp.program.facts import Facts
from prag_asp.program.invariants import FluentValue, entailed, invariant_graph
from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import Program, owned
from prag_asp.task import Task

NOT_OVER_TIME = ("closed_world", "ever", "canonical_names", "joint_names", "closed_invariants", "same_start", "weights")
"""Rules in the encodings that do not restrict plans."""

MOST = 400
"""The maximum number of fluents for which pairs are computed; n fluents have 4 n^2 pairs."""

Values = Mapping[clingo.Symbol, bool]

Outcomes = Mapping[tuple[clingo.Symbol, clingo.Symbol], bool]
"""The values of unknown effects, by action and fluent."""


class _StripsAction(NamedTuple):
    """An action with its precondition and its effects as values of fluents."""

    term: clingo.Symbol
    precondition: Values
    effects: Values


class FactPairs:
    """The pairs of values that may be in one reachable state, an overapproximation (h^2 of Haslum and Geffner).

    A pair is reached if it holds in the initial state, or if a reachable action makes one of its values hold while the
    other also holds afterwards. Conditions that exclude unreachable pairs are redundant. Each value is a bit of an
    integer.
    """

    def __init__(self, state: Values, actions: Iterable[tuple[Values, Values]]) -> None:
        self._number = {fluent: 2 * number for number, fluent in enumerate(state)}
        start = sum(1 << bit for bit in self._bits(state))
        self._with = [start if start >> bit & 1 else 0 for bit in range(2 * len(state))]
        self._reached = start
        masks = [
            (self._bits(before), self._bits(after), sum(3 << self._number[fluent] for fluent in after))
            for before, after in actions
        ]
        while sum(self._apply(*mask) for mask in masks):
            pass

    def excludes(self, before: Values, fluent: clingo.Symbol, value: bool) -> bool:
        """Return whether a value of a fluent is mutually exclusive with one of several other values."""
        return not self._beside(self._bits(before)) >> self._bit(fluent, value) & 1

    def _apply(self, before: list[int], after: list[int], changed: int) -> bool:
        """Add the pairs that an action reaches, and return whether any of them is new."""
        beside = self._beside(before)
        if any(not beside >> bit & 1 for bit in before):
            return False
        added = sum(1 << bit for bit in after)
        there = (beside & ~changed) | added
        is_new = False
        for bit in after:
            new = there & ~self._with[bit]
            if new:
                is_new = True
                self._with[bit] |= new
                while new:
                    lowest = new & -new
                    self._with[lowest.bit_length() - 1] |= 1 << bit
                    new ^= lowest
        self._reached |= added
        return is_new

    def _beside(self, bits: Iterable[int]) -> int:
        """Return the values that may hold together with each of the given values."""
        compatible = self._reached
        for bit in bits:
            compatible &= self._with[bit]
        return compatible

    def _bit(self, fluent: clingo.Symbol, value: bool) -> int:
        return self._number[fluent] + value

    def _bits(self, values: Values) -> list[int]:
        return [self._bit(fluent, value) for fluent, value in values.items()]


def ground_plain(facts: Facts, state: Values, goal: Values, outcomes: Outcomes | None = None) -> PlanningTask:
    """Return the planning task with all applicable actions; fluents not in `state` are false.

    With `outcomes`, unknown effects have these values, or false if they have none.

    Raises:
        DomainError: an effect is unknown, and there are no `outcomes`.
    """
    actions = [each for action in facts.actions if (each := _strips_action(action, facts, outcomes)) is not None]
    pairs = None
    if len(facts.fluents) <= MOST:
        whole = {fluent: state.get(fluent, False) for fluent in facts.fluents}
        pairs = FactPairs(whole, [(each.precondition, each.effects) for each in actions])
    graph = invariant_graph(facts, impossible=True)
    clauses: dict[FluentValue, list[FluentValue]] = {}
    binary = [((f, False), (g, False)) for f, g in (*facts.exclusive, *facts.impossible)]
    binary += [((f, False), (g, True)) for f, g in facts.implies if f != g]
    for one, other in binary:
        clauses.setdefault(one, []).append(other)
        clauses.setdefault(other, []).append(one)
    ground = []
    for action in actions:
        before = _safe_precondition(action, graph, clauses, pairs)
        if before is not None:
            stated = {Proposition(fluent): value for fluent, value in before.items()}
            effects = (ConditionalEffect((), (Proposition(fluent), value)) for fluent, value in action.effects.items())
            ground.append(GroundAction(action.term, (Case(stated, (), tuple(effects)),)))
    initial = frozenset(Proposition(fluent) for fluent, value in state.items() if value)
    goal_values = {Proposition(fluent): value for fluent, value in goal.items()}
    return PlanningTask(tuple(map(Proposition, facts.fluents)), initial, tuple(ground), goal_values)


def outcomes_of(task: Task, facts: Facts) -> Outcomes:
    """Return the known outcomes of the unknown effects of a task's actions.

    Raises:
        DomainError: an action occurs twice with different outcomes.
    """
    outcomes: dict[tuple[clingo.Symbol, clingo.Symbol], bool] = {}
    for atom, state in zip(task.actions, task.states, strict=True):
        action, values = symbol_of(atom), values_of(state)
        for fluent, value in facts.postconditions.get(action, ()):
            if value != "unknown" or fluent not in values:
                continue
            if outcomes.setdefault((action, fluent), values[fluent]) != values[fluent]:
                problem = f"{action} occurs twice, and {fluent} is true after one and false after the other"
                raise DomainError(f"{problem}, which PDDL cannot express; choose another task")
    return outcomes


def broken_invariant(facts: Facts, state: Mapping[clingo.Symbol, bool]) -> bool:
    """Return whether a state violates an invariant; fluents that are not in the state are false."""
    both = (*facts.exclusive, *facts.impossible)
    return any(state.get(f) and state.get(g) for f, g in both) or any(
        state.get(f) and not state.get(g) for f, g in facts.implies
    )


def rules_over_time(program: Program) -> Iterator[tuple[Path, int]]:
    """Yield the file and line of each rule that restricts plans beyond the preconditions and effects of actions."""
    for source, own in owned(program):
        if own or (source.path.parent.name == "rules" and source.path.stem not in NOT_OVER_TIME):
            statements, _ = parse_sources([(source, own)])
            yield from ((each.path, each.line) for each in statements if each.timed and each.is_rule)


def _strips_action(action: clingo.Symbol, facts: Facts, outcomes: Outcomes | None) -> _StripsAction | None:
    """Return an action with its stated preconditions and effects, or None if it contradicts itself.

    Raises:
        DomainError: an effect is unknown and there are no `outcomes`.
    """
    after: dict[clingo.Symbol, bool] = {}
    for fluent, value in facts.postconditions.get(action, ()):
        if value == "unknown" and outcomes is None:
            problem = f"{action} leaves {fluent} unknown, which PDDL cannot express"
            raise DomainError(f"{problem}; let the action make it true or false, or export a task")
    stated = facts.postconditions.get(action, ())
    for fluent, value in (each for each in stated if each[1] != "unknown"):
        if after.setdefault(fluent, value == "true") != (value == "true"):
            return None
    for fluent, _ in stated:
        after.setdefault(fluent, bool(outcomes and outcomes.get((action, fluent))))
    before: dict[clingo.Symbol, bool] = {}
    for fluent, value in facts.preconditions.get(action, ()):
        if before.setdefault(fluent, value == "true") != (value == "true"):
            return None
    return _StripsAction(action, before, after)


def _safe_precondition(
    action: _StripsAction,
    graph: Mapping[FluentValue, tuple[FluentValue, ...]],
    clauses: Mapping[FluentValue, list[FluentValue]],
    pairs: FactPairs | None,
) -> Values | None:
    """Return the precondition under which an action preserves the invariants, or None if it always violates one.

    `clauses` holds, for each value, the values that an invariant requires if that value does not hold.
    """
    before = dict(action.precondition)
    known = entailed(before.items(), graph)
    for fluent, value in action.effects.items():
        for other, needed in clauses.get((fluent, not value), ()):
            if action.effects.get(other, needed) != needed:
                return None
            if other in action.effects or (other, needed) in known:
                continue
            if pairs is not None and pairs.excludes(action.precondition, other, not needed):
                continue
            if before.setdefault(other, needed) != needed:
                return None
    return before


def known_values(values: Iterable[tuple[clingo.Symbol, str]]) -> dict[clingo.Symbol, bool]:
    """Return fluents with Boolean values in place of ``true`` and ``false``, the texts of the contract."""
    return {fluent: value == "true" for fluent, value in values}


def values_of(state: Mapping[Atom, bool]) -> dict[clingo.Symbol, bool]:
    """Return a state of a task with clingo's terms as keys."""
    return {symbol_of(fluent): value for fluent, value in state.items()}
