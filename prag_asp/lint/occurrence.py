"""Actions that can never occur, a start that the invariants forbid, and a goal that no plan reaches.

An action that is rejected where nothing is known but what never changes is rejected in every state, for what is
unknown can be learned. What only such actions would change does not change either, which may reject more of them:
by induction over the steps, all of them are right to be left out together. The invariants tell which actions are
suspect and why; the encodings have the last word.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import clingo

from prag_asp.lint.rule_origin import Origins, Place
from prag_asp.program.facts import Assignment, Facts, rows
from prag_asp.program.grounding import Grounder
from prag_asp.program.invariants import FluentValue, Reasons, conflict, entailed, invariant_graph, spell
from prag_asp.program.problem import Problem
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Signature, Statement

STEP = 1_000_000_000
"""A step that no domain speaks of."""

CHANGED = ("changed", 2)
STATE_PREDICATES = frozenset([("holds", 3), ("known", 3), CHANGED])


class Reason(NamedTuple):
    """Why an action is rejected: the predicate and the fluent's value that state it, and the reason in words."""

    predicate: str
    value: FluentValue
    text: str


Rejected = Mapping[clingo.Symbol, Reason]
"""The actions that can never occur."""


class Occurrence(NamedTuple):
    """Which actions can never occur, and what is known in every state."""

    rejected: Rejected
    fixed: Reasons


def state_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield why no initial state or no goal state satisfies the invariants."""
    graph = invariant_graph(facts)
    for predicate, values in (("initially", facts.initially), ("goal", facts.goal)):
        pair = conflict(entailed(fluent_values(values), graph))
        if pair:
            place = max(_place(origins, predicate, value) for value in pair)
            yield Problem(*place, f"{predicate} makes {_together(pair)}, but the invariants forbid it; change one")


def find_occurrence(
    program: Program, control: clingo.Control, facts: Facts, statements: Sequence[Statement]
) -> Occurrence:
    """Return the actions that are rejected in every state; `program` is that of a step without own rules.

    Own rules of a step may change the state: what they may change is not held to stay as it is.
    """
    own = set(chain.from_iterable(map(stated_of_steps, statements)))
    start = [] if own else initial_values(control)
    able: set[clingo.Symbol] = set()
    while True:
        found = _Search(facts, start, frames=CHANGED not in own, able=able).run()
        confirmed = set(rejected_by_encodings(program, found.rejected, found.fixed))
        if len(confirmed) == len(found.rejected):
            return found
        able |= found.rejected.keys() - confirmed


def stated_of_steps(statement: Statement) -> Iterator[Signature]:
    """Yield the predicates by which an own rule, of a step or of the base part, tells of states after the start."""
    for atom in statement.heads if statement.own else ():
        if atom.signature in STATE_PREDICATES and (statement.timed or atom.arguments[-1] != "0"):
            yield atom.signature


def occurrence_problems(found: Occurrence, facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield a warning for all actions of one name that one rule rejects, or one alone where none is left."""
    left = len(facts.actions) - len(found.rejected)
    if found.rejected and not left:
        action, reason = next(iter(found.rejected.items()))
        place = _place(origins, reason.predicate, reason.value, action)
        told = f"no action can ever occur: {action} cannot, for {reason.text}; mend the conditions"
        yield Problem(*place, told, "no-plan")
        return
    alike: dict[tuple[str, Place], list[clingo.Symbol]] = {}
    for action, reason in found.rejected.items():
        place = _place(origins, reason.predicate, reason.value, action)
        alike.setdefault((action.name, place), []).append(action)
    for (name, place), actions in alike.items():
        more = f" and {len(actions) - 1} more like it" if len(actions) > 1 else ""
        pattern = f"{name}(...)" if actions[0].arguments else name
        yield Problem(
            *place,
            f"{actions[0]}{more} can never occur: {found.rejected[actions[0]].text}; "
            f"mend the conditions, or exclude it in the body of action({pattern})",
            "never-occurs",
        )


