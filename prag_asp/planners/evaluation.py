"""The rules of a step with Boolean functions in place of states: what is so after it, as a function of what is before.

The ground rules are evaluated as the engines evaluate them. A fluent that is known in every state is one proposition;
of another, that it is known to be true is one, and that it is known to be false another. What else the rules carry from
step to step are further propositions.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass

import clingo
import numpy as np

from prag_asp.logic.diagram.functions import FALSE, TRUE, Functions, Node
from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.packed import unpack
from prag_asp.logic.step.strata import Stratum
from prag_asp.logic.step.transition import Transition
from prag_asp.planners.ground_action import CARRIED, NOT_TRUE, Proposition
from prag_asp.program.predicates import HOLDS

Read = Callable[[int], Node]
After = Mapping[int, Node]
"""The functions of variables after a step, where they are not just those before it."""


@dataclass(frozen=True)
class ActionFunctions:
    """The effects of an action as functions; each of `refused` forbids the action in the states where it is true."""

    refused: tuple[Node, ...]
    after: After


class StepFunctions:
    """A step as functions of the state before it; `unknown` are the fluents that need not be known in it.

    Raises:
        TooLarge: a function has too many variables, or too many nodes.
    """

    def __init__(self, transition: Transition, unknown: Collection[clingo.Symbol], functions: Functions) -> None:
        self._transition = transition
        self._functions = functions
        self._literals = [_proposition(symbol, unknown) for symbol in transition.variables]
        self.propositions = list(dict.fromkeys(each for each, _ in self._literals))
        numbers = {each: number for number, each in enumerate(self.propositions)}
        self._own = [(numbers[each], value) for each, value in self._literals]
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
        """The values of all propositions at first, by their numbers."""
        start = self._transition.step.ground.initial
        symbols = self._transition.variables
        return {number: (symbols[variable] in start) == value for variable, (number, value) in enumerate(self._own)}

    def opposed(self, fluent: clingo.Symbol, value: str) -> tuple[int, bool] | None:
        """Return the value of a proposition that says that a fluent is not known to have a value.

        None where it never has the value.
        """
        symbol = holds(fluent, value)
        if symbol not in self._transition.variables:
            return None
        number, so = self._own[self._transition.variables.index(symbol)]
        return number, not so

    def tried(self, letter: int) -> ActionFunctions | None:
        """Return what the action of a number makes, None where it never occurs."""
        move = self._transition.move(letter)
        if move.impossible:
            return None
        values = {atom: TRUE if value else FALSE for atom, value in move.constants.items()}
        self._evaluate(move.strata, move.bodies.__getitem__, values, self._idle)

        def read(atom: int) -> Node:
            return values.get(atom, self._before(atom))

        refused = [self._body(body, read) for body in (*move.guards, *move.constraints)]
        refused += [each for number, each in self._refusing.items() if number not in move.touched]
        kept, put = (unpack(np.atleast_2d(each), len(self._own))[:, 0] for each in (move.keep, move.put))
        changed = dict(move.changed)
        after = dict(self._moving)
        for variable in np.flatnonzero(~kept).tolist():
            constant = TRUE if put[variable] else FALSE
            after[variable] = read(changed[variable]) if variable in changed else constant
        return ActionFunctions(tuple(refused), after)

    def changed(self, after: After) -> list[int]:
        """Return the numbers of propositions that may change."""
        return sorted({self._own[variable][0] for variable in after})

    def becomes(self, number: int, after: After) -> Node:
        """Return where a proposition is true after a step."""
        value, variable = next(iter(self._variables[number].items()))
        found = after.get(variable, self._left(variable))
        return found if value else self._functions.opposite(found)

    def undecided(self, number: int, after: After) -> Node:
        """Return where a fluent that is one proposition is not either true or false after a step."""
        variables = self._variables[number]
        if len(variables) < 2:
            return FALSE
        true, false = (after.get(variables[value], self._left(variables[value])) for value in (True, False))
        return self._functions.choice(true, false, self._functions.opposite(false))

    def refused_at_end(self) -> list[Node]:
        """Return what forbids a state as the last one: each function, where it is true."""
        step = self._transition.step
        values = self._state(step.ground.now)
        self._evaluate(self._transition.final_strata, step.final_bodies.__getitem__, values, {})
        return [self._body(body, lambda atom: values.get(atom, FALSE)) for body in step.final]

    def _left(self, variable: int) -> Node:
        number, value = self._own[variable]
        return self._functions.variable(number, value=value)

    def _state(self, atoms: Mapping[clingo.Symbol, int]) -> dict[int, Node]:
        """Return the functions of the atoms of a state."""
        symbols = self._transition.variables
        return {atoms[each]: self._left(variable) for variable, each in enumerate(symbols) if each in atoms}

    def _before(self, atom: int) -> Node:
        return self._idle.get(atom, FALSE)

    def _evaluate(
        self,
        strata: Iterable[Stratum],
        bodies: Callable[[int], tuple[RuleBody, ...]],
        values: dict[int, Node],
        under: Mapping[int, Node],
    ) -> None:
        """Add the functions of the atoms of some strata to `values`; those that derive each other, until none grows."""

        def read(atom: int) -> Node:
            return values.get(atom, under.get(atom, FALSE))

        for stratum in strata:
            if stratum.recursive:
                values.update(dict.fromkeys(stratum.atoms, FALSE))
            grows = True
            while grows:
                grows = False
                for atom in stratum.atoms:
                    found = self._functions.any(self._body(body, read) for body in bodies(atom))
                    grows |= stratum.recursive and found != values[atom]
                    values[atom] = found

    def _body(self, body: RuleBody, read: Read) -> Node:
        literals = [
            read(literal) if literal > 0 else self._functions.opposite(read(-literal)) for literal in body.literals
        ]
        if body.weights:
            return self._functions.at_least(body.bound, list(zip(literals, body.weights, strict=True)))
        return self._functions.all(literals)


def holds(fluent: clingo.Symbol, value: str) -> clingo.Symbol:
    """Return how a variable of a state is called that says what is known of a fluent."""
    return HOLDS.timeless(fluent, clingo.Function(value))


def _proposition(symbol: clingo.Symbol, unknown: Collection[clingo.Symbol]) -> tuple[Proposition, bool]:
    """Return the proposition that a variable of a state is, with the value that it has where the variable is true."""
    if not symbol.match(*HOLDS.without_time):
        return Proposition(symbol, CARRIED), True
    fluent, value = symbol.arguments
    if fluent in unknown:
        return Proposition(fluent, "" if value.name == "true" else NOT_TRUE), True
    return Proposition(fluent), value.name == "true"
