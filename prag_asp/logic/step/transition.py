"""A step of a domain as a function from states to states, evaluated on all states of a frontier at once.

This module does not interpret the meaning of rules. The ground rules are evaluated once without an action, which gives
every atom a column over the states. For each action, only the atoms that depend on it are re-evaluated, and only on the
states in which it breaks no constraint that reads the state directly.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.cone import find_cone
from prag_asp.logic.step.moves import Move, compile_move
from prag_asp.logic.step.normal import NormalStep, RuleBody
from prag_asp.logic.step.packed import WORD, Rows, pack, unpack
from prag_asp.logic.step.step_rules import StepRules
from prag_asp.logic.step.strata import Column, Stratum, body_column, evaluate, stratify
from prag_asp.processes.progress_events import stage

ROOM = 2**25
"""The maximum memory in bytes for the columns of `Needs` that are tested together."""

MANY = 64
"""The number of actions from which on `Needs` rules out actions together; fewer actions are tried one by one."""


@dataclass(frozen=True)
class Needs:
    """The constraints that forbid an action wherever one literal of the state before it is true.

    They are tested for all actions at once, because most actions cannot occur in most states.

    Action ``letters[i]`` is forbidden by the literals with the numbers ``forbidding[starts[i]:starts[i + 1]]``, which
    are indices into `literals`. `letters` omits actions without such constraints.
    """

    size: int
    literals: tuple[int, ...]
    letters: NDArray[np.intp]
    starts: NDArray[np.intp]
    forbidding: NDArray[np.intp]

    @classmethod
    def of(cls, constraints: Iterable[RuleBody], actions: Sequence[int], before: Collection[int]) -> Needs:
        """Return the needs that follow from constraints on one action and one atom `before` the step."""
        letter_of = {atom: letter for letter, atom in enumerate(actions)}
        numbers: dict[int, int] = {}
        pairs: set[tuple[int, int]] = set()
        for body in constraints:
            if len(body.literals) == 2 and not body.weights:
                for action, literal in (body.literals, body.literals[::-1]):
                    if action in letter_of and abs(literal) in before:
                        pairs.add((letter_of[action], numbers.setdefault(literal, len(numbers))))
        table = np.array(sorted(pairs), dtype=np.intp).reshape(-1, 2)
        letters, starts = np.unique(table[:, 0], return_index=True)
        return cls(len(actions), tuple(numbers), letters, np.append(starts, len(table)), table[:, 1])

    def met(self, read: Callable[[int], Column], states: int) -> NDArray[np.bool_]:
        """Return which actions are not forbidden in at least one state of a frontier, shape (actions,)."""
        met = np.ones(self.size, dtype=np.bool_)
        if not len(self.letters):
            return met
        columns = (read(literal) if literal > 0 else ~read(-literal) for literal in self.literals)
        true = np.stack([np.packbits(column) for column in columns])
        everywhere = np.packbits(np.ones(states, dtype=np.bool_))
        together = max(ROOM * len(self.letters) // (len(self.forbidding) * len(everywhere)), 1)
        for first in range(0, len(self.letters), together):
            starts = self.starts[first : first + together + 1]
            taken = true[self.forbidding[starts[0] : starts[-1]]]
            forbidden = np.bitwise_or.reduceat(taken, starts[:-1] - starts[0], axis=0)
            met[self.letters[first : first + together]] = (forbidden != everywhere).any(axis=1)
        return met


@dataclass(frozen=True)
class Successors:
    """The successors of a frontier under one action.

    `letter` is the number of the action; `sources` are the rows of the frontier in which the action is valid, shape
    (m,); `states` holds the packed states after the action, shape (m, words), and `labels` the truth values of the
    labels, shape (m, labels).
    """

    letter: int
    sources: NDArray[np.intp]
    states: Rows
    labels: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Transition:
    """The step function of a domain over the states of its cone of influence; equality is identity.

    `variables` are timed atoms without their time, `actions` are all actions in clingo's order of terms, and `labels`
    are the atoms of step t whose truth values label each edge. A move is compiled when its action is first tried.
    """

    step: NormalStep
    variables: tuple[clingo.Symbol, ...]
    constraints: tuple[RuleBody, ...]
    labels: tuple[clingo.Symbol, ...]
    _moves: dict[int, Move] = field(default_factory=dict, repr=False)

    @cached_property
    def actions(self) -> tuple[clingo.Symbol, ...]:
        """All actions that some rule allows."""
        return tuple(self.step.occurs)

    @cached_property
    def initial(self) -> Rows:
        """The initial state as a single row, or no row if the initial values are contradictory."""
        ground = self.step.ground
        column = np.array([[symbol in ground.initial] for symbol in self.variables], dtype=np.bool_)
        return pack(column.reshape(len(self.variables), 1))[: 1 if ground.consistent else 0]

    @cached_property
    def rules(self) -> StepRules:
        """The rules of the step in order, with an index of their readers."""
        now, bodies = self.step.ground.now, self.step.bodies
        atoms = (now.get(symbol, 0) for symbol in self.variables)
        actions = set(self.step.occurs.values())
        written = tuple(atom if atom in bodies or atom in actions else 0 for atom in atoms)
        return StepRules(
            self.step, self.constraints, written, tuple(now.get(symbol, 0) for symbol in self.labels)
        )  # fmt: skip

    @cached_property
    def _atoms(self) -> tuple[int, ...]:
        return tuple(self.step.occurs.values())

    @cached_property
    def _needs(self) -> Needs:
        return Needs.of(self.constraints, self._atoms, frozenset(self.step.ground.before.values()))

    @cached_property
    def final_strata(self) -> list[Stratum]:
        """The rules on which the check after the last step depends, in order."""
        roots = [abs(literal) for body in self.step.final for literal in body.literals]
        return stratify(roots, self.step.final_bodies)

    def move(self, letter: int) -> Move:
        """Return the compiled action with the given number."""
        if letter not in self._moves:
            self._moves[letter] = compile_move(self.rules, self._atoms[letter])
        return self._moves[letter]

    def accepts(self, states: Rows) -> Column:
        """Return whether a plan may end in each state, shape (number of states,)."""
        broken = np.zeros(len(states), dtype=np.bool_)
        if not self.step.final:
            return ~broken
        columns = self._columns(states, self.step.ground.now)
        read = evaluate(self.final_strata, self.step.final_bodies, columns, len(states))
        for body in self.step.final:
            broken |= body_column(body, read, len(states))
        return ~broken

    def places_set(self, move: Move) -> list[int]:
        """Return the variables that an action determines, in order."""
        unchanged = unpack(move.keep[None], len(self.variables))[:, 0]
        return [place for place, stays in enumerate(unchanged.tolist()) if not stays]

    def rests(self, states: Rows) -> Column:
        """Return whether each state is unchanged and breaks no constraint if no action occurs, shape (states,)."""
        before = _Before.evaluated(self.rules, self._columns(states, self.step.ground.before), len(states))
        stays: Column = (before.after == states).all(axis=1) & (before.breaches == 0)
        return stays

    def expand(self, states: Rows, candidates: NDArray[np.bool_] | None = None) -> Iterator[Successors]:
        """Yield the successors of a frontier under each action that is valid in some state, in the order of `actions`.

        `candidates` restricts the actions of each state, shape (states, actions); without it, all actions are tried.
        """
        before = _Before.evaluated(self.rules, self._columns(states, self.step.ground.before), len(states))
        tried = np.ones(len(self.actions), dtype=np.bool_)
        if candidates is not None:
            tried &= candidates.any(axis=0)
        if len(tried) > MANY:
            tried &= self._needs.met(before.read, len(states))
        for letter in np.flatnonzero(tried).tolist():
            sources = _unguarded(self.move(letter), before, None if candidates is None else candidates[:, letter])
            if len(sources):
                yield _apply(self.move(letter), letter, before, sources)

    def _columns(self, states: Rows, atoms: Mapping[clingo.Symbol, int]) -> dict[int, Column]:
        """Return the columns of the variables among `atoms`."""
        rows = unpack(states, len(self.variables))
        return {atoms[symbol]: row for symbol, row in zip(self.variables, rows, strict=True) if symbol in atoms}


@dataclass(frozen=True)
class _Before:
    """A frontier with every rule evaluated for a step without an action.

    `broken` holds the constraints that are violated in some state, and `breaches` the number of constraints that are
    violated in each state; `after` and `labels` are the states and the labels after a step without an action.
    """

    read: Callable[[int], Column]
    broken: Mapping[int, Column]
    breaches: NDArray[np.int32]
    after: Rows
    labels: NDArray[np.bool_]

    @classmethod
    def evaluated(cls, rules: StepRules, columns: dict[int, Column], size: int) -> _Before:
        """Evaluate the rules on the columns of the atoms of step t-1."""
        read = evaluate(rules.strata, rules.idle, columns, size)
        broken: dict[int, Column] = {}
        breaches = np.zeros(size, dtype=np.int32)
        for number, body in rules.idle_constraints:
            value = body_column(body, read, size)
            if value.any():
                broken[number] = value
                breaches += value
        return cls(read, broken, breaches, pack(_stacked(map(read, rules.written), size)),
                   _stacked(map(read, rules.labels), size).T)  # fmt: skip


def _apply(move: Move, letter: int, before: _Before, sources: NDArray[np.intp]) -> Successors:
    columns: dict[int, Column] = {}

    def column(atom: int) -> Column:
        if atom not in columns:
            constant = move.constants.get(atom)
            columns[atom] = before.read(atom)[sources] if constant is None else np.full(len(sources), constant)
        return columns[atom]

    evaluate(move.strata, move.bodies, columns, len(sources), column)
    bad = np.zeros(len(sources), dtype=np.bool_)
    for body in move.constraints:
        bad |= body_column(body, column, len(sources))
    if bad.any():
        allowed = ~bad
        sources = sources[allowed]
        columns = {atom: value[allowed] for atom, value in columns.items()}
    states = (before.after[sources] & move.keep) | move.put
    for place, atom in move.changed:
        word, shift = divmod(place, WORD)
        states[:, word] |= columns[atom].astype(np.uint64) << np.uint64(shift)
    labels = before.labels[sources]
    for place, atom in move.labels:
        labels[:, place] = columns[atom]
    for place, value in move.fixed_labels:
        labels[:, place] = value
    return Successors(letter, sources, states, labels)


def _unguarded(move: Move, before: _Before, tried: NDArray[np.bool_] | None) -> NDArray[np.intp]:
    """Return the rows in which an action is forbidden neither by a guard nor by a constraint that does not read it."""
    size = len(before.breaches)
    if move.impossible:
        return np.zeros(0, dtype=np.intp)
    breaches = before.breaches
    for number in move.touched & before.broken.keys():
        breaches = breaches - before.broken[number]
    valid = breaches == 0
    if tried is not None:
        valid &= tried
    for guard in move.guards:
        if not valid.any():
            break
        valid &= ~body_column(guard, before.read, size)
    return np.flatnonzero(valid)


def _stacked(columns: Iterator[Column], size: int) -> NDArray[np.bool_]:
    rows = list(columns)
    return np.stack(rows) if rows else np.zeros((0, size), dtype=np.bool_)


def build_transition(step: NormalStep, labels: Sequence[clingo.Symbol] = ()) -> Transition:
    """Return the step function of a domain over the cone of influence of its constraints and of `labels`."""
    stage("preparing the step")
    atoms = [step.ground.now[symbol] for symbol in labels if symbol in step.ground.now]
    cone = find_cone(step, atoms)
    return Transition(step, cone.variables, cone.constraints, tuple(labels))
