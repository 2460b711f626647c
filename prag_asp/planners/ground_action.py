"""A domain as a ground planning task of PDDL: actions with preconditions and conditional effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import clingo

NOT_TRUE = "known-not"
"""The role of the proposition that a fluent is known to be false, for fluents that may be unknown."""

CARRIED = "carried"
"""The role of a proposition that is no fluent."""


class Proposition(NamedTuple):
    """A proposition of a state: a fluent, or with a `role` a value that rules over time carry along beside them."""

    term: clingo.Symbol
    role: str = ""


Value = tuple[Proposition, bool]
Values = Mapping[Proposition, bool]


class ConditionalEffect(NamedTuple):
    """A value that an action sets if all values of its condition hold before."""

    condition: tuple[Value, ...]
    value: Value


@dataclass(frozen=True)
class Case:
    """A precondition, which is a conjunction of values and of clauses, and conditional effects.

    No two effects whose conditions may hold at once make a proposition true and false.
    """

    precondition: Values
    clauses: tuple[tuple[Value, ...], ...]
    effects: tuple[ConditionalEffect, ...]


@dataclass(frozen=True)
class GroundAction:
    """An action with its cases, no two of which are possible in one state."""

    term: clingo.Symbol
    cases: tuple[Case, ...]


@dataclass(frozen=True)
class PlanningTask:
    """A planning task: propositions, those of the initial state, the actions, and the goal.

    The goal is the conjunction of its values and of the `clauses`.
    """

    propositions: tuple[Proposition, ...]
    initial: frozenset[Proposition]
    actions: tuple[GroundAction, ...]
    goal: Values
    clauses: tuple[tuple[Value, ...], ...] = ()
