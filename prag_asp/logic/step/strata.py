"""Stratification of ground rules, and their evaluation on columns."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import EngineError
from prag_asp.logic.ground.ground_step import GroundStep
from prag_asp.logic.step.normal import NormalStep, RuleBody, normal_step
from prag_asp.program.finite.components import components

Column = NDArray[np.bool_]
"""The truth of one atom in many states: shape (number of states,)."""


@dataclass(frozen=True)
class Stratum:
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


def stratify(roots: Iterable[int], bodies: Mapping[int, tuple[RuleBody, ...]]) -> list[Stratum]:
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
        strata.append(Stratum(tuple(sorted(members)), any(literal in inside for literal in literals)))
    return strata


def body_column(body: RuleBody, column: Callable[[int], Column], size: int) -> Column:
    """Return the truth of a body as a column."""
    if body.weights:
        total = np.zeros(size, dtype=np.int64)
        for literal, weight in zip(body.literals, body.weights, strict=True):
            total += weight * (column(literal) if literal > 0 else ~column(-literal))
        reached: Column = total >= body.bound
        return reached
    result: Column | None = None
    for literal in body.literals:
        value = column(literal) if literal > 0 else ~column(-literal)
        result = value if result is None else result & value
    return np.ones(size, dtype=np.bool_) if result is None else result


def evaluate(
    strata: Iterable[Stratum],
    bodies: Mapping[int, tuple[RuleBody, ...]],
    columns: dict[int, Column],
    size: int,
    read: Callable[[int], Column] | None = None,
) -> Callable[[int], Column]:
    """Add the column of every atom in `strata` to `columns`, and return a reader of columns.

    `read` reads `columns` and all other atoms; by default, an atom that nothing derives is false.
    """
    false = np.zeros(size, dtype=np.bool_)
    column = read or (lambda atom: columns.get(atom, false))
    for stratum in strata:
        if not stratum.recursive:
            for atom in stratum.atoms:
                columns[atom] = _any_body(bodies[atom], column, size)
            continue
        columns.update(dict.fromkeys(stratum.atoms, false))
        changed = True
        while changed:
            changed = False
            for atom in stratum.atoms:
                value = columns[atom] | _any_body(bodies[atom], column, size)
                changed |= not np.array_equal(value, columns[atom])
                columns[atom] = value
    return column


def _any_body(bodies: tuple[RuleBody, ...], column: Callable[[int], Column], size: int) -> Column:
    value: Column | None = None
    for body in bodies:
        result = body_column(body, column, size)
        value = result if value is None else value | result
    return np.zeros(size, dtype=np.bool_) if value is None else value
