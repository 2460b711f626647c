"""Actions that every state rejects, and the values of fluents that never change.

An action that is rejected where nothing is known but what never changes is rejected in every state, because what is
unknown can be learned. What only such actions would change does not change either, which may reject more of them. By
induction over the steps, all of them can be pruned together. The invariants find the suspects and the reasons; the
encodings confirm them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import clingo

from prag_asp.program.facts import Assignment, Facts, rows
from prag_asp.program.grounding import Grounder
from prag_asp.program.invariants import FluentValue, Reasons, conflict, entailed, invariant_graph
from prag_asp.program.predicates import CHANGED, HOLDS, KNOWN, OCCURS
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Signature, Statement

STEP = 1_000_000_000
"""The number of the step that is ground: no domain mentions it."""

STATE_PREDICATES: frozenset[Signature] = frozenset([HOLDS, KNOWN, CHANGED])
"""The predicates that describe states."""


class Rejection(NamedTuple):
    """Why an action is rejected: two values of fluents that contradict each other, or one that contradicts itself.

    `predicate` and `stated` are the precondition or postcondition to blame. The values contradict each other in what
    the action `needs`, or after it; with what never changes where `static`. `first` is then the static value. `makes`
    says that the action sets both; `may_change` that some action, which can never occur, would change the static one.
    """

    predicate: str
    stated: FluentValue
    first: FluentValue
    second: FluentValue
    needs: bool
    static: bool = False
    makes: bool = False
    may_change: bool = False


class RejectedActions(NamedTuple):
    """The actions that can never occur, each with the reason, and the values that fluents have in every state."""

    rejections: Mapping[clingo.Symbol, Rejection]
    static: Reasons


def find_rejected_actions(
    program: Program, control: clingo.Control, facts: Facts, statements: Sequence[Statement]
) -> RejectedActions:
    """Return the actions that every state rejects; `program` is that of a step without user rules.

    User rules of a step may change any state: with them, no initial value is taken to be static.
    """
    stated = set(chain.from_iterable(map(state_predicates_of, statements)))
    start = [] if stated else initial_values(control)
    able: set[clingo.Symbol] = set()
    while True:
        found = _RejectionSearch(facts, start, frames=CHANGED not in stated, able=able).run()
        confirmed = set(rejected_by_encodings(program, found.rejections, found.static))
        if len(confirmed) == len(found.rejections):
            return found
        able |= found.rejections.keys() - confirmed


def state_predicates_of(statement: Statement) -> Iterator[Signature]:
    """Yield the predicates by which a user rule derives states after the initial one."""
    for atom in statement.heads if statement.own else ():
        if atom.signature in STATE_PREDICATES and (statement.timed or atom.arguments[-1] != "0"):
            yield atom.signature


def initial_values(control: clingo.Control) -> list[FluentValue]:
    """Return the known values of the initial state."""
    start = clingo.Number(0)
    return fluent_values([(fluent, str(value)) for fluent, value, time in rows(control, *HOLDS) if time == start])


class _RejectionSearch:
    """Finds the actions that the invariants reject in every state, and with them the static values.

    Actions that are `able` to occur are skipped. Without `frames`, a fluent may change though its action does not set
    it.
    """

    def __init__(
        self, facts: Facts, start: Iterable[FluentValue], *, frames: bool, able: Collection[clingo.Symbol]
    ) -> None:
        self._facts, self._frames, self._able = facts, frames, able
        self._graph = invariant_graph(facts)
        self._start = dict(start)
        self._changes = Counter(fluent for a in facts.actions for fluent in self._changed(a))
        self._declared = set(self._changes)
        self._static: dict[FluentValue, FluentValue] = {}
        self._demanding: dict[FluentValue, list[clingo.Symbol]] = {}
        self._rejections: dict[clingo.Symbol, Rejection] = {}

    def run(self) -> RejectedActions:
        """Return the result of the search."""
        self._add_static(value for value in self._start.items() if not self._changes[value[0]])
        waiting: list[clingo.Symbol] = []
        for action in self._facts.actions:
            if action not in self._able:
                self._reject(action, waiting)
        if waiting:
            self._find_demanding()
        while waiting:
            for fluent in self._changed(waiting.pop()):
                self._changes[fluent] -= 1
                if not self._changes[fluent] and fluent in self._start:
                    for static in self._add_static([(fluent, self._start[fluent])]):
                        for action in self._demanding.get(static, ()):
                            if action not in self._rejections:
                                self._reject(action, waiting)
        ordered = {action: self._rejections[action] for action in self._facts.actions if action in self._rejections}
        return RejectedActions(ordered, self._static)

    def _add_static(self, values: Iterable[FluentValue]) -> list[FluentValue]:
        """Add static values with their consequences, and return the new ones."""
        new = {value: why for value, why in entailed(values, self._graph).items() if value not in self._static}
        self._static |= new
        return list(new)

    def _reject(self, action: clingo.Symbol, waiting: list[clingo.Symbol]) -> None:
        """Add an action to the rejected ones if there is a reason."""
        rejection = self._rejection(action)
        if rejection is not None:
            self._rejections[action] = rejection
            waiting.append(action)

    def _find_demanding(self) -> None:
        """Find the actions that would be rejected if an initial value turned out to be static."""
        may_be_static = entailed(self._start.items(), self._graph)
        for action in self._facts.actions:
            if action not in self._able and action not in self._rejections:
                needed, after = self._around(action)
                for fluent, value in {**needed, **after}:
                    if (fluent, not value) in may_be_static:
                        self._demanding.setdefault((fluent, not value), []).append(action)

    def _changed(self, action: clingo.Symbol) -> set[clingo.Symbol]:
        return {fluent for fluent, _ in self._facts.postconditions.get(action, ())}

    def _around(self, action: clingo.Symbol) -> tuple[Reasons, Reasons]:
        """Return the values that an action needs and those that hold after it, both with their consequences."""
        changed = self._changed(action)
        needed = entailed(fluent_values(self._facts.preconditions.get(action, ())), self._graph)
        kept = [value for value in needed if value[0] not in changed] if self._frames else []
        made = fluent_values(self._facts.postconditions.get(action, ()))
        return needed, entailed([*kept, *made], self._graph)

    def _rejection(self, action: clingo.Symbol) -> Rejection | None:
        """Return why the invariants and the static values reject an action, or None where they do not."""
        needed, after = self._around(action)
        pair = conflict(needed)
        if pair:
            return Rejection("precondition", pair[1], *pair, needs=True)
        pair = conflict(needed, self._static)
        if pair:
            may_change = pair[0][0] in self._declared
            return Rejection("precondition", pair[1], *pair, needs=True, static=True, may_change=may_change)
        pair = conflict(after) or conflict(after, self._static)
        if pair:
            made = fluent_values(self._facts.postconditions.get(action, ()))
            stated = pair[1] if pair[1] in made else pair[0]
            predicate = "postcondition" if stated in made else "precondition"
            makes = pair[0] in made and pair[1] in made
            return Rejection(predicate, stated, *pair, needs=False, makes=makes)
        return None


def rejected_by_encodings(
    program: Program, actions: Collection[clingo.Symbol], known: Iterable[FluentValue]
) -> Collection[clingo.Symbol]:
    """Return the actions that a step rejects from a state where only `known` is known."""
    if not actions:
        return ()
    grounder = Grounder(program)
    grounder.ground([("base", [])])
    grounder.state(holding(known, STEP - 1))
    grounder.ground([("step", [clingo.Number(STEP)])])
    atoms = grounder.control.symbolic_atoms
    found = {action: atoms[OCCURS(action, clingo.Number(STEP))] for action in actions}
    open_ = {atom.literal: action for action, atom in found.items() if atom is not None}
    while open_:
        with grounder.control.backend() as backend:
            some = backend.add_atom()
            for literal in open_:
                backend.add_rule([some], [literal])
        with grounder.control.solve(assumptions=[some], yield_=True) as handle:
            model = handle.model()
            if model is None:
                break
            able = [literal for literal in open_ if model.is_true(literal)]
        for literal in able:
            del found[open_.pop(literal)]
    return found.keys()


def holding(known: Iterable[FluentValue], time: int) -> Iterator[clingo.Symbol]:
    """Yield the atoms that give fluents these values after a step."""
    for fluent, value in known:
        yield HOLDS(fluent, value_term(value), clingo.Number(time))


def fluent_values(values: Assignment | list[tuple[clingo.Symbol, str]]) -> list[FluentValue]:
    """Return the known values; unknown ones state nothing."""
    return [(fluent, value == "true") for fluent, value in values if value in ("true", "false")]


def value_term(value: bool) -> clingo.Symbol:
    """Return a truth value as a term."""
    return clingo.Function("true" if value else "false")
