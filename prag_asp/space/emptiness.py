"""Why a task space is empty, and which changes would make it nonempty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from prag_asp.errors import EngineError, QueryError
from prag_asp.logic.formula.emptiness import LiftableLines, Occurring, has_plan
from prag_asp.logic.formula.liftable import RestrictingLine
from prag_asp.logic.ground.program import whole_program
from prag_asp.program.entity_names import action_name
from prag_asp.program.sources import Program
from prag_asp.space.conditions.clause_kinds import Clause
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.conditions.conditioned_domain import conditioned
from prag_asp.space.engines.prefix import parse_prefix
from prag_asp.space.engines.reachability import Explorer
from prag_asp.space.limits import limit_error

if TYPE_CHECKING:
    from prag_asp.atom import Atom
    from prag_asp.program.facts import Facts
    from prag_asp.space.automaton.automaton import Automaton
    from prag_asp.space.task_space import TaskSpace


LONGEST = tuple(2**power for power in range(2, 11))
"""Lengths up to which the shortest task is searched, one after the other; each search takes about as long as all
previous searches together."""

MOST_STATES = 50_000
"""Number of states after which the search for the shortest task ends; exploring that many takes a second or two."""


@dataclass(frozen=True)
class Reasons:
    """A minimal set of conditions of a space and lines of its domain that together leave no task.

    If any one of them is removed, and only the others apply, there is a task. If there are no lines, the conditions
    exclude every task by themselves or, if there are no conditions either, the declarations of the domain do.
    """

    conditions: tuple[Clause, ...]
    lines: tuple[RestrictingLine, ...]


def why_empty(
    space: TaskSpace, *, action: str | Atom | None = None, step: int | None = None, smallest: bool = False
) -> Reasons | None:
    """Return why a space has no task, or None if it has one.

    With `action`, which is an action or an action name, only tasks that contain it count; with `step`, which counts
    from 1, only tasks that contain it at that step. A postcondition that is not among the reasons may change its fluent
    to any value. With `smallest`, the number of lines is minimal.

    Raises:
        QueryError: there is no such action or step.
        EngineError: the program cannot be translated to clauses.
    """
    space.engines.require_program("an explanation")
    occurring = _occurring(space, action, step)
    clauses: Sequence[Clause] = space.condition.clauses
    if has_plan(_program(space, clauses), space.length, occurring):
        return None
    for clause in space.condition.clauses:
        rest = [other for other in clauses if other != clause]
        if not has_plan(_program(space, rest), space.length, occurring):
            clauses = rest
    with LiftableLines(_program(space, clauses), space.length, occurring) as lines:
        return Reasons(tuple(clauses), lines.conflict(smallest=smallest))


def fewest_changes(
    space: TaskSpace, *, action: str | Atom | None = None, step: int | None = None
) -> tuple[tuple[RestrictingLine, ...], ...]:
    """Return each line of the domain whose removal alone makes an empty space nonempty; all conditions are kept.

    If no single line suffices, the result is one set of lines of minimal size; if all lines together do not suffice,
    the result is empty. For a nonempty space, the only element of the result is the empty set of lines. For `action`
    and `step`, see `why_empty`.

    Raises:
        QueryError: there is no such action or step.
        EngineError: the program cannot be translated to clauses.
    """
    program, occurring = _program(space, space.condition.clauses), _occurring(space, action, step)
    if has_plan(program, space.length, occurring):
        return ((),)
    with LiftableLines(program, space.length, occurring) as lines:
        return lines.changes()


def shortest_length(space: TaskSpace) -> int | None:
    """Return the length, at least 1, of a shortest task under a space's conditions, or None if there is no task.

    The length of the space does not matter. The result is found by breadth-first search in the automaton for all
    lengths.

    Raises:
        LimitReached: the automaton has more than `MOST_STATES` states, or a limit of the space is reached.
        EngineError: the step is not a function of the state and the action, or the search ends after `LONGEST` actions.
    """
    clock = space.engines.limits.begin()
    for longest in LONGEST:
        explorer = Explorer(space.at(longest).engines.model, "plan", merge=False)
        reach = explorer.reach(explorer.transition(), longest, clock, lambda extent: extent.states > MOST_STATES)
        automaton = reach.completions.automaton
        if reach.stop:
            raise limit_error(reach.stop, 0, "plan", longest, reach.states)
        steps = _steps_to_acceptance(automaton)
        if steps is not None and steps <= longest:
            return steps
        if automaton.horizon is None and space.condition.up_to(longest) == space.condition:  # exact for all lengths
            return steps
    raise EngineError(f"plans of more than {LONGEST[-1]} actions are not searched")


def _steps_to_acceptance(automaton: Automaton) -> int | None:
    """Return the length, at least 1, of a shortest word, or None if the automaton has no such word."""
    reached, steps = np.zeros(automaton.states, dtype=np.bool_), 0
    edges = np.flatnonzero(automaton.sources == 0)
    while len(edges):
        steps += 1
        found = np.unique(automaton.targets[edges])
        if automaton.accepting[found].any():
            return steps
        new = found[~reached[found]]
        reached[new] = True
        edges = np.flatnonzero(np.isin(automaton.sources, new))
    return None


def _program(space: TaskSpace, clauses: Sequence[Clause]) -> Program:
    """Return the program of a space's domain under the given conditions, without pruning any actions."""
    domain = conditioned(space.domain, Condition(tuple(clauses)))
    return whole_program(replace(domain, facts=replace(domain.facts, pruned=(), unreachable=(), static=())))


def _occurring(space: TaskSpace, action: str | Atom | None, step: int | None) -> Occurring | None:
    """Return the requested actions with their possible steps, or None if no action is requested.

    Raises:
        QueryError: there is no such action or step.
    """
    if action is None:
        if step is not None:
            raise QueryError(f"step {step} of which action? name the action as well")
        return None
    if step is not None and not 1 <= step <= space.length:
        steps_text = f"its steps are 1 to {space.length}" if space.length else "it has none"
        raise QueryError(f"a task of length {space.length} has no step {step}; {steps_text}")
    facts: Facts = space.domain.facts
    text = str(action)
    parse_prefix([text], "plan", facts)
    steps = range(1, space.length + 1) if step is None else (step,)
    actions = [candidate for candidate in facts.actions if text in (action_name(candidate), str(candidate))]
    return [(candidate, at) for candidate in actions for at in steps]
