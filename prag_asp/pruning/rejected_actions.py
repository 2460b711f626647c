"""The actions that every state rejects, and the static fluents.

An action that is rejected in the state where only the static values are known is rejected in every state, because a
precondition on an unknown value is met. A fluent that only rejected actions would change is also static, and as a
result, more actions may be rejected. By induction over the steps, all these actions can be pruned together. The
invariants yield candidates with reasons; the encodings confirm them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain, starmap
from typing import NamedTuple

import clingo

from prag_asp.program.facts import Assignment, Facts, rows
from prag_asp.program.grounding import Grounder
from prag_asp.program.invariants import FluentValue, Reasons, entailed, invariant_graph
from prag_asp.program.predicates import CHANGED, HOLDS, KNOWN, OCCURS
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Signature, Statement

STEP = 1_000_000_000
"""The number of the ground step, which no domain mentions."""

STATE_PREDICATES: frozenset[Signature] = frozenset([HOLDS, KNOWN, CHANGED])
"""The predicates that describe states."""


class Rejection(NamedTuple):
    """Why an action is rejected: two fluent values contradict each other, or a single value contradicts itself.

    `predicate` and `stated` are the precondition or postcondition to blame. If `needs`, the preconditions are
    contradictory; otherwise, the state after the action is. If `static`, `first` is a static value. `makes` is true if
    the action sets both values, and `may_change` if an action that can never occur would change the static value.
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
    """The actions that can never occur, each with the reason, and the static values."""

    rejections: Mapping[clingo.Symbol, Rejection]
    static: Reasons


def find_rejected_actions(
    program: Program, control: clingo.Control, facts: Facts, statements: Sequence[Statement]
) -> RejectedActions:
    """Return the actions that every state rejects; `program` is the program of a step without user rules.

    User rules of a step may change any fluent, so if there are any, no initial value counts as static.
    """
    stated = set(chain.from_iterable(map(state_predicates_of, statements)))
    start = [] if stated else initial_values(control)
    able: set[clingo.Symbol] = set()
    while True:
        result = _RejectionSearch(facts, start, frames=CHANGED not in stated, able=able).run()
        confirmed = set(rejected_by_encodings(program, result.rejections, result.static))
        if len(confirmed) == len(result.rejections):
            return result
        able |= result.rejections.keys() - confirmed


def state_predicates_of(statement: Statement) -> Iterator[Signature]:
    """Yield the state predicates that a user rule derives for states after the initial one."""
    for atom in statement.heads if statement.own else ():
        if atom.signature in STATE_PREDICATES and (statement.timed or atom.arguments[-1] != "0"):
            yield atom.signature


def initial_values(control: clingo.Control) -> list[FluentValue]:
    """Return the known values of the initial state."""
    start = clingo.Number(0)
    return fluent_values([(fluent, str(value)) for fluent, value, time in rows(control, *HOLDS) if time == start])


