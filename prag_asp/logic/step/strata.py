"""Stratification of ground rules, and their evaluation in many states at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from prag_asp.errors import EngineError
from prag_asp.logic.ground.ground_step import GroundStep
from prag_asp.logic.step.bit_columns import all_true, bits_of, column_of
from prag_asp.logic.step.normal import NormalStep, RuleBody, normal_step
from prag_asp.program.finite.components import components


@dataclass(frozen=True)
class AtomStratum:
    """Atoms that are evaluated together: one atom, or several that derive each other."""

    atoms: tuple[int, ...]
    recursive: bool


def stratified_step(ground: GroundStep) -> NormalStep:
    """Return the normal form of a ground step whose rules can all be evaluated in order.

    Raises:
        EngineError: the step is not a function of the state and the action.
    """
    step = normal_step(ground)
    stratify(list(step.bodies), step.bodies)
    stratify(list(step.final_bodies), step.final_bodies)
    return step


def stratify(roots: Iterable[int], bodies: Mapping[int, tuple[RuleBody, ...]]) -> list[AtomStratum]:
    """Return the atoms on which `roots` depend and that rules define, in order of dependency.

    Raises:
        EngineError: an atom depends on its own negation.
    """

    def dependencies(atom: int) -> list[int]:
        return [abs(literal) for body in bodies[atom] for literal in body.literals if abs(literal) in bodies]

    strata = []
    for members in components((root for root in roots if root in bodies), dependencies):
        inside = set(members)
        literals = [literal for atom in members for body in bodies[atom] for literal in body.literals]
        if any(-literal in inside for literal in literals):
            raise EngineError("rules of a step depend on their own negation")
        strata.append(AtomStratum(tuple(sorted(members)), any(literal in inside for literal in literals)))
    return strata


def body_bits(body: RuleBody, read: Callable[[int], int], size: int, every: int) -> int:
    """Return the truth values of a body in `size` states, as bits; in `every`, all bits are set."""
    if body.weights:
        total = np.zeros(size, dtype=np.int64)
        for literal, weight in zip(body.literals, body.weights, strict=True):
            total += weight * column_of(read(literal) if literal > 0 else every ^ read(-literal), size)
        return bits_of(total >= body.bound)
    result = every
    for literal in body.literals:
        result &= read(literal) if literal > 0 else every ^ read(-literal)
        if not result:
            break
    return result


def evaluate(
    strata: Iterable[AtomStratum],
    bodies: Mapping[int, tuple[RuleBody, ...]],
    values: dict[int, int],
    size: int,
    read: Callable[[int], int] | None = None,
) -> Callable[[int], int]:
    """Add the truth values of every atom in `strata` in `size` states to `values`, as bits; return a reader of values.

    `read` reads `values` and all other atoms; by default, an atom that nothing derives is false.
    """
    every = all_true(size)
    reader = read or (lambda atom: values.get(atom, 0))
    for stratum in strata:
        if not stratum.recursive:
            for atom in stratum.atoms:
                values[atom] = _any_body(bodies[atom], reader, size, every)
            continue
        values.update(dict.fromkeys(stratum.atoms, 0))
        changed = True
        while changed:
            changed = False
            for atom in stratum.atoms:
                value = values[atom] | _any_body(bodies[atom], reader, size, every)
                changed |= value != values[atom]
                values[atom] = value
    return reader


def _any_body(bodies: tuple[RuleBody, ...], read: Callable[[int], int], size: int, every: int) -> int:
    value = 0
    for body in bodies:
        value |= body_bits(body, read, size, every)
        if value == every:
            break
    return value
