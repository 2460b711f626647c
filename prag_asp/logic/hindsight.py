"""What is known of the states that plans pass, with hindsight: many plans at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.domain.grounding import Grounder, Part
from prag_asp.domain.sources import Program
from prag_asp.logic.ground import unrolled
from prag_asp.logic.normal import Body, NormalStep
from prag_asp.logic.strata import Column, Stratum, evaluate, stratify

Plan = tuple[clingo.Symbol, ...]

Told = NDArray[np.int8]
"""What is known of states: 1 true, 0 false, -1 unknown; shape (states of a plan, fluents, plans)."""

TRUE, FALSE, UNKNOWN = 1, 0, -1


@dataclass(frozen=True)
class Hindsight:
    """The rules of a step and of ``hindsight.lp``, evaluated on columns: one column for each plan.

    `fluents` are numbered in their order, as the rows of what is told.
    """

    step: NormalStep
    fluents: tuple[clingo.Symbol, ...]

    @cached_property
    def _forward(self) -> list[Stratum]:
        return stratify(self.step.ground.now.values(), self.step.bodies)

    @cached_property
    def _actions(self) -> Mapping[clingo.Symbol, int]:
        return {action: number for number, action in enumerate(self.step.occurs)}

    @cached_property
    def _carried(self) -> list[tuple[int, int]]:
        """The atoms of step t with their counterparts of step t-1."""
        ground = self.step.ground
        return [(atom, ground.before[symbol]) for symbol, atom in ground.now.items() if symbol in ground.before]

    @cached_property
    def _start(self) -> list[int]:
        before = self.step.ground.before
        return [before[symbol] for symbol in self.step.ground.initial if symbol in before]

    @cached_property
    def _rows(self) -> list[tuple[int, int, int]]:
        """For each atom ``state(F, V, t)``: the atom, the row of F, and the number for V."""
        rows = {fluent: row for row, fluent in enumerate(self.fluents)}
        states = ((s.arguments, atom) for s, atom in self.step.ground.now.items() if s.name == "state")
        return [
            (atom, rows[fluent], TRUE if value.name == "true" else FALSE)
            for (fluent, value), atom in states
            if fluent in rows
        ]

    @cached_property
    def _parts(self) -> Mapping[str, tuple[Mapping[int, tuple[Body, ...]], list[Stratum]]]:
        """The rules of the parts `ending` (with the final check) and `hindsight`, in order."""
        parts = {}
        for part in ("ending", "hindsight"):
            bodies = dict(self.step.final_bodies) if part == "ending" else {}
            for rule in self.step.ground.rules.get(part, ()):
                for head in rule.heads:
                    bodies[head] = (*bodies.get(head, ()), Body(rule.body, rule.bound, rule.weights))
            parts[part] = (bodies, stratify(list(bodies), bodies))
        return parts

    def states(self, plans: Sequence[Plan]) -> Told:
        """Return what is known of the states 0..n of valid plans, all of length n."""
        length, size = len(plans[0]), len(plans)
        numbers = np.array([[self._actions[action] for action in plan] for plan in plans]).reshape(size, length)
        told = np.full((length + 1, len(self.fluents), size), UNKNOWN, dtype=np.int8)
        history: list[dict[int, Column]] = []
        columns = {atom: np.full(size, True) for atom in self._start}
        last = {
            self.step.ground.now[symbol]: np.full(size, True)
            for symbol in self.step.ground.initial
            if symbol in self.step.ground.now
        }
        for k in range(length):
            columns.update((atom, numbers[:, k] == number) for number, atom in enumerate(self.step.occurs.values()))
            _evaluate(self._forward, self.step.bodies, columns, size)
            history.append(columns)
            last = columns
            columns = {before: columns[now] for now, before in self._carried if now in columns}
        bodies, strata = self._parts["ending"]
        last = {atom: column for atom, column in last.items() if atom not in bodies}
        _evaluate(strata, bodies, last, size)
        self._tell(last, told[length])
        bodies, strata = self._parts["hindsight"]
        for k in range(length - 1, -1, -1):
            columns = {atom: column for atom, column in history[k].items() if atom not in bodies}
            columns.update((atom, last[atom]) for atom, _, _ in self._rows if atom in last)
            _evaluate(strata, bodies, columns, size)
            last = {now: columns[before] for now, before in self._carried if before in columns}
            self._tell(last, told[k])
        return told

    def _tell(self, columns: Mapping[int, Column], told: Told) -> None:
        for atom, row, value in self._rows:
            if atom in columns:
                told[row, columns[atom]] = value


def _evaluate(
    strata: list[Stratum], bodies: Mapping[int, tuple[Body, ...]], columns: dict[int, Column], size: int
) -> None:
    false = np.zeros(size, dtype=np.bool_)
    evaluate(strata, bodies.__getitem__, columns, lambda atom: columns.get(atom, false), size)


def solved_states(program: Program, plan: Plan, fluents: Sequence[clingo.Symbol]) -> Told:
    """Return what is known of the states of one plan by solving the unrolled program: slower, for any program."""
    length = len(plan)
    grounder = Grounder(program, "1")
    grounder.ground([("base", [])])
    hindsight: list[Part] = [("hindsight", [clingo.Number(k)]) for k in range(1, length + 1)]
    grounder.ground([*unrolled(length), ("ending", [clingo.Number(length)]), *hindsight])
    atoms = grounder.control.symbolic_atoms
    occurring = [atoms[clingo.Function("occurs", [a, clingo.Number(k)])] for k, a in enumerate(plan, 1)]
    told = np.full((length + 1, len(fluents), 1), UNKNOWN, dtype=np.int8)
    rows = {fluent: row for row, fluent in enumerate(fluents)}
    with grounder.control.solve(assumptions=[a.literal for a in occurring if a], yield_=True) as handle:
        model = handle.model()
        assert model is not None, "the states of an invalid plan were asked for"
        for symbol in model.symbols(atoms=True):
            if symbol.match("state", 3) and symbol.arguments[0] in rows:
                fluent, value, time = symbol.arguments
                told[time.number, rows[fluent]] = TRUE if value.name == "true" else FALSE
    return told
