"""The symbolic evaluation of a step's rules: the state after the step as Boolean functions of the state before it.

The ground rules are evaluated as in the engines. A fluent that is known in every state is one proposition; any other
fluent has one proposition for "known to be true" and one for "known to be false". Other state variables of the rules
are further propositions.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass

import clingo
import numpy as np

from prag_asp.logic.diagram.functions import FALSE, TRUE, Functions, Node
from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.packed import unpack
from prag_asp.logic.step.strata import AtomStratum
from prag_asp.logic.step.transition import Transition
from prag_asp.planners.ground_action import CARRIED, NOT_TRUE, Proposition
from prag_asp.program.predicates import HOLDS

Read = Callable[[int], Node]
After = Mapping[int, Node]
"""The functions of the variables that a step may change."""


@dataclass(frozen=True)
class ActionFunctions:
    """The effects of an action as functions; a function in `refused` forbids the action where the function is true."""

    refused: tuple[Node, ...]
    after: After


class StepFunctions:
    """A step as functions of the state before it; `unknown` holds the fluents that may be unknown.

    Raises:
        TooLarge: a function has too many variables or too many nodes.
    """

    def __init__(self, transition: Transition, unknown: Collection[clingo.Symbol], functions: Functions) -> None:
        self._transition = transition
        self._functions = functions
        self._literals = [_proposition(symbol, unknown) for symbol in transition.variables]
        self.propositions = list(dict.fromkeys(proposition for proposition, _ in self._literals))
        numbers = {proposition: number for number, proposition in enumerate(self.propositions)}
        self._own = [(numbers[proposition], value) for proposition, value in self._literals]
        self._variables: list[dict[bool, int]] = [{} for _ in self.propositions]
        for variable, (number, value) in enumerate(self._own):
            self._variables[number][value] = variable
        rules = transition.rules
        self._idle = self._state(transition.step.ground.before)
        self._evaluate(rules.strata, rules.idle.__getitem__, self._idle, {})
        self._refusing = {number: self._body(body, self._before) for number, body in rules.idle_constraints}
        changing = (
            variable for variable, atom in enumerate(rules.written) if self._before(atom) != self._left(variable)
        )
        self._moving = {variable: self._before(rules.written[variable]) for variable in changing}

    @property
    def first(self) -> dict[int, bool]:
        """The initial values of all propositions, by number."""
        start = self._transition.step.ground.initial
        symbols = self._transition.variables
        return {number: (symbols[variable] in start) == value for variable, (number, value) in enumerate(self._own)}

    def opposed(self, fluent: clingo.Symbol, value: str) -> tuple[int, bool] | None:
        """Return the literal for "the fluent is not known to have this value".

        The result is None if the fluent never has the value.
        """
        symbol = holds(fluent, value)
        if symbol not in self._transition.variables:
            return None
        number, value_if_true = self._own[self._transition.variables.index(symbol)]
        return number, not value_if_true

    def tried(self, letter: int) -> ActionFunctions | None:
        """Return the functions for an action, given by its number, or None if the action never occurs."""
        move = self._transition.move(letter)
        if move.impossible:
            return None
        values = {atom: TRUE if value else FALSE for atom, value in move.constants.items()}
        self._evaluate(move.strata, move.bodies.__getitem__, values, self._idle)

        def read(atom: int) -> Node:
            return values.get(atom, self._before(atom))

        refused = [self._body(body, read) for body in (*move.guards, *move.constraints)]
        refused += [function for number, function in self._refusing.items() if number not in move.touched]
        unchanged, put = (unpack(np.atleast_2d(mask), len(self._own))[:, 0] for mask in (move.keep, move.put))
        changed = dict(move.changed)
        after = dict(self._moving)
        for variable in np.flatnonzero(~unchanged).tolist():
            constant = TRUE if put[variable] else FALSE
            after[variable] = read(changed[variable]) if variable in changed else constant
        return ActionFunctions(tuple(refused), after)

    def changed(self, after: After) -> list[int]:
        """Return the numbers of the propositions that may change."""
        return sorted({self._own[variable][0] for variable in after})

    def becomes(self, number: int, after: After) -> Node:
        """Return the function that is true if a proposition is true after a step."""
        value, variable = next(iter(self._variables[number].items()))
        function = after.get(variable, self._left(variable))
        return function if value else self._functions.opposite(function)

    def undecided(self, number: int, after: After) -> Node:
        """Return the function that is true if a fluent is unknown after a step."""
        variables = self._variables[number]
        if len(variables) < 2:
            return FALSE
        true, false = (after.get(variables[value], self._left(variables[value])) for value in (True, False))
        return self._functions.choice(true, false, self._functions.opposite(false))

    def refused_at_end(self) -> list[Node]:
        """Return the functions that forbid a final state in which they are true."""
        step = self._transition.step
        values = self._state(step.ground.now)
        self._evaluate(self._transition.final_strata, step.final_bodies.__getitem__, values, {})
        return [self._body(body, lambda atom: values.get(atom, FALSE)) for body in step.final]

    def _left(self, variable: int) -> Node:
        number, value = self._own[variable]
        return self._functions.variable(number, value=value)

    def _state(self, atoms: Mapping[clingo.Symbol, int]) -> dict[int, Node]:
        """Return a function for each atom that describes a state."""
        symbols = self._transition.variables
        return {atoms[symbol]: self._left(variable) for variable, symbol in enumerate(symbols) if symbol in atoms}

    def _before(self, atom: int) -> Node:
        return self._idle.get(atom, FALSE)

    def _evaluate(
        self,
        strata: Iterable[AtomStratum],
        bodies: Callable[[int], tuple[RuleBody, ...]],
        values: dict[int, Node],
        under: Mapping[int, Node],
    ) -> None:
        """Add functions for the atoms in the strata to `values`; recursive strata are iterated to a fixpoint."""

        def read(atom: int) -> Node:
            return values.get(atom, under.get(atom, FALSE))

        for stratum in strata:
            if stratum.recursive:
                values.update(dict.fromkeys(stratum.atoms, FALSE))
            grows = True
            while grows:
                grows = False
                for atom in stratum.atoms:
                    function = self._functions.any(self._body(body, read) for body in bodies(atom))
                    grows |= stratum.recursive and function != values[atom]
                    values[atom] = function

    def _body(self, body: RuleBody, read: Read) -> Node:
        literals = [
            read(literal) if literal > 0 else self._functions.opposite(read(-literal)) for literal in body.literals
        ]
        if body.weights:
            return self._functions.at_least(body.bound, list(zip(literals, body.weights, strict=True)))
        return self._functions.all(literals)


def holds(fluent: clingo.Symbol, value: str) -> clingo.Symbol:
    """Return the state variable for a known value of a fluent."""
    return HOLDS.timeless(fluent, clingo.Function(value))


def _proposition(symbol: clingo.Symbol, unknown: Collection[clingo.Symbol]) -> tuple[Proposition, bool]:
    """Return the proposition of a state variable, with its value if the variable is true."""
    if not symbol.match(*HOLDS.without_time):
        return Proposition(symbol, CARRIED), True
    fluent, value = symbol.arguments
    if fluent in unknown:
        return Proposition(fluent, "" if value.name == "true" else NOT_TRUE), True
    return Proposition(fluent), value.name == "true"
