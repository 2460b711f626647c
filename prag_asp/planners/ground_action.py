"""A domain as a ground PDDL planning task: actions with preconditions and conditional effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import clingo

NOT_TRUE = "known-not"
"""The role of the proposition "known to be false" for a fluent that may be unknown."""

CARRIED = "carried"
"""The role of a proposition that is not a fluent."""


class Proposition(NamedTuple):
    """A proposition about a state: a fluent or, with a `role`, another state variable of user transition rules."""

    term: clingo.Symbol
    role: str = ""


Value = tuple[Proposition, bool]
Values = Mapping[Proposition, bool]


class ConditionalEffect(NamedTuple):
    """A value that an action sets if its condition holds before the action."""

    condition: tuple[Value, ...]
    value: Value


@dataclass(frozen=True)
class Case:
    """A precondition, which is a conjunction of values and clauses, and conditional effects.

    Effects whose conditions may hold simultaneously do not contradict each other.
    """

    precondition: Values
    clauses: tuple[tuple[Value, ...], ...]
    effects: tuple[ConditionalEffect, ...]


@dataclass(frozen=True)
class GroundAction:
    """An action with its mutually exclusive cases."""

    term: clingo.Symbol
    cases: tuple[Case, ...]


@dataclass(frozen=True)
class PlanningTask:
    """A planning task: its propositions, which of them are true initially, the actions, and the goal.

    The goal is the conjunction of its values and of the `clauses`.
    """

    propositions: tuple[Proposition, ...]
    initial: frozenset[Proposition]
    actions: tuple[GroundAction, ...]
    goal: Values
    clauses: tuple[tuple[Value, ...], ...] = ()
