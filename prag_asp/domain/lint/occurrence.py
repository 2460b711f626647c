"""Actions that can never occur, a start that the invariants forbid, and a goal that no plan reaches.

Whether an action can occur is asked of the encodings: one step, from a state in which nothing is known but what no
action changes. Unknown values can be learned, so an action that is rejected there is rejected in every state.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import clingo

from prag_asp.domain.facts import Facts, rows
from prag_asp.domain.grounding import Grounder
from prag_asp.domain.lint.closure import Literal, conflict, entailed, invariant_graph, spell
from prag_asp.domain.lint.origin import Origins, Place
from prag_asp.domain.lint.problem import Problem
from prag_asp.domain.lint.statement import Statement

Symbol = clingo.Symbol
STEP = 1_000_000_000
"""A step that no domain speaks of."""

STATE_PREDICATES = frozenset([("holds", 3), ("known", 3), ("changed", 2)])


def state_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield why no initial state or no goal state satisfies the invariants."""
    graph = invariant_graph(facts)
    for predicate, values in (("initially", facts.initially), ("goal", facts.goal)):
        pair = conflict(_literals(values), graph)
        if pair:
            place = max(_place(origins, (predicate,), literal) for literal in pair)
            yield Problem(*place, f"{predicate} makes {_together(pair)}, but the invariants forbid it; change one")


def occurrence_problems(
    grounder: Grounder, facts: Facts, statements: Sequence[Statement], origins: Origins
) -> Iterator[Problem]:
    """Yield the actions that the encodings reject in every state, and a goal that contradicts what never changes."""
    fixed = unchanging(grounder.control, facts, statements)
    explained: dict[tuple[str, Place, str], list[tuple[Symbol, str]]] = {}
    for action in _rejected(grounder, facts, fixed):
        place, kind, text = _reason(action, facts, fixed, origins)
        explained.setdefault((action.name, place, kind), []).append((action, text))
    for (_, place, _), found in explained.items():
        action, text = found[0]
        more = f" (so can't {len(found) - 1} more)" if len(found) > 1 else ""
        yield Problem(
            *place,
            f"{action} can never occur{more}: {text}; change that, or leave it out in the body of the rule for "
            f"action({_pattern(action)})",
        )
    pair = conflict([*fixed, *_literals(facts.goal)], invariant_graph(facts))
    if pair:
        place = _place(origins, ("goal",), pair[1])
        yield Problem(
            *place,
            f"the goal is never reached: it needs {spell(pair[1])}, but {spell(pair[0])} from the start "
            "and no action changes that; change the goal, or add an action",
        )


def unchanging(control: clingo.Control, facts: Facts, statements: Iterable[Statement]) -> tuple[Literal, ...]:
    """Return what is known at the start and what no action and no own rule changes."""
    if any(atom.signature in STATE_PREDICATES for each in statements if each.own and each.timed for atom in each.heads):
        return ()
    changing = {fluent for values in facts.postconditions.values() for fluent, _ in values}
    initial = ((fluent, str(value)) for fluent, value, time in rows(control, "holds", 3) if time.number == 0)
    return tuple(literal for literal in _literals(initial) if literal[0] not in changing)


def _rejected(grounder: Grounder, facts: Facts, fixed: Iterable[Literal]) -> Iterator[Symbol]:
    control = grounder.control
    known = (f"holds({fluent},{str(value).lower()},{STEP - 1})." for fluent, value in fixed)
    control.add("unchanging", [], "\n".join(known))
    grounder.ground([("unchanging", []), ("step", [clingo.Number(STEP)])])
    atoms = ((action, _occurs(control, action)) for action in facts.actions)
    choosable = [(action, literal) for action, literal in atoms if literal is not None]
    for action, literal in choosable:
        if control.solve(assumptions=[literal]).unsatisfiable:
            yield action


def _occurs(control: clingo.Control, action: Symbol) -> int | None:
    atom = control.symbolic_atoms[clingo.Function("occurs", [action, clingo.Number(STEP)])]
    return None if atom is None else atom.literal


def _reason(action: Symbol, facts: Facts, fixed: Sequence[Literal], origins: Origins) -> tuple[Place, str, str]:
    """Return the rule that rejects an action, the kind of the reason, and the reason in words."""
    graph = invariant_graph(facts)
    needed = _literals(facts.preconditions.get(action, ()))
    pair = conflict(needed, graph)
    if pair:
        place = max(_place(origins, ("precondition", action), literal) for literal in pair)
        return place, "needs", f"it needs {_together(pair)}{_forbidden(pair)}"
    pair = conflict([*fixed, *needed], graph)
    if pair:
        place = _place(origins, ("precondition", action), pair[1])
        return place, "fixed", f"it needs {spell(pair[1])}, but {spell(pair[0])} from the start and no action changes that"
    changed = {fluent for fluent, _ in facts.postconditions.get(action, ())}
    kept = [literal for literal in entailed([*fixed, *needed], graph) if literal[0] not in changed]
    made = _literals(facts.postconditions.get(action, ()))
    pair = conflict([*kept, *made], graph)
    if pair:
        place = _place(origins, ("postcondition", action), pair[1])
        verb = "makes" if pair[0] in made else "leaves"
        return place, "makes", f"it {verb} {_together(pair)}{_forbidden(pair)}"
    return origins.place("action", action), "other", "the encodings reject it in every state"


def _literals(values: Iterable[tuple[Symbol, str]]) -> list[Literal]:
    return [(fluent, value == "true") for fluent, value in values if value in ("true", "false")]


def _place(origins: Origins, before: tuple[str | Symbol, ...], literal: Literal) -> Place:
    predicate, *arguments = before
    value = clingo.Function("true" if literal[1] else "false")
    symbols = [each for each in arguments if isinstance(each, Symbol)]
    return origins.place(str(predicate), *symbols, literal[0], value)


def _together(pair: tuple[Literal, Literal]) -> str:
    return spell(pair[0]) if pair[0] == pair[1] else f"{spell(pair[0])} and {spell(pair[1])}"


def _forbidden(pair: tuple[Literal, Literal]) -> str:
    return "" if pair[0] != pair[1] and pair[0][0] == pair[1][0] else ", which the invariants forbid"


def _pattern(action: Symbol) -> str:
    return f"{action.name}({'...' if action.arguments else ''})" if action.arguments else action.name
