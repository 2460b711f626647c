"""The rules of a step in order of their dependencies, and an index of the rules that read each atom."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from prag_asp.logic.step.normal import NormalStep, RuleBody
from prag_asp.logic.step.simplify import ActionSum, Constants, as_bodies, simplify
from prag_asp.logic.step.strata import AtomStratum, stratify


@dataclass(frozen=True)
class StepRules:
    """The rules of a step on which `constraints` and the atoms `written` and `labels` depend, in order.

    `written` holds the atom of each variable after the step, or 0 if nothing derives it.
    """

    step: NormalStep
    constraints: tuple[RuleBody, ...]
    written: tuple[int, ...]
    labels: tuple[int, ...]

    @cached_property
    def strata(self) -> list[AtomStratum]:
        """The rules in order of their dependencies."""
        roots = [abs(literal) for body in self.constraints for literal in body.literals]
        return stratify([*roots, *self.written, *self.labels], self.step.bodies)

    @cached_property
    def order(self) -> Mapping[int, int]:
        """The index in `strata` of the stratum of each atom."""
        return {atom: place for place, stratum in enumerate(self.strata) for atom in stratum.atoms}

    @cached_property
    def actions(self) -> frozenset[int]:
        """The atoms of all actions."""
        return frozenset(self.step.occurs.values())

    @cached_property
    def no_action(self) -> Constants:
        """The atoms of all actions, all with the value false."""
        return dict.fromkeys(self.actions, False)

    @cached_property
    def idle(self) -> Mapping[int, tuple[RuleBody, ...]]:
        """The bodies of each atom, simplified for a step without an action."""
        return {
            atom: tuple(as_bodies(simplify(body, self.no_action) for body in self.step.bodies[atom]))
            for atom in self.order
        }

    @cached_property
    def idle_constraints(self) -> list[tuple[int, RuleBody]]:
        """The constraints, simplified for a step without an action, with their numbers."""
        return [
            (number, simplified)
            for number, body in enumerate(self.constraints)
            for simplified in as_bodies([simplify(body, self.no_action)])
        ]

    @cached_property
    def _by_action(self) -> Mapping[int, tuple[Mapping[int, list[RuleBody]], list[ActionSum], _Others]]:
        """Map each atom to the bodies that contain an action (keyed by action), the sums, and all other bodies."""
        table = {}
        for atom in self.order:
            by_action: dict[int, list[RuleBody]] = {}
            sums: list[ActionSum] = []
            others: list[RuleBody] = []
            for body in self.step.bodies[atom]:
                acting = [each for each in body.literals if each in self.actions]
                if body.weights:
                    sums.append(ActionSum.of(body, self.actions))
                else:
                    (by_action.setdefault(acting[0], []) if acting else others).append(body)
            table[atom] = (by_action, sums, _Others(others, self.no_action))
        return table

    def simplified_with(
        self, action: int, atom: int, constants: Constants, decided: Constants
    ) -> list[RuleBody | bool]:
        """Return those bodies of an atom, simplified, that may be true if one action occurs and no other.

        The constants consist of the actions and of the atoms that are `decided` if this action occurs.
        """
        by_action, sums, others = self._by_action[atom]
        own = [*by_action.get(action, ()), *(body for each in sums for body in each.with_action(action))]
        return [*(simplify(body, constants) for body in own), *others.simplified(action, constants, decided)]

    @cached_property
    def readers(self) -> Mapping[int, list[int]]:
        """The atoms whose rules read each atom."""
        return _index((atom, self.step.bodies[atom]) for stratum in self.strata for atom in stratum.atoms)

    @cached_property
    def constraint_readers(self) -> Mapping[int, list[int]]:
        """The numbers of the constraints that read each atom."""
        return _index((number, (body,)) for number, body in enumerate(self.constraints))

    @cached_property
    def places(self) -> Mapping[int, list[int]]:
        """The indices of the variables whose values each atom determines."""
        return _places(self.written)

    @cached_property
    def label_places(self) -> Mapping[int, list[int]]:
        """The indices of the labels whose values each atom determines."""
        return _places(self.labels)


def _index(reading: Iterator[tuple[int, tuple[RuleBody, ...]]]) -> dict[int, list[int]]:
    readers: dict[int, list[int]] = {}
    for reader, bodies in reading:
        for body in bodies:
            for literal in body.literals:
                readers.setdefault(abs(literal), []).append(reader)
    return readers


def _places(atoms: Sequence[int]) -> dict[int, list[int]]:
    places: dict[int, list[int]] = {}
    for place, atom in enumerate(atoms):
        places.setdefault(atom, []).append(place)
    return places


class _Others:
    """Bodies that contain no action positively, simplified once for all actions on which they do not depend."""

    def __init__(self, bodies: list[RuleBody], no_action: Constants) -> None:
        self._bodies = bodies
        self._idle = [simplify(body, no_action) for body in bodies]
        self._readers: dict[int, list[int]] = {}
        for number, body in enumerate(bodies):
            for literal in body.literals:
                self._readers.setdefault(abs(literal), []).append(number)

    def simplified(self, action: int, constants: Constants, decided: Constants) -> list[RuleBody | bool]:
        """Return the bodies, simplified for an action: without the `decided` atoms, only those that read it differ."""
        found = self._idle.copy()
        changed = set(self._readers.get(action, ()))
        changed.update(*(self._readers[atom] for atom in decided.keys() & self._readers.keys()))
        for number in changed:
            found[number] = simplify(self._bodies[number], constants)
        return found
