"""The shortest plans from the initial state of a task to its goal, counted by a breadth-first search.

A plan of the domain solves a task if it leads from the known facts of the initial state to the goal and implies no
further values of the initial state. It can therefore be executed wherever the task can. The logic is in
``encodings/rules/same_start.lp``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.atom import Atom
from prag_asp.errors import LimitReached
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.packed import Rows, pack
from prag_asp.logic.step.transition import Transition
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import FINDING, HOLDS, PROPAGATES, REQUEST
from prag_asp.program.sources import ADDED, Program, Source, each_once, read_sources
from prag_asp.space.automaton.numbering import Numbering
from prag_asp.space.limits import LimitClock
from prag_asp.stop_reason import StopKind, StopReason
from prag_asp.task import State

MOST_STATES = 2_000_000
"""Maximum number of states in a search: at 64 bytes per state, they and their edges take about 1 GB."""

TOGETHER = 4096
"""Number of states that are expanded together."""

FEW_STATES, MOST_KEPT = 20_000, 32
"""The maximum number of states of a search that is kept for later tasks with the same initial state, and the maximum
number of such searches."""

SAFE = 2**62
"""Numbers of plans below this bound fit into 64 bits."""

Literals = set[tuple[str, bool]]
"""Fluents as texts, with their values."""

Bits = NDArray[np.uint8]
"""Truth values, eight in a byte."""

Values = Sequence[tuple[clingo.Symbol, bool]]
"""Fluents with their values."""

START = clingo.Number(0)
TRUTH = {True: "true", False: "false"}


@dataclass(frozen=True)
class ShortestPlans:
    """The length of the shortest plans that solve a task, and their number; plans are equal if their actions are."""

    length: int
    number: int


@dataclass(frozen=True)
class PlanLayer:
    """The states that plans of `depth` actions reach but shorter plans do not.

    `numbers` holds the number of plans that lead to each state; `ends` states whether a plan may end there; `meets`
    states, for each fluent and value, whether a goal may require this value there, packed, shape (states, bytes). Each
    array has one row per state.
    """

    depth: int
    numbers: NDArray[Any]
    ends: NDArray[np.bool_]
    meets: Bits

    def solving(self, goal: Bits) -> NDArray[np.bool_]:
        """Return which states satisfy a goal, shape (states,); the goal is packed like a row of `meets`."""
        solving: NDArray[np.bool_] = self.ends & ((self.meets & goal) == goal).all(axis=1)
        return solving


@dataclass(frozen=True)
class Start:
    """An initial state of plans: its ground base part, and the values that it makes known."""

    grounder: Grounder
    known: Literals

    @classmethod
    def of(cls, program: Program, initial: Iterable[tuple[object, bool]]) -> Start:
        """Return the initial state of a program's plans in which fluents have the given values.

        Raises:
            DomainError: clingo cannot ground the program.
        """
        facts = " ".join(HOLDS.fact(fluent, TRUTH[value], 0) for fluent, value in initial)
        grounder = Grounder(Program((*program.sources, Source(ADDED, facts))))
        grounder.ground([("base", [])])
        values = (
            symbol.arguments for symbol in _true(grounder, HOLDS.name, HOLDS.arity) if symbol.arguments[2] == START
        )
        return cls(grounder, {(str(fluent), value.name == "true") for fluent, value, _ in values})

    def row(self, transition: Transition) -> Rows:
        """Return the packed state, shape (1, words), or no row if the state is contradictory."""
        at_start = (clingo.Function(each.name, [*each.arguments, START]) for each in transition.variables)
        atoms = self.grounder.control.symbolic_atoms
        bits = np.array([[(atom := atoms[each]) is not None and atom.is_fact] for each in at_start], dtype=np.bool_)
        return pack(bits.reshape(-1, 1))[: 0 if self.grounder.control.is_conflicting else 1]

    def covered(self, transition: Transition) -> bool:
        """Return whether the step has been ground for all atoms of the initial state that it may read."""
        before = transition.step.ground.before
        signatures = {(symbol.name, len(symbol.arguments)) for symbol in before}
        return all(
            clingo.Function(symbol.name, symbol.arguments[:-1]) in before
            for name, arity in signatures
            for symbol in _true(self.grounder, name, arity + 1)
            if symbol.arguments[-1] == START
        )

    def closed(self, values: Iterable[tuple[object, bool]]) -> Literals:
        """Return values of fluents together with all values that follow from them by the invariants."""
        follows: dict[tuple[str, bool], list[tuple[str, bool]]] = {}
        for one, value, other, then in (each.arguments for each in _true(self.grounder, *PROPAGATES)):
            follows.setdefault((str(one), value.name == "true"), []).append((str(other), then.name == "true"))
        waiting = [(str(fluent), value) for fluent, value in values]
        found = set(waiting)
        while waiting:
            new = set(follows.get(waiting.pop(), ())) - found
            found |= new
            waiting += new
        return found

    def may_end(self) -> bool:
        """Return whether the plan without actions may end here; this must be called before any step is ground."""
        self.grounder.ground([("check", [START])])
        return bool(self.grounder.control.solve().satisfiable)


class CommonStart:
    """The base part of a program, ground once for all initial states, with their facts left open."""

    def __init__(self, program: Program) -> None:
        given = REQUEST.fact("start(F,V)").removesuffix(".")
        opened = f"#external {given} : fluent(F), _opposite(V,_). {HOLDS.fact('F', 'V', 0)[:-1]} :- {given}."
        self._grounder = Grounder(Program((*program.sources, Source(ADDED, opened))))
        self._grounder.ground([("base", [])])
        self._assigned: list[clingo.Symbol] = []

    def covered(self, transition: Transition) -> bool:
        """Return whether the step has been ground for all atoms that an initial state may have."""
        before, atoms = transition.step.ground.before, self._grounder.control.symbolic_atoms
        return not self._grounder.control.is_conflicting and all(
            clingo.Function(atom.symbol.name, atom.symbol.arguments[:-1]) in before
            for name, arity in {(symbol.name, len(symbol.arguments) + 1) for symbol in before}
            for atom in atoms.by_signature(name, arity)
            if atom.symbol.arguments[-1] == START
        )

    def row(self, transition: Transition, initial: Values) -> Rows:
        """Return the packed state in which fluents have these values, shape (1, words)."""
        control = self._grounder.control
        atoms = control.symbolic_atoms
        for symbol in self._assigned:
            control.assign_external(symbol, False)
        values = ((fluent, clingo.Function(TRUTH[value])) for fluent, value in initial)
        self._assigned = [REQUEST(clingo.Function("start", [*each])) for each in values]
        for symbol in self._assigned:
            control.assign_external(symbol, True)
        found = [atoms[clingo.Function(each.name, [*each.arguments, START])] for each in transition.variables]
        with control.solve(yield_=True) as handle:
            model = handle.model()
            assert model is not None, "the known initial state of a plan satisfies the invariants"
            bits = [atom is not None and model.is_true(atom.literal) for atom in found]
        return pack(np.array(bits, dtype=np.bool_).reshape(-1, 1))


def _true(grounder: Grounder, name: str, arity: int) -> Iterator[clingo.Symbol]:
    return (atom.symbol for atom in grounder.control.symbolic_atoms.by_signature(name, arity) if atom.is_fact)


class PlanSearch:
    """The searches for shortest plans of one domain, which share one ground step.

    The conditions of a space are not part of the domain, so a shortest plan need not satisfy them.
    """

    def __init__(self, model: DomainLogic) -> None:
        domain = (model.bare or model).domain
        rules = read_sources(domain.encodings / "rules" / "same_start.lp", domain.encodings)
        program = Program(each_once((*domain.program.sources, *rules)))
        self._model = DomainLogic(replace(domain, program=program, reduction=None))
        values = [(fluent, value) for fluent in domain.facts.fluents for value in TRUTH]
        self._kept: dict[frozenset[tuple[Atom, bool]], PlanLayers] = {}
        self._places = {(str(fluent), value): place for place, (fluent, value) in enumerate(values)}
        self._labels = [
            FINDING.timeless(clingo.Function("meets", [fluent, clingo.Function(TRUTH[value])]))
            for fluent, value in values
        ]

    @cached_property
    def _transition(self) -> Transition:
        """The step function of plans that imply no further values of their initial state."""
        return self._model.transition(tasks=False, labels=self._labels)

    def solve(self, initial: State, goal: State, at_most: int, clock: LimitClock) -> ShortestPlans | None:
        """Return the shortest plans from an initial state to a goal, or None if they have more than `at_most` actions.

        Raises:
            EngineError: the step is not a function of the state and the action.
            LimitReached: a limit was reached, or there are more than `MOST_STATES` states.
        """
        wanted, key = self.goal_row(goal.items()), frozenset(initial.items())
        layers = self._kept.pop(key, None) or self.layers(Start.of(self._model.program, key))
        found = None
        for layer in layers.up_to(at_most, clock):
            solving = layer.solving(wanted)
            if solving.any():
                found = ShortestPlans(layer.depth, int(sum(layer.numbers[solving].tolist())))
                break
        if layers.states <= FEW_STATES:
            self._kept[key] = layers
            if len(self._kept) > MOST_KEPT:
                del self._kept[next(iter(self._kept))]
        return found

    def solvable(
        self, starts: Sequence[Values], goals: Sequence[Bits], at_most: int, clock: LimitClock
    ) -> list[NDArray[np.bool_]]:
        """Return which goals can be reached from each initial state by a plan of at most `at_most` actions.

        ``goals[k]`` has one row, as returned by `goal_row`, for each goal to be reached from the k-th initial state;
        the result has, for each initial state, one truth value per goal. The states of all searches are expanded
        together.

        Raises:
            EngineError: the step is not a function of the state and the action.
            LimitReached: a limit was reached, or there are more than `MOST_STATES` states.
        """
        transition, common = self._transition, CommonStart(self._model.program)
        if not common.covered(transition):
            return [self._solvable_from(*each, at_most, clock) for each in zip(starts, goals, strict=True)]
        rows = np.concatenate([common.row(transition, each) for each in starts])
        seen = Numbering(rows.shape[1])
        first = seen.add(rows)
        known = len(seen)
        meets, sources, targets = [np.zeros((known, -(-len(self._labels) // 8)), dtype=np.uint8)], [], []
        begin = 0
        for _ in range(at_most):
            rows, low = seen.rows[begin:].copy(), begin
            begin = len(seen)
            for place in range(0, len(rows), TOGETHER):
                _check(clock, seen)
                for step in transition.expand(rows[place : place + TOGETHER]):
                    size, found = len(seen), seen.add(step.states)
                    _, firsts = np.unique(found, return_index=True)
                    meets.append(np.packbits(step.labels[firsts[found[firsts] >= size]], axis=1))
                    sources.append(low + place + step.sources)
                    targets.append(found)
        graph = PlanGraph.of(sources, targets, transition.accepts(seen.rows), np.concatenate(meets))
        return [
            self._solved(graph, int(start), each, initial, at_most)
            for start, each, initial in zip(first, goals, starts, strict=True)
        ]

    def _solved(self, graph: PlanGraph, start: int, goals: Bits, initial: Values, at_most: int) -> NDArray[np.bool_]:
        """Return which goals plans reach from a state of the graph; the plan without actions is tested separately."""
        reached = graph.within(start, at_most)
        meets = graph.meets[reached[graph.ends[reached]]]
        own = {(str(fluent), value) for fluent, value in initial}
        here: NDArray[np.bool_] = ((self._row(own) & goals) == goals).all(axis=1)
        if here.any() and Start.of(self._model.program, initial).may_end():
            here |= solved_by(meets, goals)
            return here
        return solved_by(meets, goals)

    def _solvable_from(self, initial: Values, goals: Bits, at_most: int, clock: LimitClock) -> NDArray[np.bool_]:
        layers = self.layers(Start.of(self._model.program, initial)).up_to(at_most, clock)
        return solved_by(np.concatenate([layer.meets[layer.ends] for layer in layers]), goals)

    def goal_row(self, values: Iterable[tuple[object, bool]]) -> Bits:
        """Return values of fluents, and all values that follow from them by the invariants, as a packed row."""
        return self._row(self._bare_start.closed(values))

    @cached_property
    def _bare_start(self) -> Start:
        return Start.of(self._model.program, ())

    def _row(self, literals: Literals) -> Bits:
        """Return values of fluents as a packed row, shape (bytes,), with two bits per fluent: true and false."""
        row = np.zeros(len(self._places), dtype=np.bool_)
        row[[self._places[each] for each in literals]] = True
        return np.packbits(row)

    def layers(self, start: Start) -> PlanLayers:
        """Return the states that plans from a state reach, in order of their distance.

        Raises:
            EngineError: the step is not a function of the state and the action.
        """
        transition = self._transition
        if not start.covered(transition):
            facts = " ".join(HOLDS.fact(fluent, TRUTH[value], 0) for fluent, value in start.known)
            program = Program((*self._model.domain.program.sources, Source(ADDED, facts)))
            model = DomainLogic(replace(self._model.domain, program=program))
            transition = model.transition(tasks=False, labels=self._labels)
        rows = start.row(transition)
        ends = np.array([start.may_end()] * len(rows))
        return PlanLayers(transition, rows, ends, self._row(start.known)[None, :])


class PlanLayers:
    """The states that plans from one state reach, in order of their distance; layers are found when they are needed."""

    def __init__(self, transition: Transition, rows: Rows, ends: NDArray[np.bool_], meets: Bits) -> None:
        self._transition, self._rows = transition, rows
        self._seen = Numbering(rows.shape[1])
        self._seen.add(rows)
        self._found = [PlanLayer(0, np.ones(len(rows), dtype=np.int64), ends, meets)]

    @property
    def states(self) -> int:
        """The number of states found so far."""
        return len(self._seen)

    def up_to(self, depth: int, clock: LimitClock) -> Iterator[PlanLayer]:
        """Yield the layers up to a depth, lazily; stop when no state is new. After an error, there are no more layers.

        Raises:
            LimitReached: a limit was reached, or there are more than `MOST_STATES` states.
        """
        for number in range(depth + 1):
            if number == len(self._found):
                numbers = self._found[-1].numbers
                self._rows, numbers, meets = _advance(self._transition, self._rows, numbers, self._seen, clock)
                self._found.append(PlanLayer(number, numbers, self._transition.accepts(self._rows), meets))
            if number and not len(self._found[number].numbers):
                return
            yield self._found[number]


@dataclass(frozen=True)
class PlanGraph:
    """The states of several searches and the edges between them, sorted by source.

    `offsets` holds the index of the first edge of each source. `ends` states whether a plan may end in each state after
    an action, and `meets` which values a goal may require there, as in `PlanLayer`.
    """

    offsets: NDArray[np.int64]
    targets: NDArray[np.int64]
    ends: NDArray[np.bool_]
    meets: Bits

    @classmethod
    def of(
        cls, sources: list[NDArray[np.int64]], targets: list[NDArray[np.int64]], ends: NDArray[np.bool_], meets: Bits
    ) -> PlanGraph:
        """Return the graph with the given edges."""
        nothing = np.zeros(0, dtype=np.int64)
        own, others = (np.concatenate([nothing, *each]) for each in (sources, targets))
        order = np.argsort(own, kind="stable")
        return cls(np.searchsorted(own[order], np.arange(len(ends) + 1)), others[order], ends, meets)

    def within(self, start: int, steps: int) -> NDArray[np.int64]:
        """Return the states that can be reached from a state over 1 to `steps` edges."""
        reached = frontier = np.array([start])
        after = np.zeros(0, dtype=np.int64)
        for _ in range(steps):
            number = self.offsets[frontier + 1] - self.offsets[frontier]
            edges = np.arange(number.sum()) + np.repeat(self.offsets[frontier] - np.cumsum(number) + number, number)
            found = np.unique(self.targets[edges])
            after = np.union1d(after, found)
            frontier = np.setdiff1d(found, reached, assume_unique=True)
            if not len(frontier):
                break
            reached = np.union1d(reached, frontier)
        return after


def solved_by(meets: Bits, goals: Bits) -> NDArray[np.bool_]:
    """Return which of `goals`, one per row, are contained in some row of `meets`, shape (goals,)."""
    exact = set(map(bytes, meets))
    solved = np.array([bytes(goal) in exact for goal in goals], dtype=np.bool_)
    if solved.all() or not len(meets):
        return solved
    distinct = np.unique(meets, axis=0)
    sizes = np.unpackbits(distinct, axis=1).sum(axis=1, dtype=np.int64)
    order = np.argsort(-sizes, kind="stable")
    for place in np.flatnonzero(~solved):  # a state may satisfy more than the goal
        larger = distinct[order[: np.searchsorted(-sizes[order], -int(np.unpackbits(goals[place]).sum()))]]
        solved[place] = ((larger & goals[place]) == goals[place]).all(axis=1).any()
    return solved


def _check(clock: LimitClock, seen: Numbering) -> None:
    """Check the limits of a search.

    Raises:
        LimitReached: a limit was reached, or there are too many states.
    """
    reason = clock.reached_limit(seen.nbytes) or (StopReason(StopKind.SIZE) if len(seen) > MOST_STATES else None)
    if reason:
        raise LimitReached(
            f"{reason.prose()} was reached with {len(seen):,} states from the initial state of the task; "
            "take a shorter task, or allow more (--time, --memory)", 0, reason,
        )  # fmt: skip


def _advance(
    transition: Transition, rows: Rows, numbers: NDArray[Any], seen: Numbering, clock: LimitClock
) -> tuple[Rows, NDArray[Any], Bits]:
    """Return the new states after one more action, the number of plans to each, and the values goals may require."""
    known = len(seen)
    targets, paths, meets = [], [], [np.zeros((0, -(-len(transition.labels) // 8)), dtype=np.uint8)]
    for first in range(0, len(rows), TOGETHER):
        _check(clock, seen)
        for step in transition.expand(rows[first : first + TOGETHER]):
            size = len(seen)
            found = seen.add(step.states)
            new = found >= known
            targets.append(found[new] - known)
            paths.append(numbers[first + step.sources[new]])
            _, firsts = np.unique(found, return_index=True)
            meets.append(np.packbits(step.labels[firsts[found[firsts] >= size]], axis=1))
    states = seen.rows[known:]
    whole: NDArray[Any] = np.zeros(len(states), dtype=np.int64)
    if paths:
        ways = np.concatenate(paths)
        if numbers.dtype == object or int(numbers.max(initial=0)) * (len(ways) + 1) >= SAFE:
            ways, whole = ways.astype(object), whole.astype(object)
        np.add.at(whole, np.concatenate(targets), ways)
    return states.copy(), whole, np.concatenate(meets)
