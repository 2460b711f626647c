"""A step of a domain as a function from states to states, evaluated on all states of a frontier at once.

This module does not interpret the meaning of rules. The ground rules are evaluated once without an action, which gives
the truth value of every atom in all states. For each action, only the atoms that depend on it are re-evaluated; if it
may occur in only a few of many states, they are re-evaluated only in those.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.bit_columns import Column, all_true, bits_of, column_of, columns_of, each_bits
from prag_asp.logic.step.cone import find_cone
from prag_asp.logic.step.moves import Move, compile_move
from prag_asp.logic.step.normal import NormalStep, RuleBody
from prag_asp.logic.step.packed import WORD, Rows, pack, unpack
from prag_asp.logic.step.step_rules import StepRules
from prag_asp.logic.step.strata import AtomStratum, body_bits, evaluate, stratify
from prag_asp.processes.progress_events import stage

ROOM = 2**25
"""The maximum memory in bytes for the columns of `Needs` that are tested together."""

WIDE, SPARSE = 2**12, 8
"""In at least `WIDE` states, an action that may occur in fewer than one in `SPARSE` of them is evaluated only there."""

MANY = 64
"""The minimum number of actions that `Needs` tests together; fewer actions are tried one by one."""


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
        """Return for each action whether some state of a frontier does not forbid it, shape (actions,)."""
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
    def final_strata(self) -> list[AtomStratum]:
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
        every = all_true(len(states))
        broken = 0
        if self.step.final:
            values = self._values(states, self.step.ground.now)
            read = evaluate(self.final_strata, self.step.final_bodies, values, len(states))
            for body in self.step.final:
                broken |= body_bits(body, read, len(states), every)
        return column_of(every ^ broken, len(states))

    def places_set(self, move: Move) -> list[int]:
        """Return the indices of the variables that an action determines, in order."""
        unchanged = unpack(move.keep[None], len(self.variables))[:, 0]
        return [place for place, stays in enumerate(unchanged.tolist()) if not stays]

    def rests(self, states: Rows) -> Column:
        """Return whether each state is unchanged and breaks no constraint if no action occurs, shape (states,)."""
        before = _Before.evaluated(self.rules, self._values(states, self.step.ground.before), len(states))
        stays: Column = (before.after == states).all(axis=1) & (before.breaches == 0)
        return stays

    def expand(self, states: Rows, candidates: NDArray[np.bool_] | None = None) -> Iterator[Successors]:
        """Yield the successors of a frontier under each action that is valid in some state, in the order of `actions`.

        `candidates` restricts the actions of each state, shape (states, actions); without it, all actions are tried.
        """
        before = _Before.evaluated(self.rules, self._values(states, self.step.ground.before), len(states))
        tried = np.ones(len(self.actions), dtype=np.bool_)
        if candidates is not None:
            tried &= candidates.any(axis=0)
        if len(tried) > MANY:
            tried &= self._needs.met(before.column, len(states))
        for letter in np.flatnonzero(tried).tolist():
            valid = _unguarded(self.move(letter), before, None if candidates is None else candidates[:, letter])
            if valid.any():
                yield _apply(self.move(letter), letter, before, valid)

    def _values(self, states: Rows, atoms: Mapping[clingo.Symbol, int]) -> dict[int, int]:
        """Return the truth values of the variables among `atoms`, as bits."""
        rows = each_bits(unpack(states, len(self.variables)))
        return {atoms[symbol]: bits for symbol, bits in zip(self.variables, rows, strict=True) if symbol in atoms}


@dataclass(frozen=True)
class _Before:
    """A frontier with every rule evaluated for a step without an action.

    `values` holds the truth values of atoms in its `size` states, as bits. `broken` holds the constraints that are
    violated in some state, and `breaches` the number of constraints that are violated in each state; `after` and
    `labels` are the states and the labels after a step without an action.
    """

    values: Mapping[int, int]
    size: int
    broken: Mapping[int, Column]
    breaches: NDArray[np.int32]
    after: Rows
    labels: NDArray[np.bool_]
    _columns: dict[int, Column] = field(default_factory=dict, repr=False)

    @classmethod
    def evaluated(cls, rules: StepRules, values: dict[int, int], size: int) -> _Before:
        """Evaluate the rules on the truth values of the atoms of step t-1."""
        read, every = evaluate(rules.strata, rules.idle, values, size), all_true(size)
        broken: dict[int, Column] = {}
        breaches = np.zeros(size, dtype=np.int32)
        for number, body in rules.idle_constraints:
            bits = body_bits(body, read, size, every)
            if bits:
                broken[number] = column_of(bits, size)
                breaches += broken[number]
        after = pack(columns_of(map(read, rules.written), size))
        return cls(values, size, broken, breaches, after, columns_of(map(read, rules.labels), size).T)

    def read(self, atom: int) -> int:
        """Return the truth values of an atom, as bits."""
        return self.values.get(atom, 0)

    def column(self, atom: int) -> Column:
        """Return the truth values of an atom as a column."""
        if atom not in self._columns:
            self._columns[atom] = column_of(self.read(atom), self.size)
        return self._columns[atom]


def _apply(move: Move, letter: int, before: _Before, valid: Column) -> Successors:
    sources = np.flatnonzero(valid)
    few = before.size >= WIDE and SPARSE * len(sources) < before.size
    size = len(sources) if few else before.size
    every = all_true(size)
    values: dict[int, int] = {}

    def read(atom: int) -> int:
        if atom not in values:
            constant = move.constants.get(atom)
            if constant is not None:
                values[atom] = every if constant else 0
            else:
                values[atom] = bits_of(before.column(atom)[sources]) if few else before.read(atom)
        return values[atom]

    evaluate(move.strata, move.bodies, values, size, read)
    bad = 0
    for body in move.constraints:
        bad |= body_bits(body, read, size, every)
    rows = np.arange(size) if few else sources
    if bad:
        rows = rows[~column_of(bad, size)[rows]]
    sources = sources[rows] if few else rows
    states = (before.after[sources] & move.keep) | move.put
    for place, atom in move.changed:
        word, shift = divmod(place, WORD)
        states[:, word] |= column_of(values[atom], size)[rows].astype(np.uint64) << np.uint64(shift)
    labels = before.labels[sources]
    for place, atom in move.labels:
        labels[:, place] = column_of(values[atom], size)[rows]
    for place, value in move.fixed_labels:
        labels[:, place] = value
    return Successors(letter, sources, states, labels)


def _unguarded(move: Move, before: _Before, tried: Column | None) -> Column:
    """Return, for each state, whether the action violates neither a guard nor a constraint that reads no action."""
    if move.impossible:
        return np.zeros(before.size, dtype=np.bool_)
    breaches = before.breaches
    for number in move.touched & before.broken.keys():
        breaches = breaches - before.broken[number]
    valid: Column = breaches == 0
    if tried is not None:
        valid &= tried
    bits, every = bits_of(valid), all_true(before.size)
    for guard in move.guards:
        if not bits:
            break
        bits &= every ^ body_bits(guard, before.read, before.size, every)
    return column_of(bits, before.size)


def build_transition(step: NormalStep, labels: Sequence[clingo.Symbol] = ()) -> Transition:
    """Return the step function of a domain over the cone of influence of its constraints and of `labels`."""
    stage("preparing the step")
    atoms = [step.ground.now[symbol] for symbol in labels if symbol in step.ground.now]
    cone = find_cone(step, atoms)
    return Transition(step, cone.variables, cone.constraints, tuple(labels))
