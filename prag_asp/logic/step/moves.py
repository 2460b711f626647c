"""The rules of a step, partially evaluated for one action.

The ground rules are evaluated once without an action. An action then evaluates only the atoms that depend on it again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.packed import Rows, mask_of, words_for
from prag_asp.logic.step.simplify import Constants, simplify
from prag_asp.logic.step.step_rules import StepRules
from prag_asp.logic.step.strata import Stratum


@dataclass(frozen=True)
class Move:
    """The compiled rules of one action: guards over the state, rules, constraints, and the effect on the state.

    `touched` are the constraints that read the action. From the packed state after a step without an action, the bits
    `keep` stay, the bits `put` are set, and `changed` maps other places to the atoms that decide them; `labels` and
    `fixed_labels` are the same for labels. `constants` are the atoms whose truth the action alone decides.
    """

    guards: tuple[RuleBody, ...]
    strata: tuple[Stratum, ...]
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
    affected = _affected(rules, action)
    constants = {**rules.no_action, action: True}
    bodies, strata = _left_of_rules(rules, action, affected, constants)
    touched = {number for atom in (*affected, action) for number in rules.constraint_readers.get(atom, ())}
    simplified = [simplify(rules.constraints[number], constants) for number in sorted(touched)]
    residual = [body for body in simplified if isinstance(body, RuleBody)]
    guards = tuple(body for body in residual if not any(abs(literal) in affected for literal in body.literals))
    later = tuple(body for body in residual if any(abs(literal) in affected for literal in body.literals))
    constant_atoms = {atom: constants[atom] for atom in (action, *affected) if atom in constants}
    values = {place: value for atom, value in constant_atoms.items() for place in rules.places.get(atom, ())}
    changed = {place: atom for atom in affected if atom not in constant_atoms for place in rules.places.get(atom, ())}
    labels = [
        (place, atom) for atom in affected if atom not in constant_atoms for place in rules.label_places.get(atom, ())
    ]
    words = words_for(len(rules.written))
    roots = {*changed.values(), *(atom for _, atom in labels)}
    return Move(
        guards,
        _needed(strata, bodies, roots | {abs(literal) for body in later for literal in body.literals}),
        bodies,
        later,
        frozenset(touched),
        constant_atoms,
        any(body is True for body in simplified),
        keep=~mask_of([*values, *changed], words),
        put=mask_of([place for place, value in values.items() if value], words),
        changed=tuple(sorted(changed.items())),
        labels=tuple(sorted(labels)),
        fixed_labels=tuple(
            (place, value) for atom, value in constant_atoms.items() for place in rules.label_places.get(atom, ())
        ),
    )


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
    rules: StepRules, action: int, affected: set[int], constants: Constants
) -> tuple[dict[int, tuple[RuleBody, ...]], list[Stratum]]:
    """Return the partially evaluated bodies of the affected atoms and their strata; add to the constants."""
    bodies: dict[int, tuple[RuleBody, ...]] = {}
    strata = []
    for place in sorted({rules.order[atom] for atom in affected}):
        stratum = rules.strata[place]
        inside = set(stratum.atoms) if stratum.recursive else set()
        for atom in stratum.atoms:
            simplified = [simplify(body, constants) for body in rules.bodies_with(action, atom)]
            if any(body is True for body in simplified):
                constants[atom] = True
            elif atom not in inside and all(body is False for body in simplified):
                constants[atom] = False
            bodies[atom] = tuple([body for body in simplified if isinstance(body, RuleBody)])
        open_atoms = tuple(atom for atom in stratum.atoms if atom not in constants)
        if open_atoms:
            strata.append(Stratum(open_atoms, stratum.recursive))
    return bodies, strata


def _needed(
    strata: Sequence[Stratum], bodies: Mapping[int, tuple[RuleBody, ...]], roots: set[int]
) -> tuple[Stratum, ...]:
    """Return the strata on which the atoms `roots` still depend after simplification."""
    needed = set(roots)
    found = []
    for stratum in reversed(strata):
        if needed & set(stratum.atoms):
            needed |= {abs(literal) for atom in stratum.atoms for body in bodies[atom] for literal in body.literals}
            found.append(stratum)
    return tuple(reversed(found))
