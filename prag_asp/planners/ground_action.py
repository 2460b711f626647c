"""A domain as ground actions that PDDL can say: what has to hold before each, and what it makes so, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import clingo

NOT_TRUE = "known-not"
"""The role of the proposition that a fluent is known to be false, where it may be unknown."""

CARRIED = "carried"
"""The role of what is no fluent."""


class Proposition(NamedTuple):
    """What is true or false in a state: a fluent, or with a `role` what rules over time carry along beside them."""

    term: clingo.Symbol
    role: str = ""


Value = tuple[Proposition, bool]
Values = Mapping[Proposition, bool]


class ConditionalEffect(NamedTuple):
    """A value that an action makes where some others are so before it."""

    where: tuple[Value, ...]
    made: Value


@dataclass(frozen=True)
class Case:
    """What an action needs and makes: all of `before`, of each clause one, and the effects.

    No two effects whose conditions may be so at once make a proposition true and false.
    """

    before: Values
    clauses: tuple[tuple[Value, ...], ...]
    effects: tuple[ConditionalEffect, ...]


@dataclass(frozen=True)
class GroundAction:
    """An action with its cases, no two of which are possible in one state."""

    term: clingo.Symbol
    cases: tuple[Case, ...]


@dataclass(frozen=True)
class PlanningTask:
    """All that is written: propositions, those true at first, the actions, and what the goal asks for.

    Of each of the `clauses` of the goal one value is needed.
    """

    propositions: tuple[Proposition, ...]
    initial: frozenset[Proposition]
    actions: tuple[GroundAction, ...]
    goal: Values
    clauses: tuple[tuple[Value, ...], ...] = ()