class _RejectionSearch:
    """The search for the actions that the invariants reject in every state, and for the static values.

    Actions that are `able` to occur are skipped. Without `frames`, a fluent may change even if no effect sets it.

    A fluent value is a number here: twice the rank of its fluent, plus 1 if it is true. Hashing clingo's terms is slow.
    """

    def __init__(
        self, facts: Facts, start: Iterable[FluentValue], *, frames: bool, able: Collection[clingo.Symbol]
    ) -> None:
        self._facts, self._frames, self._able = facts, frames, able
        self._ranks: dict[clingo.Symbol, int] = {fluent: rank for rank, fluent in enumerate(facts.fluents)}
        self._fluents = [*facts.fluents]
        graph = invariant_graph(facts)
        self._graph = {self._code(*value): tuple(starmap(self._code, each)) for value, each in graph.items()}
        self._start = [self._code(*value) for value in start]
        self._changes = Counter(rank for action in facts.actions for rank in self._changed(action))
        self._declared = set(self._changes)
        self._static: dict[int, int] = {}
        self._rejections: dict[clingo.Symbol, Rejection] = {}

    def run(self) -> RejectedActions:
        """Return the result of the search."""
        self._add_static(code for code in self._start if not self._changes[code // 2])
        waiting: list[clingo.Symbol] = []
        for action in self._facts.actions:
            if action not in self._able:
                self._reject(action, waiting)
        # Index the actions that would be rejected if an initial value turned out to be static.
        may_be_static = entailed(self._start, self._graph) if waiting else {}
        demanding: dict[int, list[clingo.Symbol]] = {}
        for action in self._facts.actions if may_be_static else ():
            if action not in self._able and action not in self._rejections:
                needed, after = self._around(action)
                for code in {**needed, **after}:
                    if code ^ 1 in may_be_static:
                        demanding.setdefault(code ^ 1, []).append(action)
        starts = {code // 2: code for code in self._start}
        while waiting:
            for rank in self._changed(waiting.pop()):
                self._changes[rank] -= 1
                if not self._changes[rank] and rank in starts:
                    for static in self._add_static([starts[rank]]):
                        for action in demanding.get(static, ()):
                            if action not in self._rejections:
                                self._reject(action, waiting)
        ordered = {action: self._rejections[action] for action in self._facts.actions if action in self._rejections}
        return RejectedActions(ordered, {self._value(code): self._value(why) for code, why in self._static.items()})

    def _code(self, fluent: clingo.Symbol, value: bool) -> int:
        rank = self._ranks.setdefault(fluent, len(self._fluents))
        if rank == len(self._fluents):
            self._fluents.append(fluent)
        return 2 * rank + value

    def _value(self, code: int) -> FluentValue:
        return self._fluents[code // 2], bool(code % 2)

    def _add_static(self, codes: Iterable[int]) -> list[int]:
        """Add static values and their consequences, and return the new ones."""
        new = {code: why for code, why in entailed(codes, self._graph).items() if code not in self._static}
        self._static |= new
        return list(new)

    def _reject(self, action: clingo.Symbol, waiting: list[clingo.Symbol]) -> None:
        """Add an action to the rejected ones if the invariants and the static values reject it."""
        needed, after = self._around(action)
        if pair := self._conflict(needed, needed):
            rejection = Rejection("precondition", pair[1], *pair, needs=True)
        elif pair := self._conflict(needed, self._static):
            may_change = self._code(*pair[0]) // 2 in self._declared
            rejection = Rejection("precondition", pair[1], *pair, needs=True, static=True, may_change=may_change)
        elif pair := self._conflict(after, after) or self._conflict(after, self._static):
            effects = fluent_values(self._facts.postconditions.get(action, ()))
            stated = pair[1] if pair[1] in effects else pair[0]
            predicate = "postcondition" if stated in effects else "precondition"
            makes = pair[0] in effects and pair[1] in effects
            rejection = Rejection(predicate, stated, *pair, needs=False, makes=makes)
        else:
            return
        self._rejections[action] = rejection
        waiting.append(action)

    def _conflict(self, codes: Mapping[int, int], others: Mapping[int, int]) -> tuple[FluentValue, FluentValue] | None:
        """Return two values with contradictory consequences, the first from `others`, or None if there are none."""
        code = next((code for code in codes if code ^ 1 in others), None) if others else None
        return None if code is None else (self._value(others[code ^ 1]), self._value(codes[code]))

    def _changed(self, action: clingo.Symbol) -> set[int]:
        return {self._code(fluent, False) // 2 for fluent, _ in self._facts.postconditions.get(action, ())}

    def _around(self, action: clingo.Symbol) -> tuple[Mapping[int, int], Mapping[int, int]]:
        """Return the values before an action and the values after it, both together with their consequences."""
        before = starmap(self._code, fluent_values(self._facts.preconditions.get(action, ())))
        effects = [*starmap(self._code, fluent_values(self._facts.postconditions.get(action, ())))]
        changed = self._changed(action)
        needed = entailed(before, self._graph)
        unchanged = [code for code in needed if code // 2 not in changed] if self._frames else []
        return needed, entailed([*unchanged, *effects], self._graph)


def rejected_by_encodings(
    program: Program, actions: Collection[clingo.Symbol], values: Iterable[FluentValue]
) -> Collection[clingo.Symbol]:
    """Return the actions that a step rejects in a state in which only some fluent values are known."""
    if not actions:
        return ()
    grounder = Grounder(program)
    grounder.ground([("base", [])])
    grounder.state(holding(values, STEP - 1))
    grounder.ground([("step", [clingo.Number(STEP)])])
    atoms = grounder.control.symbolic_atoms
    occurrences = {action: atoms[OCCURS(action, clingo.Number(STEP))] for action in actions}
    open_ = {atom.literal: action for action, atom in occurrences.items() if atom is not None}
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
            del occurrences[open_.pop(literal)]
    return occurrences.keys()


def holding(values: Iterable[FluentValue], time: int) -> Iterator[clingo.Symbol]:
    """Yield the ``holds`` atoms of fluent values at a given time."""
    for fluent, value in values:
        yield HOLDS(fluent, value_term(value), clingo.Number(time))


def fluent_values(values: Assignment | list[tuple[clingo.Symbol, str]]) -> list[FluentValue]:
    """Return the values of fluents, except unknown ones."""
    return [(fluent, value == "true") for fluent, value in values if value in ("true", "false")]


def value_term(value: bool) -> clingo.Symbol:
    """Return a truth value as a term."""
    return clingo.Function("true" if value else "false")
