"""Why a task space is empty, and what would have to change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from prag_asp.errors import QueryError
from prag_asp.logic.formula.emptiness import LiftableLines, Occurring, has_plan
from prag_asp.logic.formula.liftable import RestrictingLine
from prag_asp.logic.ground.program import whole_program
from prag_asp.program.entity_names import action_name
from prag_asp.program.sources import Program
from prag_asp.space.conditions.clause_kinds import Clause
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.conditions.conditioned_domain import conditioned
from prag_asp.space.engines.prefix import parse_prefix

if TYPE_CHECKING:
    from prag_asp.atom import Atom
    from prag_asp.program.facts import Facts
    from prag_asp.space.task_space import TaskSpace


@dataclass(frozen=True)
class Reasons:
    """What together leaves a space no task: conditions of the space, and lines of the domain.

    Without any one of them, and of all lines that restrict plans just the others, there is a task. Without lines, what
    the domain declares has none, whatever its lines forbid.
    """

    conditions: tuple[Clause, ...]
    lines: tuple[RestrictingLine, ...]


def why_empty(
    space: TaskSpace, *, action: str | Atom | None = None, step: int | None = None, smallest: bool = False
) -> Reasons | None:
    """Return why a space has no task, None where it has one.

    With `action`, an action or the name of some, only tasks count that have it, with `step` as their action of that
    number, from 1. What a line does to a fluent that is not among the reasons may be anything: a postcondition that is
    not among them changes its fluent to any value. With `smallest`, there are as few lines as can be.

    Raises:
        QueryError: there is no such action or step.
        EngineError: the program has no counterpart in clauses.
    """
    occurring = _occurring(space, action, step)
    clauses: Sequence[Clause] = space.condition.clauses
    if has_plan(_program(space, clauses), space.length, occurring):
        return None
    for clause in space.condition.clauses:
        rest = [each for each in clauses if each != clause]
        if not has_plan(_program(space, rest), space.length, occurring):
            clauses = rest
    with LiftableLines(_program(space, clauses), space.length, occurring) as lines:
        return Reasons(tuple(clauses), lines.conflict(smallest=smallest))


def fewest_changes(
    space: TaskSpace, *, action: str | Atom | None = None, step: int | None = None
) -> tuple[tuple[RestrictingLine, ...], ...]:
    """Return the lines of the domain each of which, removed, leaves an empty space a task, all its conditions kept.

    Where no single line does, it is one smallest set of lines; where all lines together do not, there is none. A space
    that has a task needs no change: the only set is the empty one. Of `action` and `step`, see `why_empty`.

    Raises:
        QueryError: there is no such action or step.
        EngineError: the program has no counterpart in clauses.
    """
    program, occurring = _program(space, space.condition.clauses), _occurring(space, action, step)
    if has_plan(program, space.length, occurring):
        return ((),)
    with LiftableLines(program, space.length, occurring) as lines:
        return lines.changes()


def _program(space: TaskSpace, clauses: Sequence[Clause]) -> Program:
    """Return the program of a space's domain under some conditions, none of its actions left out beforehand."""
    domain = conditioned(space.domain, Condition(tuple(clauses)))
    return whole_program(replace(domain, facts=replace(domain.facts, pruned=(), unreachable=(), static=())))


def _occurring(space: TaskSpace, action: str | Atom | None, step: int | None) -> Occurring | None:
    """Return which actions are asked for, and when; None where no action is.

    Raises:
        QueryError: there is no such action or step.
    """
    if action is None:
        if step is not None:
            raise QueryError(f"step {step} of which action? name the action, too")
        return None
    if step is not None and not 1 <= step <= space.length:
        known = f"its steps are 1 to {space.length}" if space.length else "it has none"
        raise QueryError(f"a task of length {space.length} has no step {step}; {known}")
    facts: Facts = space.domain.facts
    text = str(action)
    parse_prefix([text], "plan", facts)
    asked = {each for each in facts.actions if text in (action_name(each), str(each))}
    steps = range(1, space.length + 1) if step is None else (step,)
    return [(each, at) for each in facts.actions if each in asked for at in steps]
