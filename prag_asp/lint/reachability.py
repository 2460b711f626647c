"""Actions that never occur because nothing ever makes what they need, such as those that wait for one another.

Reachability where nothing that was so is lost (the relaxed problem of Bonet and Geffner 2001, by which planners ground:
Helmert 2009), as ``encodings/reachable.lp`` says it of the facts of the base part.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import clingo

from prag_asp.lint.occurrence import STATE_PREDICATES
from prag_asp.lint.origin import Origins
from prag_asp.program.atoms import ground_atoms
from prag_asp.program.facts import Assignment, Facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.problem import Problem
from prag_asp.program.sources import REACHABLE, Source, read_sources
from prag_asp.program.syntax import Statement

MAKING = STATE_PREDICATES | {("occurs", 2)}
"""What tells of a state or an action otherwise than preconditions and postconditions do."""

LEFT_OUT = ("left_out", 1)
"""What keeps steps from trying an action that can never occur."""

CONFLICTS = "10000"
"""The search that is spent at most on what else the base part says; the relaxed steps need none."""


def relaxed_sources(encodings: Path) -> tuple[Source, ...]:
    """Return the program of relaxed steps in a folder of encodings; copies of older ones have none."""
    path = encodings / REACHABLE
    return read_sources(path, encodings) if path.is_file() else ()


class Unreached(NamedTuple):
    """The actions that never occur, the values of the goal that no state has, and one action where none ever occurs."""

    actions: tuple[clingo.Symbol, ...] = ()
    goal: tuple[tuple[clingo.Symbol, str], ...] = ()
    instead_of_all: clingo.Symbol | None = None


def find_unreached(grounder: Grounder, facts: Facts, statements: Sequence[Statement], encodings: Path) -> Unreached:
    """Return what is never reached of the actions of `facts`, none of them where that would be all, and of the goal.

    `grounder` holds the base part with the relaxed steps. None is found where rules other than the `encodings` make
    states, or read what is left out.
    """
    others = [each for each in statements if each.path.parent != encodings]
    reads = any(atom.signature == LEFT_OUT for each in others for atom in each.body)
    control = grounder.control
    if reads or _make_states(statements, encodings) or control.is_conflicting:
        return Unreached()
    grounder.state(clingo.Function("left_out", [term]) for term in facts.left_out)
    grounder.ground([("reachable", [])])
    solving = control.configuration.solve
    assert isinstance(solving, clingo.Configuration)
    solving.solve_limit = CONFLICTS
    with control.solve(yield_=True) as handle:
        model = handle.model()
        if model is None:
            return Unreached()
        reached, standing = (
            {
                tuple(arguments)
                for arguments, literal, is_fact in ground_atoms(control, *each)
                if is_fact or model.is_true(literal)
            }
            for each in (("may_occur", 1), ("may_stand", 2))
        )
    never = tuple(action for action in facts.actions if (action,) not in reached)
    missing = tuple(each for each in facts.goal if (each[0], clingo.Function(each[1])) not in standing)
    return Unreached(never, missing) if reached else Unreached((), missing, next(iter(facts.tried), None))


def steady_values(facts: Facts, statements: Sequence[Statement], encodings: Path) -> Assignment:
    """Return fluents that have the same value in every state, with it: what no action that is tried sets, stays.

    None is found where rules other than the `encodings` make states, or where invariants tell of fluents as well.
    """
    if facts.exclusive or facts.implies or facts.impossible or _make_states(statements, encodings):
        return ()
    changed = {fluent for action in facts.tried for fluent, _ in facts.postconditions.get(action, ())}
    return tuple(each for each in facts.initially if each[0] not in changed)


def _make_states(statements: Iterable[Statement], encodings: Path) -> bool:
    """Return whether rules other than the `encodings` make states."""
    others = (each for each in statements if each.path.parent != encodings)
    return any(atom.signature in MAKING for each in others for atom in each.heads)


def unreached_problems(found: Unreached, origins: Origins) -> Iterator[Problem]:
    """Yield why no plan leads to the goal, or why no plan has a step."""
    if found.goal:
        fluent, value = found.goal[0]
        place = origins.place("goal", fluent, clingo.Function(value))
        told = f"the goal is never reached: it needs {fluent} = {value}, and nothing that can occur makes that so"
        yield Problem(*place, f"{told}; change the goal, or add an action", "no-plan")
    elif found.instead_of_all is not None:
        told = f"no action can ever occur: {found.instead_of_all} and all others wait for what only actions make so"
        yield Problem(*origins.place("action", found.instead_of_all), f"{told}; mend the conditions", "no-plan")
