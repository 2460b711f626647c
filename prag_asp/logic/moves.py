"""What is left of the rules of a step once its action is known.

The ground rules are evaluated once with no action; an action then evaluates again just the atoms that depend on it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from prag_asp.logic.normal import Body, NormalStep
from prag_asp.logic.packed import Rows, mask_of, words_for
from prag_asp.logic.strata import Stratum, stratify


@dataclass(frozen=True)
class Move:
    """One action: guards over the state, then rules, then constraints, then what of the state after it is set.

    `touched` are the constraints that read the action. Of the packed state that no action leaves, the bits `keep`
    stay, the bits `put` are set, and `changed` says which other places an atom decides; `labels` and `fixed_labels`
    are the same for labels. `constants` are the atoms whose truth the action alone decides.
    """

    guards: tuple[Body, ...]
    strata: tuple[Stratum, ...]
    bodies: Mapping[int, tuple[Body, ...]]
    constraints: tuple[Body, ...]
    touched: frozenset[int]
    constants: Mapping[int, bool]
    impossible: bool
    keep: Rows
    put: Rows
    changed: tuple[tuple[int, int], ...]
    labels: tuple[tuple[int, int], ...]
    fixed_labels: tuple[tuple[int, bool], ...]


@dataclass(frozen=True)
class StepRules:
    """The rules of a step that `constraints` and the atoms `written` and `labels` depend on, in order.

    `written` holds the atom of each variable after the step, 0 where nothing derives it.
    """

    step: NormalStep
    constraints: tuple[Body, ...]
    written: tuple[int, ...]
    labels: tuple[int, ...]

    @cached_property
    def strata(self) -> list[Stratum]:
        """The rules in order of their dependencies."""
        roots = [abs(literal) for body in self.constraints for literal in body.literals]
        return stratify([*roots, *self.written, *self.labels], self.step.bodies)

    @cached_property
    def order(self) -> Mapping[int, int]:
        """The place of each atom in `strata`."""
        return {atom: place for place, stratum in enumerate(self.strata) for atom in stratum.atoms}

    @cached_property
    def actions(self) -> frozenset[int]:
        """The atoms of all actions."""
        return frozenset(self.step.occurs.values())

    @cached_property
    def readers(self) -> Mapping[int, list[int]]:
        """For each atom, the atoms that its value can change."""
        return _index((atom, self.step.bodies[atom]) for stratum in self.strata for atom in stratum.atoms)

    @cached_property
    def constraint_readers(self) -> Mapping[int, list[int]]:
        """For each atom, the numbers of the constraints that read it."""
        return _index((number, (body,)) for number, body in enumerate(self.constraints))

    @cached_property
    def places(self) -> Mapping[int, list[int]]:
        """For each atom, the variables that it decides."""
        return _places(self.written)

    @cached_property
    def label_places(self) -> Mapping[int, list[int]]:
        """For each atom, the labels that it decides."""
        return _places(self.labels)


def _index(reading: Iterator[tuple[int, tuple[Body, ...]]]) -> dict[int, list[int]]:
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


def compile_move(rules: StepRules, action: int) -> Move:
    """Return what is left of the rules once the atom `action` is true and no other action is."""
    affected = _affected(rules, action)
    constants = _Constants(rules.actions, action)
    bodies, strata = _left_of_rules(rules, affected, constants)
    touched = {number for atom in (*affected, action) for number in rules.constraint_readers.get(atom, ())}
    left = [simplified(rules.constraints[number], constants) for number in sorted(touched)]
    residual = [body for body in left if isinstance(body, Body)]
    guards = tuple(body for body in residual if not any(abs(literal) in affected for literal in body.literals))
    later = tuple(body for body in residual if any(abs(literal) in affected for literal in body.literals))
    known = {atom: value for atom, value in constants.items() if atom in affected or atom == action}
    values = {place: value for atom, value in known.items() for place in rules.places.get(atom, ())}
    changed = {place: atom for atom in affected if atom not in known for place in rules.places.get(atom, ())}
    labels = [(place, atom) for atom in affected if atom not in known for place in rules.label_places.get(atom, ())]
    words = words_for(len(rules.written))
    wanted = {*changed.values(), *(atom for _, atom in labels)}
    return Move(
        guards,
        _needed(strata, bodies, wanted | {abs(literal) for body in later for literal in body.literals}),
        bodies,
        later,
        frozenset(touched),
        known,
        any(body is True for body in left),
        keep=~mask_of([*values, *changed], words),
        put=mask_of([place for place, value in values.items() if value], words),
        changed=tuple(sorted(changed.items())),
        labels=tuple(sorted(labels)),
        fixed_labels=tuple(
            (place, value) for atom, value in known.items() for place in rules.label_places.get(atom, ())
        ),
    )


class _Constants(dict[int, bool]):
    """The atoms of known truth, among them that no other action occurs."""

    def __init__(self, actions: frozenset[int], action: int) -> None:
        super().__init__({action: True})
        self._actions = actions

    def known(self, atom: int) -> bool | None:
        """Return the truth of an atom, or None where the action does not decide it."""
        found = self.get(atom)
        return False if found is None and atom in self._actions else found


def _affected(rules: StepRules, action: int) -> set[int]:
    affected: set[int] = set()
    waiting = [action]
    while waiting:
        for reader in rules.readers.get(waiting.pop(), ()):
            if reader not in affected:
                affected.add(reader)
                waiting.append(reader)
    return affected


def _left_of_rules(
    rules: StepRules, affected: set[int], constants: _Constants
) -> tuple[dict[int, tuple[Body, ...]], list[Stratum]]:
    """Return what is left of the bodies of the atoms affected, and these in order; learn what is constant."""
    bodies: dict[int, tuple[Body, ...]] = {}
    strata = []
    for place in sorted({rules.order[atom] for atom in affected}):
        stratum = rules.strata[place]
        inside = set(stratum.atoms) if stratum.recursive else set()
        for atom in stratum.atoms:
            left = [simplified(body, constants) for body in rules.step.bodies[atom]]
            if any(body is True for body in left):
                constants[atom] = True
            elif atom not in inside and all(body is False for body in left):
                constants[atom] = False
            bodies[atom] = tuple(body for body in left if isinstance(body, Body))
        open_atoms = tuple(atom for atom in stratum.atoms if atom not in constants)
        if open_atoms:
            strata.append(Stratum(open_atoms, stratum.recursive))
    return bodies, strata


def _needed(strata: Sequence[Stratum], bodies: Mapping[int, tuple[Body, ...]], roots: set[int]) -> tuple[Stratum, ...]:
    """Return the strata that the atoms `roots` still depend on after simplification."""
    needed = set(roots)
    found = []
    for stratum in reversed(strata):
        if needed & set(stratum.atoms):
            needed |= {abs(literal) for atom in stratum.atoms for body in bodies[atom] for literal in body.literals}
            found.append(stratum)
    return tuple(reversed(found))


def simplified(body: Body, constants: _Constants) -> Body | bool:
    """Return a body without its literals of known truth, or its truth where that decides it."""
    if body.weights:
        return _simplified_sum(body, constants)
    literals = []
    for literal in body.literals:
        known = constants.known(abs(literal))
        if known is None:
            literals.append(literal)
        elif known != (literal > 0):
            return False
    return Body(tuple(literals)) if literals else True


def _simplified_sum(body: Body, constants: _Constants) -> Body | bool:
    bound, literals, weights = body.bound, [], []
    for literal, weight in zip(body.literals, body.weights, strict=True):
        known = constants.known(abs(literal))
        if known is None:
            literals.append(literal)
            weights.append(weight)
        elif known == (literal > 0):
            bound -= weight
    if bound <= 0:
        return True
    if sum(weights) < bound:
        return False
    return Body(tuple(literals), bound, tuple(weights))
