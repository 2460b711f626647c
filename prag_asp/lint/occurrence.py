"""Actions that can never occur, a start that the invariants forbid, and a goal that no plan reaches.

An action that is rejected where nothing is known but what never changes is rejected in every state, for
what is unknown can be learned. The invariants tell which actions are suspect and why; the encodings have
the last word.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import clingo

from prag_asp.lint.origin import Origins, Place
from prag_asp.program.facts import Assignment, Facts, rows
from prag_asp.program.grounding import Grounder
from prag_asp.program.invariants import FluentValue, Graph, Reasons, conflict, entailed, invariant_graph, spell
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import Statement

STEP = 1_000_000_000
"""A step that no domain speaks of."""

STATE_PREDICATES = frozenset([("holds", 3), ("known", 3), ("changed", 2)])


class Reason(NamedTuple):
    """Why an action is rejected: the predicate and the literal that state it, and the reason in words."""

    predicate: str
    literal: FluentValue
    text: str


def state_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield why no initial state or no goal state satisfies the invariants."""
    graph = invariant_graph(facts)
    for predicate, values in (("initially", facts.initially), ("goal", facts.goal)):
        pair = conflict(entailed(fluent_values(values), graph))
        if pair:
            place = max(_place(origins, predicate, literal) for literal in pair)
            yield Problem(*place, f"{predicate} makes {_together(pair)}, but the invariants forbid it; change one")


def occurrence_problems(
    grounder: Grounder, facts: Facts, statements: Sequence[Statement], origins: Origins
) -> Iterator[Problem]:
    """Yield the actions that are rejected in every state, and a goal that contradicts what never changes."""
    graph = invariant_graph(facts)
    fixed = entailed(unchanging(grounder.control, facts, statements), graph)
    suspects = {action: _reason(action, facts, graph, fixed) for action in facts.actions}
    reasons = {action: reason for action, reason in suspects.items() if reason is not None}
    yield from _rejections(_rejected(grounder, reasons, fixed), reasons, origins)
    pair = conflict(entailed(fluent_values(facts.goal), graph), fixed)
    if pair:
        yield Problem(
            *_place(origins, "goal", pair[1]),
            f"the goal is never reached: it needs {spell(pair[1])}, but {spell(pair[0])} from the start "
            "and no action changes that; change the goal, or add an action",
        )


def unchanging(control: clingo.Control, facts: Facts, statements: Iterable[Statement]) -> list[FluentValue]:
    """Return what is known at the start and what no action and no own rule changes."""
    if any(atom.signature in STATE_PREDICATES for each in statements if each.own and each.timed for atom in each.heads):
        return []
    changing = {fluent for values in facts.postconditions.values() for fluent, _ in values}
    start = clingo.Number(0)
    initial = [(fluent, str(value)) for fluent, value, time in rows(control, "holds", 3) if time == start]
    return [literal for literal in fluent_values(initial) if literal[0] not in changing]


def _reason(action: clingo.Symbol, facts: Facts, graph: Graph, fixed: Reasons) -> Reason | None:
    """Return why the invariants and what never changes reject an action, None where they do not."""
    needed = entailed(fluent_values(facts.preconditions.get(action, ())), graph)
    pair = conflict(needed)
    if pair:
        return Reason("precondition", pair[1], f"it needs {_together(pair)}{_forbidden(pair)}")
    pair = conflict(needed, fixed)
    if pair:
        text = f"it needs {spell(pair[1])}, but {spell(pair[0])} from the start and no action changes that"
        return Reason("precondition", pair[1], text)
    effects = facts.postconditions.get(action, ())
    changed = {fluent for fluent, _ in effects}
    kept = [literal for literal in needed if literal[0] not in changed]
    made = fluent_values(effects)
    after = entailed([*kept, *made], graph)
    pair = conflict(after) or conflict(after, fixed)
    if pair:
        stated = pair[1] if pair[1] in made else pair[0]
        predicate = "postcondition" if stated in made else "precondition"
        verb = "it makes" if pair[0] in made and pair[1] in made else "after it,"
        return Reason(predicate, stated, f"{verb} {_together(pair)}{_forbidden(pair)}")
    return None


def _rejected(
    grounder: Grounder, suspects: Mapping[clingo.Symbol, Reason], fixed: Iterable[FluentValue]
) -> Iterator[clingo.Symbol]:
    """Yield the suspects that the encodings reject in a step from a state where only `fixed` is known."""
    if not suspects:
        return
    control = grounder.control
    known = (f"holds({fluent},{str(value).lower()},{STEP - 1})." for fluent, value in fixed)
    control.add("unchanging", [], "\n".join(known))
    grounder.ground([("unchanging", []), ("step", [clingo.Number(STEP)])])
    for action in suspects:
        atom = control.symbolic_atoms[clingo.Function("occurs", [action, clingo.Number(STEP)])]
        if atom is not None and control.solve(assumptions=[atom.literal]).unsatisfiable:
            yield action


def _rejections(
    actions: Iterable[clingo.Symbol], reasons: Mapping[clingo.Symbol, Reason], origins: Origins
) -> Iterator[Problem]:
    """Yield one problem for all actions of one name that one rule rejects."""
    alike: dict[tuple[str, Place], list[clingo.Symbol]] = {}
    for action in actions:
        reason = reasons[action]
        alike.setdefault((action.name, _place(origins, reason.predicate, reason.literal, action)), []).append(action)
    for (name, place), found in alike.items():
        more = f" and {len(found) - 1} more like it" if len(found) > 1 else ""
        pattern = f"{name}(...)" if found[0].arguments else name
        yield Problem(
            *place,
            f"{found[0]}{more} can never occur: {reasons[found[0]].text}; "
            f"mend the conditions, or exclude it in the body of action({pattern})",
        )


def fluent_values(values: Assignment | list[tuple[clingo.Symbol, str]]) -> list[FluentValue]:
    """Return what values state as literals; unknown ones state nothing."""
    return [(fluent, value == "true") for fluent, value in values if value in ("true", "false")]


def _place(origins: Origins, predicate: str, literal: FluentValue, *before: clingo.Symbol) -> Place:
    return origins.place(predicate, *before, literal[0], clingo.Function("true" if literal[1] else "false"))


def _together(pair: tuple[FluentValue, FluentValue]) -> str:
    return spell(pair[0]) if pair[0] == pair[1] else f"{spell(pair[0])} and {spell(pair[1])}"


def _forbidden(pair: tuple[FluentValue, FluentValue]) -> str:
    return "" if pair[0] != pair[1] and pair[0][0] == pair[1][0] else ", which the invariants forbid"
