"""Actions that never occur because nothing ever makes what they need, such as those that wait for one another.

Reachability where nothing that was so is lost (the relaxed problem of Bonet and Geffner 2001, by which planners ground:
Helmert 2009), as ``encodings/reachable.lp`` says it of the facts of the base part.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import clingo

from prag_asp.errors import DomainError
from prag_asp.lint.occurrence import STATE_PREDICATES
from prag_asp.lint.reaching.relaxed import HOLDS, OCCURS, STRAY, Maker, Relaxed, makers_of
from prag_asp.lint.rule_origin import Origins
from prag_asp.program.atom_arrays import ground_atoms
from prag_asp.program.facts import Assignment, Facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.problem import Problem
from prag_asp.program.sources import REACHABLE, Source, read_sources
from prag_asp.program.syntax import Statement

MAKING = STATE_PREDICATES | {OCCURS}
"""What tells of a state or an action otherwise than preconditions and postconditions do."""

OPPOSITE = {"true": "false", "false": "true"}

Value = tuple[clingo.Symbol, str]
"""A fluent with one of its values."""

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
    goal: tuple[Value, ...] = ()
    instead_of_all: clingo.Symbol | None = None


class Reached(NamedTuple):
    """What may ever be so: the actions that may occur, the values that fluents may have, each with what else may be so.

    Values that `stand` are those with which all that invariants infer from them may be so. `setters` are values that
    own rules of a step may set, with the first rule that does.
    """

    actions: frozenset[clingo.Symbol]
    values: frozenset[Value]
    standing: frozenset[Value]
    setters: Mapping[Value, Maker]


def find_reached(grounder: Grounder, facts: Facts, statements: Sequence[Statement], encodings: Path) -> Reached | None:
    """Return what is reached of the fluents and actions of `facts`, None where that is not known.

    `grounder` holds the base part with the relaxed steps. None is known where rules other than the `encodings` read
    what is left out, make actions occur, make states elsewhere than in a step, or may give a value to what is no
    fluent; nor where the start depends on choices.
    """
    others = [each for each in statements if each.own or each.path.parent != encodings]
    reads = any(atom.signature == LEFT_OUT for each in others for atom in each.body)
    steps = [each for each in others if each.is_rule and each.part == "step"]
    elsewhere = any(_makes_elsewhere(each) for each in others if each.part != "step")
    control = grounder.control
    if reads or elsewhere or any(atom.signature == OCCURS for each in steps for atom in each.heads):
        return None
    open_start = any(not is_fact for _, _, is_fact in ground_atoms(control, *HOLDS))
    if control.is_conflicting or open_start:
        return None
    makers = makers_of(steps)
    grounder.state(clingo.Function("left_out", [term]) for term in facts.left_out)
    if makers:
        grounder.add("reachable", Relaxed(control, statements, steps).rules(makers))
    try:
        grounder.ground([("reachable", [])])
    except DomainError:  # of operations on more than the domain itself has them on
        return None
    solving = control.configuration.solve
    assert isinstance(solving, clingo.Configuration)
    solving.solve_limit = CONFLICTS
    with control.solve(yield_=True) as handle:
        model = handle.model()
        if model is None:
            return None
        occurring, holding, standing, setting, straying = (
            [
                arguments
                for arguments, literal, is_fact in ground_atoms(control, *each)
                if is_fact or model.is_true(literal)
            ]
            for each in (("may_occur", 1), ("may_hold", 2), ("may_stand", 2), ("_may_set", 3), (STRAY, 0))
        )
    if straying:
        return None
    setters: dict[Value, Maker] = {}
    for number, fluent, value in sorted(setting, reverse=True):
        setters[fluent, str(value)] = makers[number.number]
    values, stood = (frozenset((fluent, str(value)) for fluent, value in each) for each in (holding, standing))
    return Reached(frozenset(action for (action,) in occurring), values, stood, setters)


def _makes_elsewhere(statement: Statement) -> bool:
    """Return whether a rule that is not of a step makes a state, other than the first one, or an action occur."""
    heads = [atom for atom in statement.heads if atom.signature in MAKING]
    return any(statement.timed or atom.signature != HOLDS or atom.arguments[-1] != "0" for atom in heads)


def find_unreached(reached: Reached, facts: Facts) -> Unreached:
    """Return what is never reached of the actions, none of them where that would be all, and of the goal."""
    never = tuple(action for action in facts.actions if action not in reached.actions)
    missing = tuple(each for each in facts.goal if each not in reached.standing)
    return Unreached(never, missing) if reached.actions else Unreached((), missing, next(iter(facts.tried), None))


def steady_values(reached: Reached, facts: Facts) -> Assignment:
    """Return fluents that have the same value in every state, with it: nothing ever gives them the other one.

    None is found where invariants tell of fluents as well.
    """
    if facts.exclusive or facts.implies or facts.impossible:
        return ()
    return tuple(each for each in facts.initially if (each[0], OPPOSITE[each[1]]) not in reached.values)


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
