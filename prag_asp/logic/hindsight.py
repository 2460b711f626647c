"""What is known of the states that plans pass, with hindsight: many plans at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import clingo
import numpy as np

from prag_asp.domain.grounding import Grounder
from prag_asp.domain.sources import Program
from prag_asp.logic.ground import unrolled
from prag_asp.logic.normal import Body, NormalStep
from prag_asp.logic.strata import Column, Stratum, evaluate, stratify

Plan = tuple[clingo.Symbol, ...]
Known = dict[clingo.Symbol, bool]


@dataclass(frozen=True)
class Hindsight:
    """The rules of a step and of ``hindsight.lp``, evaluated on columns: one column for each plan."""

    step: NormalStep

    @cached_property
    def _forward(self) -> list[Stratum]:
        return stratify(self.step.ground.now.values(), self.step.bodies)

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

    def states(self, plans: Sequence[Plan]) -> list[list[Known]]:
        """Return for each plan, all of one length, what is known of its states 0..n."""
        length, size = len(plans[0]), len(plans)
        ground = self.step.ground
        history: list[dict[int, Column]] = []
        holding = {symbol: np.full(size, True) for symbol in ground.initial}
        for k in range(length):
            columns = {atom: holding[symbol] for symbol, atom in ground.before.items() if symbol in holding}
            for action, atom in self.step.occurs.items():
                columns[atom] = np.array([plan[k] == action for plan in plans])
            self._evaluate(self._forward, self.step.bodies, columns, size)
            history.append(columns)
            holding = {symbol: columns[atom] for symbol, atom in ground.now.items() if atom in columns}
        last = {ground.now[s]: column for s, column in holding.items() if s in ground.now}
        bodies, strata = self._parts["ending"]
        self._evaluate(strata, bodies, last, size)
        found = [_known(last, ground.now, size)]
        bodies, strata = self._parts["hindsight"]
        for columns in reversed(history):
            columns.update(
                (atom, last[atom]) for symbol, atom in ground.now.items() if symbol.name == "state" and atom in last
            )
            for atom in bodies:
                columns.pop(atom, None)
            self._evaluate(strata, bodies, columns, size)
            last = {
                ground.now[s]: columns[atom] for s, atom in ground.before.items() if s in ground.now and atom in columns
            }
            found.append(_known(last, ground.now, size))
        return [[state[plan] for state in reversed(found)] for plan in range(size)]

    def _evaluate(
        self,
        strata: list[Stratum],
        bodies: Mapping[int, tuple[Body, ...]],
        columns: dict[int, Column],
        size: int,
    ) -> None:
        false = np.zeros(size, dtype=np.bool_)
        evaluate(strata, bodies.__getitem__, columns, lambda atom: columns.get(atom, false), size)


def _known(columns: Mapping[int, Column], atoms: Mapping[clingo.Symbol, int], size: int) -> list[Known]:
    known: list[Known] = [{} for _ in range(size)]
    for symbol, atom in atoms.items():
        if symbol.name == "state" and atom in columns:
            fluent, value = symbol.arguments[0], symbol.arguments[1].name == "true"
            for plan in np.flatnonzero(columns[atom]):
                known[plan][fluent] = value
    return known


def solved_states(program: Program, plan: Plan) -> list[Known]:
    """Return what is known of the states of one plan by solving the unrolled program: slower, for any program."""
    length = len(plan)
    grounder = Grounder(program, "1")
    grounder.ground([("base", [])])
    grounder.ground([
        *unrolled(length),
        ("ending", [clingo.Number(length)]),
        *(("hindsight", [clingo.Number(k)]) for k in range(1, length + 1)),
    ])  # fmt: skip
    atoms = grounder.control.symbolic_atoms
    occurring = [atoms[clingo.Function("occurs", [a, clingo.Number(k)])] for k, a in enumerate(plan, 1)]
    states: list[Known] = [{} for _ in range(length + 1)]
    with grounder.control.solve(assumptions=[a.literal for a in occurring if a], yield_=True) as handle:
        model = handle.model()
        assert model is not None, "the states of an invalid plan were asked for"
        for symbol in model.symbols(atoms=True):
            if symbol.match("state", 3):
                fluent, value, time = symbol.arguments
                states[time.number][fluent] = value.name == "true"
    return states
