"""The rules of a step, partially evaluated for one action.

The ground rules are evaluated once without an action. For each action, only the atoms that depend on it are then
evaluated again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.packed import Rows, mask_of, words_for
from prag_asp.logic.step.simplify import Constants, simplify
from prag_asp.logic.step.step_rules import StepRules
from prag_asp.logic.step.strata import AtomStratum


@dataclass(frozen=True)
class Move:
    """The compiled rules of one action: guards over the state, rules, constraints, and the effect on the state.

    `touched` are the constraints that read the action. The effect changes the packed state after a step without an
    action: the bits `keep` are kept, the bits `put` are set, and `changed` pairs the indices of other variables with
    the atoms that determine their values; `labels` and `fixed_labels` do the same for labels. `constants` are the atoms
    whose truth depends only on the action.
    """

    guards: tuple[RuleBody, ...]
    strata: tuple[AtomStratum, ...]
    bodies: Mapping[int, tuple[RuleBody, ...]]
    constraints: tuple[RuleBody, ...]
    touched: frozenset[int]
    constants: Mapping[int, bool]
    impossible: bool
    keep: Rows
    put: Rows
    changed: tuple[tuple[int, int], ...]
    labels: tuple[tuple[int, int], ...]
    fixed_labels: tuple[tuple[int, bool], ...]


def compile_move(rules: StepRules, action: int) -> Move:
    """Return the rules partially evaluated for the atom `action`, with all other actions false."""
    affected: set[int] = set()
    waiting = [action]
    while waiting:
        new = set(rules.readers.get(waiting.pop(), ())) - affected
        affected |= new
        waiting += new
    constants = {**rules.no_action, action: True}
    bodies, strata = _left_of_rules(rules, action, affected, constants)
    touched = {number for atom in (*affected, action) for number in rules.constraint_readers.get(atom, ())}
    simplified = [simplify(rules.constraints[number], constants) for number in sorted(touched)]
    guards: list[RuleBody] = []
    later: list[RuleBody] = []
    for body in simplified:
        if isinstance(body, RuleBody):
            (guards if affected.isdisjoint(map(abs, body.literals)) else later).append(body)
    decided = {atom: constants[atom] for atom in (action, *affected) if atom in constants}
    values = {place: value for atom, value in decided.items() for place in rules.places.get(atom, ())}
    fixed = {place: value for atom, value in decided.items() for place in rules.label_places.get(atom, ())}
    changed = {place: atom for atom in affected - decided.keys() for place in rules.places.get(atom, ())}
    labels = {place: atom for atom in affected - decided.keys() for place in rules.label_places.get(atom, ())}
    # The strata on which the effects and the constraints still depend after simplification.
    needed = {*changed.values(), *labels.values(), *(abs(literal) for body in later for literal in body.literals)}
    remaining: list[AtomStratum] = []
    for stratum in reversed(strata):
        if not needed.isdisjoint(stratum.atoms):
            needed |= {abs(literal) for atom in stratum.atoms for body in bodies[atom] for literal in body.literals}
            remaining.insert(0, stratum)
    words = words_for(len(rules.written))
    return Move(
        tuple(guards), tuple(remaining), bodies, tuple(later), frozenset(touched), decided,
        impossible=any(body is True for body in simplified),
        keep=~mask_of([*values, *changed], words), put=mask_of([place for place in values if values[place]], words),
        changed=tuple(sorted(changed.items())), labels=tuple(sorted(labels.items())), fixed_labels=tuple(fixed.items()),
    )  # fmt: skip


def _left_of_rules(
    rules: StepRules, action: int, affected: set[int], constants: Constants
) -> tuple[dict[int, tuple[RuleBody, ...]], list[AtomStratum]]:
    """Return the partially evaluated bodies of the affected atoms, and their strata; extend the constants."""
    bodies: dict[int, tuple[RuleBody, ...]] = {}
    decided: Constants = {}
    strata = []
    for place in sorted({rules.order[atom] for atom in affected}):
        stratum = rules.strata[place]
        inside = set(stratum.atoms) if stratum.recursive else set()
        for atom in stratum.atoms:
            simplified = rules.simplified_with(action, atom, constants, decided)
            if any(body is True for body in simplified):
                constants[atom] = decided[atom] = True
            elif atom not in inside and all(body is False for body in simplified):
                constants[atom] = decided[atom] = False
            bodies[atom] = tuple([body for body in simplified if isinstance(body, RuleBody)])
        open_atoms = tuple(atom for atom in stratum.atoms if atom not in constants)
        if open_atoms:
            strata.append(AtomStratum(open_atoms, stratum.recursive))
    return bodies, strata
