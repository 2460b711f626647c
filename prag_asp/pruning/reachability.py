"""Relaxed reachability: actions never occur if their preconditions are unreachable in the relaxed problem.

In the relaxed problem, a value that has been reached remains reached (Bonet and Geffner 2001; for its use in grounding,
see Helmert 2009). It is defined on the facts of the base part, in ``encodings/reachable.lp``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import clingo

from prag_asp.errors import DomainError
from prag_asp.program.atom_arrays import ground_atoms
from prag_asp.program.facts import Facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import HOLDS, MAY_HOLD, MAY_OCCUR, MAY_SET, MAY_STAND, OCCURS, PRUNED
from prag_asp.program.sources import REACHABLE, Source, read_sources
from prag_asp.program.syntax import Statement
from prag_asp.pruning.rejected_actions import STATE_PREDICATES
from prag_asp.pruning.relaxed_rules import STRAY, FluentSetter, RelaxedRules, fluent_setters

ValuedFluent = tuple[clingo.Symbol, str]
"""A fluent with one of its values."""

CONFLICTS = "10000"
"""The limit on conflicts that clingo spends on the rest of the base part; the relaxed steps need no conflicts."""


def relaxed_sources(encodings: Path) -> tuple[Source, ...]:
    """Return the program of relaxed steps in a folder of encodings, which is empty if the folder has none."""
    path = encodings / REACHABLE
    return read_sources(path, encodings) if path.is_file() else ()


class RelaxedReach(NamedTuple):
    """The relaxed-reachable actions and values of fluents.

    A value is `standing` if all values that the invariants infer from it are reachable as well. `setters` maps each
    value that user rules of a step may set to the first such rule.
    """

    actions: frozenset[clingo.Symbol]
    values: frozenset[ValuedFluent]
    standing: frozenset[ValuedFluent]
    setters: Mapping[ValuedFluent, FluentSetter]


class Unreachable(NamedTuple):
    """The unreachable actions and goal values; if no action is reachable, `instead_of_all` is one of them."""

    actions: tuple[clingo.Symbol, ...] = ()
    goal: tuple[ValuedFluent, ...] = ()
    instead_of_all: clingo.Symbol | None = None


def find_relaxed_reach(
    grounder: Grounder, facts: Facts, statements: Sequence[Statement], encodings: Path
) -> RelaxedReach | None:
    """Return the relaxed-reachable fluent values and actions of `facts`, or None if they are unknown.

    `grounder` contains the base part and the relaxed steps. Reachability is unknown if rules outside of the `encodings`
    read which actions are pruned, derive occurring actions, derive states outside of a step, or may assign a value to a
    term that is not a fluent, or if the initial state depends on choices.
    """
    others = [each for each in statements if each.own or each.path.parent != encodings]
    if any(map(_exceeds_steps, others)):
        return None
    control = grounder.control
    open_start = any(not is_fact for _, _, is_fact in ground_atoms(control, *HOLDS))
    if control.is_conflicting or open_start:
        return None
    steps = [each for each in others if each.is_rule and each.part == "step"]
    setters = fluent_setters(steps)
    grounder.state(PRUNED(term) for term in facts.pruned)
    if setters:
        grounder.add("reachable", RelaxedRules(control, statements, steps).rules(setters))
    try:
        grounder.ground([("reachable", [])])
    except DomainError:  # an operation that only the relaxed rules run on these values is undefined
        return None
    solving = control.configuration.solve
    assert isinstance(solving, clingo.Configuration)
    solving.solve_limit = CONFLICTS
    with control.solve(yield_=True) as handle:
        model = handle.model()
        if model is None:
            return None
        occurring, holding, standing, setting, stray = (
            [
                arguments
                for arguments, literal, is_fact in ground_atoms(control, *each)
                if is_fact or model.is_true(literal)
            ]
            for each in (MAY_OCCUR, MAY_HOLD, MAY_STAND, MAY_SET, (STRAY, 0))
        )
    if stray:
        return None
    set_by: dict[ValuedFluent, FluentSetter] = {}
    for number, fluent, value in sorted(setting, reverse=True):
        set_by[fluent, str(value)] = setters[number.number]
    values, stood = (frozenset((fluent, str(value)) for fluent, value in each) for each in (holding, standing))
    return RelaxedReach(frozenset(action for (action,) in occurring), values, stood, set_by)


def _exceeds_steps(statement: Statement) -> bool:
    """Return whether a statement reads pruned actions, derives occurring actions, or derives a state outside a step.

    A fact of the initial state does not count.
    """
    if any(atom.signature == PRUNED for atom in statement.body):
        return True
    for atom in statement.heads:
        initial = atom.signature == HOLDS and not statement.timed and atom.arguments[-1] == "0"
        of_state = statement.part != "step" and atom.signature in STATE_PREDICATES and not initial
        if atom.signature == OCCURS or of_state:
            return True
    return False
