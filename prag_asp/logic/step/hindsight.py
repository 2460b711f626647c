"""The known values of the states of many plans at once, including values that later steps reveal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.ground.ground_step import timeless, unrolled
from prag_asp.logic.step.bit_columns import bits_of, columns_of, each_bits
from prag_asp.logic.step.normal import NormalStep, RuleBody
from prag_asp.logic.step.strata import AtomStratum, evaluate, stratify
from prag_asp.program.grounding import Grounder, ProgramPart
from prag_asp.program.predicates import OCCURS, STATE
from prag_asp.program.sources import Program

Plan = tuple[clingo.Symbol, ...]

FluentValues = NDArray[np.int8]
"""The values of fluents in states: 1 true, 0 false, -1 unknown; one row for each fluent."""

Truth = NDArray[np.bool_]
"""The truth of atoms in several plans: one row for each atom, one column for each plan."""

TRUE, FALSE, UNKNOWN = 1, 0, -1


@dataclass(frozen=True)
class Hindsight:
    """The rules of a step and of ``hindsight.lp`` as functions of columns, one column for each plan.

    A *state* has the atoms of the previous step that a step reads, shape (variables, plans); *seen* has the atoms of a
    step that hindsight reads, shape (atoms, plans); *known* is the truth of each ``_state(F, V, t)``, shape (atoms,
    plans). All are boolean. `fluents` are numbered in their order.
    """

    step: NormalStep
    fluents: tuple[clingo.Symbol, ...]

    @cached_property
    def _forward(self) -> list[AtomStratum]:
        return stratify(self.step.ground.now.values(), self.step.bodies)

    @cached_property
    def _carried(self) -> Mapping[int, int]:
        """The atom of step t, or 0, that corresponds to each variable, which is an atom of step t-1."""
        ground = self.step.ground
        carried = {ground.before[symbol]: atom for symbol, atom in ground.now.items() if symbol in ground.before}
        return {**{ground.before[symbol]: 0 for symbol in ground.initial if symbol in ground.before}, **carried}

    @cached_property
    def _rows(self) -> list[tuple[int, int, int, int]]:
        """For each ``_state(F, V, t)``: its atom, its atom at step t-1 (or 0), the row of F, and the number of V."""
        rows = {fluent: row for row, fluent in enumerate(self.fluents)}
        before = self.step.ground.before
        states = ((symbol, atom) for symbol, atom in self.step.ground.now.items() if symbol.match(*STATE.without_time))
        return [
            (atom, before.get(symbol, 0), rows[symbol.arguments[0]], _number(symbol.arguments[1]))
            for symbol, atom in states
            if symbol.arguments[0] in rows
        ]

    @cached_property
    def _parts(self) -> Mapping[str, tuple[Mapping[int, tuple[RuleBody, ...]], list[AtomStratum]]]:
        """The rules for the final state and for an earlier state, each with the strata to evaluate."""
        roots = {"ending": [atom for atom, *_ in self._rows], "hindsight": [before for _, before, *_ in self._rows]}
        parts = {}
        for part, needed in roots.items():
            bodies = dict(self.step.final_bodies) if part == "ending" else {}
            for rule in self.step.ground.rules.get(part, ()):
                for head in rule.heads:
                    bodies[head] = (*bodies.get(head, ()), RuleBody(rule.body, rule.bound, rule.weights))
            parts[part] = (bodies, stratify(needed, bodies))
        return parts

    def _read(self, part: str) -> list[int]:
        """Return the atoms that a part reads but does not define, without ``state(F, V, t)``."""
        bodies, strata = self._parts[part]
        defined = {atom for stratum in strata for atom in stratum.atoms}
        literals = {abs(each) for atom in defined for body in bodies[atom] for each in body.literals}
        return sorted(literals - defined - {atom for atom, *_ in self._rows})

    @cached_property
    def _seen(self) -> list[int]:
        return sorted({*self._read("ending"), *self._read("hindsight")})

    @cached_property
    def last_read(self) -> tuple[clingo.Symbol, ...]:
        """The timed atoms, without their time, on which ``state(F, V, t)`` of the final state depends."""
        names = self.step.ground.names
        return tuple(timeless(names[atom]) for atom in self._read("ending"))

    @cached_property
    def start(self) -> tuple[Truth, Truth]:
        """The initial state and, for a plan without actions, the atoms that hindsight reads; one column each."""
        ground = self.step.ground
        holding = {ground.before[symbol] for symbol in ground.initial if symbol in ground.before}
        now = {ground.now[symbol] for symbol in ground.initial if symbol in ground.now}
        state = np.array([[atom in holding] for atom in self._carried], dtype=np.bool_).reshape(-1, 1)
        return state, np.array([[atom in now] for atom in self._seen], dtype=np.bool_).reshape(-1, 1)

    def follow(self, states: Truth, letters: NDArray[np.int64]) -> tuple[Truth, Truth]:
        """Return the states after valid actions, given by number, and the *seen* atoms of these steps."""
        size = len(letters)
        values = dict(zip(self._carried, each_bits(states), strict=True))
        values.update((atom, bits_of(letters == number)) for number, atom in enumerate(self.step.occurs.values()))
        evaluate(self._forward, self.step.bodies, values, size)
        return _rows_of(values, self._carried.values(), size), _rows_of(values, self._seen, size)

    def evaluate_last(self, seen: Truth) -> Truth:
        """Return the *known* atoms of the final state, given the *seen* atoms of the last step."""
        return self._evaluated(dict(zip(self._seen, each_bits(seen), strict=True)), "ending", seen.shape[1])

    def evaluate_before(self, seen: Truth, known: Truth) -> Truth:
        """Return the *known* atoms before steps, given the *seen* atoms of the steps and the *known* atoms after."""
        values = dict(zip(self._seen, each_bits(seen), strict=True))
        values.update(zip((atom for atom, *_ in self._rows), each_bits(known), strict=True))
        return self._evaluated(values, "hindsight", seen.shape[1])

    def end_values(self, read: Truth) -> FluentValues:
        """Return the values in final states, shape (fluents, plans), given the truth of the atoms `last_read`."""
        values = dict(zip(self._read("ending"), each_bits(read), strict=True))
        return self.values(self._evaluated(values, "ending", read.shape[1]))

    def _evaluated(self, values: dict[int, int], part: str, size: int) -> Truth:
        bodies, strata = self._parts[part]
        evaluate(strata, bodies, values, size)
        place = 0 if part == "ending" else 1
        return _rows_of(values, (row[place] for row in self._rows), size)

    def values(self, known: Truth) -> FluentValues:
        """Return the values of fluents, shape (fluents, plans), given the *known* atoms."""
        values = np.full((len(self.fluents), known.shape[1]), UNKNOWN, dtype=np.int8)
        for (_, _, row, value), column in zip(self._rows, known, strict=True):
            values[row, column] = value
        return values


def _number(value: clingo.Symbol) -> int:
    return TRUE if value.name == "true" else FALSE


def _rows_of(values: Mapping[int, int], atoms: Iterable[int], size: int) -> Truth:
    """Return the truth values of atoms as rows; an atom that nothing derives is false."""
    return columns_of((values.get(atom, 0) for atom in atoms), size)


def solved_states(program: Program, plan: Plan, fluents: Sequence[clingo.Symbol]) -> FluentValues:
    """Return the values in the states of one plan by solving the unrolled program, which is slower but always works.

    The result has the shape (fluents, length of the plan + 1).
    """
    length = len(plan)
    grounder = Grounder(program, "1")
    grounder.ground([("base", [])])
    hindsight: list[ProgramPart] = [("hindsight", [clingo.Number(k)]) for k in range(1, length + 1)]
    grounder.ground([*unrolled(length), ("ending", [clingo.Number(length)]), *hindsight])
    atoms = grounder.control.symbolic_atoms
    occurring = [atoms[OCCURS(a, clingo.Number(k))] for k, a in enumerate(plan, 1)]
    values = np.full((len(fluents), length + 1), UNKNOWN, dtype=np.int8)
    rows = {fluent: row for row, fluent in enumerate(fluents)}
    with grounder.control.solve(assumptions=[a.literal for a in occurring if a], yield_=True) as handle:
        model = handle.model()
        assert model is not None, "the states of an invalid plan were asked for"
        for symbol in model.symbols(atoms=True):
            if symbol.match(*STATE) and symbol.arguments[0] in rows:
                fluent, value, time = symbol.arguments
                values[rows[fluent], time.number] = _number(value)
    return values


def numbered_goals(hindsight: Hindsight, marks: NDArray[np.bool_]) -> tuple[NDArray[np.int64], FluentValues]:
    """Return a number for the known values after each edge, shape (edges,), and these values, shape (fluents, numbers).

    `marks` holds the truth of `hindsight.last_read` after each edge, shape (edges, atoms).
    """
    kinds, places = np.unique(marks, axis=0, return_inverse=True)
    values, goal_of = np.unique(hindsight.end_values(kinds.T), axis=1, return_inverse=True)
    return goal_of.reshape(-1)[places.reshape(-1)], values