def goal_problems(found: Occurrence, facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield why the goal contradicts what never changes."""
    pair = conflict(entailed(fluent_values(facts.goal), invariant_graph(facts)), found.fixed)
    if pair:
        changed = any(pair[1][0] == fluent for values in facts.postconditions.values() for fluent, _ in values)
        yield Problem(
            *_place(origins, "goal", pair[1]),
            f"the goal is never reached: it needs {spell(pair[1])}, but {spell(pair[0])} from the start and no action "
            f"{'that can occur ' if changed else ''}changes that; change the goal, or add an action",
            "no-plan",
        )


def initial_values(control: clingo.Control) -> list[FluentValue]:
    """Return what is known at the start."""
    start = clingo.Number(0)
    return fluent_values([(fluent, str(value)) for fluent, value, time in rows(control, "holds", 3) if time == start])


class _Search:
    """Finds the actions that the invariants reject in every state, and with them what never changes.

    Actions that are `able` to occur are not asked. Without `frames`, a fluent may change that its action does not set.
    """

    def __init__(
        self, facts: Facts, start: Iterable[FluentValue], *, frames: bool, able: Collection[clingo.Symbol]
    ) -> None:
        self._facts, self._frames, self._able = facts, frames, able
        self._graph = invariant_graph(facts)
        self._start = dict(start)
        self._changing = Counter(fluent for a in facts.actions for fluent in self._changed(a))
        self._declared = set(self._changing)
        self._fixed: dict[FluentValue, FluentValue] = {}
        self._demanding: dict[FluentValue, list[clingo.Symbol]] = {}
        self._rejected: dict[clingo.Symbol, Reason] = {}

    def run(self) -> Occurrence:
        """Return what is found."""
        self._fix(value for value in self._start.items() if not self._changing[value[0]])
        waiting: list[clingo.Symbol] = []
        for action in self._facts.actions:
            if action not in self._able:
                self._reject(action, waiting)
        if waiting:
            self._find_demanding()
        while waiting:
            for fluent in self._changed(waiting.pop()):
                self._changing[fluent] -= 1
                if not self._changing[fluent] and fluent in self._start:
                    for fixed in self._fix([(fluent, self._start[fluent])]):
                        for action in self._demanding.get(fixed, ()):
                            if action not in self._rejected:
                                self._reject(action, waiting)
        return Occurrence({a: self._rejected[a] for a in self._facts.actions if a in self._rejected}, self._fixed)

    def _fix(self, values: Iterable[FluentValue]) -> list[FluentValue]:
        """Keep what never changes, and what follows from it; return what of it is new."""
        new = {value: why for value, why in entailed(values, self._graph).items() if value not in self._fixed}
        self._fixed |= new
        return list(new)

    def _reject(self, action: clingo.Symbol, waiting: list[clingo.Symbol]) -> None:
        """Note an action as rejected, where there is a reason."""
        reason = self._reason(action)
        if reason is not None:
            self._rejected[action] = reason
            waiting.append(action)

    def _find_demanding(self) -> None:
        """Find the actions that are rejected once a value never changes that may turn out so."""
        may_be_fixed = entailed(self._start.items(), self._graph)
        for action in self._facts.actions:
            if action not in self._able and action not in self._rejected:
                needed, after = self._around(action)
                for fluent, value in {**needed, **after}:
                    if (fluent, not value) in may_be_fixed:
                        self._demanding.setdefault((fluent, not value), []).append(action)

    def _changed(self, action: clingo.Symbol) -> set[clingo.Symbol]:
        return {fluent for fluent, _ in self._facts.postconditions.get(action, ())}

    def _around(self, action: clingo.Symbol) -> tuple[Reasons, Reasons]:
        """Return what an action needs and what is so after it, with all that follows from these."""
        changed = self._changed(action)
        needed = entailed(fluent_values(self._facts.preconditions.get(action, ())), self._graph)
        kept = [value for value in needed if value[0] not in changed] if self._frames else []
        made = fluent_values(self._facts.postconditions.get(action, ()))
        return needed, entailed([*kept, *made], self._graph)

    def _reason(self, action: clingo.Symbol) -> Reason | None:
        """Return why the invariants and what never changes reject an action, None where they do not."""
        needed, after = self._around(action)
        pair = conflict(needed)
        if pair:
            return Reason("precondition", pair[1], f"it needs {_together(pair)}{_forbidden(pair)}")
        pair = conflict(needed, self._fixed)
        if pair:
            able = "that can occur " if pair[0][0] in self._declared else ""
            text = f"it needs {spell(pair[1])}, but {spell(pair[0])} from the start and no action {able}changes that"
            return Reason("precondition", pair[1], text)
        pair = conflict(after) or conflict(after, self._fixed)
        if pair:
            made = fluent_values(self._facts.postconditions.get(action, ()))
            stated = pair[1] if pair[1] in made else pair[0]
            predicate = "postcondition" if stated in made else "precondition"
            verb = "it makes" if pair[0] in made and pair[1] in made else "after it,"
            return Reason(predicate, stated, f"{verb} {_together(pair)}{_forbidden(pair)}")
        return None


def rejected_by_encodings(
    program: Program, actions: Collection[clingo.Symbol], known: Iterable[FluentValue]
) -> Collection[clingo.Symbol]:
    """Return those of some actions that a step rejects from a state where only `known` is known."""
    if not actions:
        return ()
    grounder = Grounder(program)
    grounder.ground([("base", [])])
    grounder.state(holding(known, STEP - 1))
    grounder.ground([("step", [clingo.Number(STEP)])])
    atoms = grounder.control.symbolic_atoms
    found = {action: atoms[clingo.Function("occurs", [action, clingo.Number(STEP)])] for action in actions}
    asked = {atom.literal: action for action, atom in found.items() if atom is not None}
    while asked:
        with grounder.control.backend() as backend:
            some = backend.add_atom()
            for literal in asked:
                backend.add_rule([some], [literal])
        with grounder.control.solve(assumptions=[some], yield_=True) as handle:
            model = handle.model()
            if model is None:
                break
            able = [literal for literal in asked if model.is_true(literal)]
        for literal in able:
            del found[asked.pop(literal)]
    return found.keys()


def holding(known: Iterable[FluentValue], time: int) -> Iterator[clingo.Symbol]:
    """Yield the atoms that say that fluents have these values after a step."""
    for fluent, value in known:
        yield clingo.Function("holds", [fluent, _spelled(value), clingo.Number(time)])


def fluent_values(values: Assignment | list[tuple[clingo.Symbol, str]]) -> list[FluentValue]:
    """Return the values that are known; unknown ones state nothing."""
    return [(fluent, value == "true") for fluent, value in values if value in ("true", "false")]


def _spelled(value: bool) -> clingo.Symbol:
    return clingo.Function("true" if value else "false")


def _place(origins: Origins, predicate: str, value: FluentValue, *before: clingo.Symbol) -> Place:
    return origins.place(predicate, *before, value[0], _spelled(value[1]))


def _together(pair: tuple[FluentValue, FluentValue]) -> str:
    return spell(pair[0]) if pair[0] == pair[1] else f"{spell(pair[0])} and {spell(pair[1])}"


def _forbidden(pair: tuple[FluentValue, FluentValue]) -> str:
    return "" if pair[0] != pair[1] and pair[0][0] == pair[1][0] else ", which the invariants forbid"
