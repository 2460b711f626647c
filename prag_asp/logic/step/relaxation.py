"""A lower bound on the number of steps from a state to the end of a plan, for many states at once.

The bound is h_max (Bonet and Geffner, Planning as heuristic search, 2001) on the Cartesian abstraction of states
(Cousot and Cousot 1977). For each variable, "may be true" and "may be false" are separate facts that are never removed:
deletes and exclusive values are ignored. The first step after which a relaxed plan may end is then no later than the
end of any plan. An unknown value is neither known to be true nor known to be false, so it needs no special case.

The facts after a step are monotone in the facts before it. One step is therefore a circuit without negations, which is
evaluated for 64 states at once, one per bit of a word.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.circuit import FALSE, TRUE, Circuit, Gates
from prag_asp.logic.step.moves import Move
from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.packed import Rows, unpack
from prag_asp.logic.step.strata import AtomStratum
from prag_asp.logic.step.transition import Transition

MOST_ROUNDS = 16
"""The maximum size of a recursive stratum that is evaluated; atoms of larger strata may have any value."""

ROOM = 2**23
"""The maximum memory in bytes for the operands of one gate."""

May = tuple[int, int]
"""The gates for "may be true" and "may be false" of an atom."""

NEVER: May = (FALSE, TRUE)
ALWAYS: May = (TRUE, FALSE)
ANYTHING: May = (TRUE, TRUE)


@dataclass(frozen=True)
class Relaxation:
    """One relaxed step: the gates of the variables after it, and the gate that is true if a plan may end before it.

    The inputs are "may be true" and "may be false" for each variable; `after` has their gates in the same order.
    """

    variables: int
    circuit: Circuit
    after: NDArray[np.intp]
    ends: int

    def within(self, states: Rows, left: int) -> tuple[NDArray[np.bool_], bool]:
        """Return which states may be within `left` steps of the end, and whether no other state can reach the end.

        The first result has shape (states,).
        """
        near = np.empty(len(states), dtype=np.bool_)
        together = 64 * max(ROOM // (8 * self.circuit.widest), 4)
        forever = True
        for first in range(0, len(states), together):
            some = states[first : first + together]
            inputs = self._inputs(some)
            for steps in range(left + 1):
                values = self.circuit.evaluate(inputs)
                ended, following = values[self.ends], values[self.after]
                settled = bool((~ended == 0).all()) or np.array_equal(following, inputs)
                if settled or steps == left:
                    break
                inputs = following
            octets = ended.view(np.uint8)
            near[first : first + together] = np.unpackbits(octets, count=len(some), bitorder="little").view(np.bool_)
            forever &= settled
        return near, forever

    def _inputs(self, states: Rows) -> NDArray[np.uint64]:
        """Return the inputs, 64 states per word, shape (inputs, words), padded by repeating one of the states."""
        columns = unpack(states, self.variables)
        columns = np.pad(columns, ((0, 0), (0, -len(states) % 64)), mode="edge")
        true = np.packbits(columns, axis=1, bitorder="little").view(np.uint64)
        return np.stack([true, ~true], axis=1).reshape(2 * self.variables, columns.shape[1] // 64)


def relax(transition: Transition) -> Relaxation:
    """Return the relaxation of a step function."""
    gates = Gates(2 * len(transition.variables))
    inputs = [(gates.input(2 * place), gates.input(2 * place + 1)) for place in range(len(transition.variables))]
    step = _Relaxed(transition, gates, inputs)
    roots = [gate for after in step.after() for gate in after]
    ends = step.ends()
    circuit, numbers = gates.circuit([*roots, ends])
    after = np.array([numbers[gate] for gate in roots], dtype=np.intp)
    return Relaxation(len(transition.variables), circuit, after, numbers[ends])


class _Relaxed:
    """The gates of a step under construction."""

    def __init__(self, transition: Transition, gates: Gates, inputs: Sequence[May]) -> None:
        self._transition, self._gates, self._inputs = transition, gates, inputs
        self._idle = self._values(transition.step.ground.before)
        self._evaluate(transition.rules.strata, transition.rules.idle, self._idle, self._idle_value)

    def after(self) -> list[May]:
        """Return the facts of each variable after the step, which include the facts before it."""
        idle = map(self._idle_value, self._transition.rules.written)
        pairs = [tuple(zip(before, after, strict=True)) for before, after in zip(self._inputs, idle, strict=True)]
        true, false = ([list(pair[side]) for pair in pairs] for side in (0, 1))
        for letter in range(len(self._transition.actions)):
            move = self._transition.move(letter)
            if not move.impossible:
                self._add_effects(move, true, false)
        return [(self._gates.any(may), self._gates.any(may_not)) for may, may_not in zip(true, false, strict=True)]

    def ends(self) -> int:
        """Return the gate that is true if a plan may end."""
        transition, final = self._transition, self._transition.step.final
        values = self._values(transition.step.ground.now)

        def read(atom: int) -> May:
            return values.get(atom, NEVER)

        self._evaluate(transition.final_strata, transition.step.final_bodies, values, read)
        return self._gates.all(self._false(body, read) for body in final)

    def _add_effects(self, move: Move, true: list[list[int]], false: list[list[int]]) -> None:
        """Add the values that an action may give to the variables that it affects."""
        values: dict[int, May] = {}

        def value(atom: int) -> May:
            if atom in move.constants:
                return ALWAYS if move.constants[atom] else NEVER
            return values[atom] if atom in values else self._idle_value(atom)

        self._evaluate(move.strata, move.bodies, values, value)
        occurs = self._gates.all([*(self._false(body, self._idle_value) for body in move.guards),
                                  *(self._false(body, value) for body in move.constraints)])  # fmt: skip
        changed, put = dict(move.changed), unpack(move.put[None], len(self._inputs))[:, 0]
        for place in self._transition.places_set(move):
            may = value(changed[place]) if place in changed else ALWAYS if put[place] else NEVER
            true[place].append(self._gates.all((occurs, may[0])))
            false[place].append(self._gates.all((occurs, may[1])))

    def _evaluate(
        self,
        strata: Iterable[AtomStratum],
        bodies: Mapping[int, tuple[RuleBody, ...]],
        values: dict[int, May],
        value: Callable[[int], May],
    ) -> None:
        """Add the facts of the atoms in the given strata to `values`; `value` reads these and all other facts."""
        for stratum in strata:
            if not stratum.recursive:
                values |= {atom: self._value(bodies[atom], value) for atom in stratum.atoms}
                continue
            evaluated = len(stratum.atoms) <= MOST_ROUNDS
            # In the least model, a true atom is derived within as many rounds as there are atoms. It is always assumed
            # that an atom may be false.
            values |= dict.fromkeys(stratum.atoms, NEVER if evaluated else ANYTHING)
            for _ in range(len(stratum.atoms) if evaluated else 0):
                values |= {atom: (self._value(bodies[atom], value)[0], TRUE) for atom in stratum.atoms}

    def _value(self, bodies: Sequence[RuleBody], value: Callable[[int], May]) -> May:
        """Return the gates of an atom with the given bodies; a sum with a positive bound requires a true literal."""
        true = []
        for body in bodies:
            literals = [value(abs(literal))[literal < 0] for literal in body.literals]
            if not body.weights:
                true.append(self._gates.all(literals))
            else:
                is_open = body.bound > 0 and min(body.weights) >= 0
                true.append(self._gates.any(literals) if is_open else TRUE)
        return self._gates.any(true), self._gates.all(self._false(body, value) for body in bodies)

    def _false(self, body: RuleBody, value: Callable[[int], May]) -> int:
        """Return the gate for "may be false" of a body; a sum is always assumed to be possibly false."""
        if body.weights:
            return TRUE
        return self._gates.any(value(abs(literal))[literal > 0] for literal in body.literals)

    def _values(self, atoms: Mapping[clingo.Symbol, int]) -> dict[int, May]:
        """Return the facts of the variables among `atoms`."""
        pairs = zip(self._transition.variables, self._inputs, strict=True)
        return {atoms[symbol]: may for symbol, may in pairs if symbol in atoms}

    def _idle_value(self, atom: int) -> May:
        return self._idle.get(atom, NEVER)
