"""The step function of a domain on sets of states: the states in which each action is valid, and the changes it makes.

The rules are evaluated as in `Transition`, but with sets of states instead of columns: a conjunction is an
intersection, and a negation is the complement in the given set of states.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

import clingo

from prag_asp.logic.diagram.diagrams import EMPTY, Changes, Diagrams, Node
from prag_asp.logic.diagram.digits import Digits
from prag_asp.logic.step.moves import Move
from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.packed import unpack
from prag_asp.logic.step.strata import AtomStratum
from prag_asp.logic.step.transition import Transition

Read = Callable[[int], Node]


@dataclass(frozen=True)
class Piece:
    """States in which one action is valid and has the same effects.

    `letter` is the number of the action; `labels` are the indices of the labels that are true.
    """

    letter: int
    states: Node
    changes: Changes
    labels: tuple[int, ...]


@dataclass(frozen=True)
class SetStep:
    """A step function on sets of states."""

    transition: Transition
    digits: Digits
    diagrams: Diagrams

    def initial(self) -> Node:
        """Return the set of the initial state, which is empty if the initial values are contradictory."""
        rows = self.transition.initial
        return self.diagrams.word(self.digits.word(rows, len(self.transition.variables))) if len(rows) else EMPTY

    def accepted(self, states: Node) -> Node:
        """Return the states of a set in which a plan may end."""
        step = self.transition.step
        if not step.final:
            return states
        columns = self._columns(states, step.ground.now)
        values = _Values(self.diagrams, states, columns)
        values.evaluate(self.transition.final_strata, step.final_bodies.__getitem__)
        return self.diagrams.minus(states, self.diagrams.union(map(values.body, step.final)))

    def pieces(self, states: Node, look: Callable[[], None]) -> Iterator[Piece]:
        """Yield the pieces of a set of states for each action, in order; `look` is called before each action.

        The pieces of one action are disjoint.
        """
        rules = self.transition.rules
        before = _Values(self.diagrams, states, self._columns(states, self.transition.step.ground.before))
        before.evaluate(rules.strata, rules.idle.__getitem__)
        broken = {number: before.body(body) for number, body in rules.idle_constraints}
        broken = {number: where for number, where in broken.items() if where}
        everywhere = self.diagrams.union(broken.values())
        own = [self.diagrams.having(states, *self.digits.at[place]) for place in range(len(rules.written))]
        for letter in range(len(self.transition.actions)):
            look()
            move = self.transition.move(letter)
            if move.impossible:
                continue
            forbidden = everywhere
            if move.touched & broken.keys():
                forbidden = self.diagrams.union(where for number, where in broken.items() if number not in move.touched)
            valid = self.diagrams.minus(states, forbidden)
            for guard in move.guards:
                if not valid:
                    break
                valid = before.falsifying(valid, guard)
            if valid:
                yield from self._moved(move, letter, before, valid, own)

    def _moved(self, move: Move, letter: int, before: _Values, valid: Node, own: list[Node]) -> Iterator[Piece]:
        after = before.with_action(move)
        for body in move.constraints:
            valid = after.falsifying(valid, body)
            if not valid:
                return
        rules, size = self.transition.rules, len(own)
        unchanged = unpack(move.keep[None], size)[:, 0].tolist()
        put = unpack(move.put[None], size)[:, 0].tolist()
        decided = dict(move.changed)
        columns: dict[int, Node | bool] = {}
        for place in range(size):
            if place in decided:
                columns[place] = after.read(decided[place])
            elif not unchanged[place]:
                columns[place] = bool(put[place])
            elif before.read(rules.written[place]) != own[place]:
                columns[place] = before.read(rules.written[place])
        fixed, changing = dict(move.fixed_labels), dict(move.labels)
        labels: list[Node | bool] = [
            fixed[place] if place in fixed else after.read(changing[place]) if place in changing else before.read(atom)
            for place, atom in enumerate(rules.labels)
        ]
        for states, values, true in self._split(valid, columns, labels, own):
            changes: dict[int, tuple[int, int]] = {}
            for place, value in values.items():
                level, mask = self.digits.at[place]
                keep, put_there = changes.get(level, (-1, 0))
                changes[level] = (keep & ~mask, put_there | (mask if value else 0))
            yield Piece(letter, states, changes, true)

    def _split(
        self, valid: Node, columns: Mapping[int, Node | bool], labels: Iterable[Node | bool], own: list[Node]
    ) -> Iterator[tuple[Node, dict[int, bool], tuple[int, ...]]]:
        """Yield parts of a set, each with its effects: the values of changed variables, and the true labels."""
        parts: list[tuple[Node, dict[int, bool], tuple[int, ...]]] = [(valid, {}, ())]
        within, minus = self.diagrams.within, self.diagrams.minus
        for place, column in columns.items():
            refined = []
            for states, values, true in parts:
                if isinstance(column, bool):
                    refined.append((states, {**values, place: column}, true))
                    continue
                yes = within(states, column)
                if yes == within(states, own[place]):
                    refined.append((states, values, true))
                else:
                    both = (yes, True), (minus(states, yes), False)
                    refined += [(part, {**values, place: value}, true) for part, value in both if part]
            parts = refined
        for number, column in enumerate(labels):
            refined = []
            for states, values, true in parts:
                yes = (states if column else EMPTY) if isinstance(column, bool) else within(states, column)
                sides = (yes, (*true, number)), (minus(states, yes), true)
                refined += [(part, values, names) for part, names in sides if part]
            parts = refined
        yield from parts

    def _columns(self, states: Node, atoms: Mapping[clingo.Symbol, int]) -> dict[int, Node]:
        """Return the states of a set in which each variable among `atoms` is true, keyed by atom."""
        return {
            atoms[symbol]: self.diagrams.having(states, *self.digits.at[place])
            for place, symbol in enumerate(self.transition.variables)
            if symbol in atoms
        }


class _Values:
    """The subset of a set of states in which each atom is true; an atom that nothing derives is false."""

    def __init__(self, diagrams: Diagrams, states: Node, columns: dict[int, Node], under: Read | None = None) -> None:
        self._diagrams = diagrams
        self._states = states
        self._columns = columns
        self._under = under or (lambda atom: EMPTY)

    def with_action(self, move: Move) -> _Values:
        """Return the values for an action."""
        constants = {atom: self._states if value else EMPTY for atom, value in move.constants.items()}
        values = _Values(self._diagrams, self._states, constants, self.read)
        values.evaluate(move.strata, move.bodies.__getitem__)
        return values

    def read(self, atom: int) -> Node:
        """Return the states in which an atom is true."""
        states = self._columns.get(atom)
        return self._under(atom) if states is None else states

    def body(self, body: RuleBody) -> Node:
        """Return the states in which a body is true."""
        diagrams, states = self._diagrams, self._states
        if not body.weights:
            for literal in body.literals:
                if not states:
                    break
                where = self.read(abs(literal))
                states = diagrams.within(states, where) if literal > 0 else diagrams.minus(states, where)
            return states
        terms, bound = [], body.bound
        for literal, weight in zip(body.literals, body.weights, strict=True):
            if literal < 0:  # this weight counts unless the atom is true
                bound, weight = bound - weight, -weight  # noqa: PLW2901
            terms.append(diagrams.everywhere(self.read(abs(literal)), weight))
        total = diagrams.sum(terms)
        if bound > 0:
            return diagrams.mapped(total, lambda number: int(number >= bound))
        # States with sum 0 are not in a diagram.
        return diagrams.minus(states, diagrams.mapped(total, lambda number: int(number < bound)))

    def falsifying(self, states: Node, body: RuleBody) -> Node:
        """Return the states in a set for which a body is false."""
        if len(body.literals) == 1 and not body.weights:
            (literal,) = body.literals
            where = self.read(abs(literal))
            return self._diagrams.minus(states, where) if literal > 0 else self._diagrams.within(states, where)
        return self._diagrams.minus(states, self.body(body))

    def evaluate(self, strata: Iterable[AtomStratum], bodies: Callable[[int], tuple[RuleBody, ...]]) -> None:
        """Evaluate atoms in order of their dependencies; recursive strata are iterated to a fixpoint."""
        for stratum in strata:
            if stratum.recursive:
                self._columns.update(dict.fromkeys(stratum.atoms, EMPTY))
            changed = True
            while changed:
                changed = False
                for atom in stratum.atoms:
                    states = self._diagrams.union(map(self.body, bodies(atom)))
                    changed |= stratum.recursive and states != self._columns[atom]
                    self._columns[atom] = states
