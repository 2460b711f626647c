"""The cone of influence: the part of a state that decides which plans are valid.

A state needs only the atoms that constraints read, directly or through rules, now or later. An invariant that no
action can break from a state that satisfies it constrains nothing, so it adds nothing to the cone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import clingo

from prag_asp.logic.ground.ground_step import timeless
from prag_asp.logic.step.normal import NormalStep, RuleBody


@dataclass(frozen=True)
class Cone:
    """The state of a domain: its variables, timed atoms without their time, and the constraints that matter."""

    variables: tuple[clingo.Symbol, ...]
    constraints: tuple[RuleBody, ...]


def find_cone(step: NormalStep, labels: Iterable[int] = ()) -> Cone:
    """Return the cone of influence of the constraints of a step, its final check and the atoms `labels`."""
    influence = _Influence(step)
    actions = set(step.occurs.values())
    direct: list[RuleBody] = []
    candidates: list[RuleBody] = []
    for body in step.constraints:
        (direct if any(abs(literal) in actions for literal in body.literals) else candidates).append(body)
    leaves = _leaves(step)
    roots = [*_atoms(direct), *labels, *leaves]
    reached = influence.of(roots)
    invariants = [body for body in candidates if not _atoms([body]) <= reached]
    constraints = [body for body in candidates if _atoms([body]) <= reached]
    broken = find_breakable(step, invariants) if invariants else []
    reached = influence.of([*roots, *_atoms(constraints), *_atoms(broken)])
    variables = {influence.before[atom] for atom in reached if atom in influence.before}
    variables |= {timeless(step.ground.names[atom]) for atom in leaves}
    return Cone(tuple(sorted(variables)), (*direct, *constraints, *broken))


def _leaves(step: NormalStep) -> set[int]:
    """Return the atoms of step t that the final check reads."""
    atoms = _atoms((*step.final, *(body for bodies in step.final_bodies.values() for body in bodies)))
    return {atom for atom in atoms if atom not in step.final_bodies and atom in step.ground.names}


def _atoms(bodies: Iterable[RuleBody]) -> set[int]:
    return {abs(literal) for body in bodies for literal in body.literals}


@dataclass(frozen=True)
class _Influence:
    """The dependencies of the atoms of a step, in this step and in all earlier ones."""

    step: NormalStep

    @cached_property
    def before(self) -> Mapping[int, clingo.Symbol]:
        """The atoms of step t-1 with their symbols, which have no time."""
        return {atom: symbol for symbol, atom in self.step.ground.before.items()}

    def of(self, roots: Iterable[int]) -> set[int]:
        """Return `roots` and the atoms that they depend on."""
        seen: set[int] = set()
        waiting = list(roots)
        while waiting:
            atom = waiting.pop()
            if atom in seen:
                continue
            seen.add(atom)
            waiting += _atoms(self.step.bodies.get(atom, ()))
            if atom in self.before and self.before[atom] in self.step.ground.now:
                waiting.append(self.step.ground.now[self.before[atom]])
        return seen


def find_breakable(step: NormalStep, invariants: list[RuleBody]) -> list[RuleBody]:
    """Return the constraints of `invariants` that some action breaks from a state that satisfies all constraints.

    The states are those that satisfy the rules and constraints on the state alone, which hold after every step. The
    assumed constraints hold at the start; the rest is an induction over the steps.
    """
    query = _BreakQuery(step, invariants)
    broken: set[int] = set()
    while True:
        new = query.broken() - broken
        if not new:
            return [invariants[number] for number in sorted(broken)]
        broken |= new
        query.drop(new)


class _BreakQuery:
    """A program whose answer sets are steps from any such state that break a constraint of interest."""

    def __init__(self, step: NormalStep, invariants: list[RuleBody]) -> None:
        self._control = clingo.Control(["--warn=none"])
        self._atom_of: dict[int, int] = {}
        with self._control.backend() as backend:
            self._add_steps(backend, step, _Influence(step).of(_atoms(invariants)))
            self._some = backend.add_atom()
            self._broken = [backend.add_atom() for _ in invariants]
            self._open = [backend.add_atom() for _ in invariants]
            for body, broken, open_ in zip(invariants, self._broken, self._open, strict=True):
                backend.add_external(open_, clingo.TruthValue.True_)
                self._add(backend, [broken], body)
                backend.add_rule([self._some], [broken, open_])

    def broken(self) -> set[int]:
        """Return the numbers of some constraints of interest that one step breaks; empty if none can be broken."""
        with self._control.solve(assumptions=[self._some], yield_=True) as handle:
            model = handle.model()
            if model is None:
                return set()
            return {number for number, atom in enumerate(self._broken) if model.is_true(atom)}

    def drop(self, numbers: Iterable[int]) -> None:
        """Remove constraints from those of interest."""
        for number in numbers:
            self._control.assign_external(self._open[number], False)

    def _add_steps(self, backend: clingo.Backend, step: NormalStep, reached: set[int]) -> None:
        """Add the choice of a state and an action, the rules of a step, and the constraints of every state."""
        free = sorted(set(step.ground.before.values()) & reached)
        actions = sorted(set(step.occurs.values()) & reached)
        for atom in sorted(reached):
            self._atom_of[atom] = backend.add_atom()
        backend.add_rule([self._atom_of[atom] for atom in (*free, *actions)], choice=True)
        backend.add_weight_rule([], 2, [(self._atom_of[action], 1) for action in actions])
        for atom in sorted(reached):
            for body in step.bodies.get(atom, ()):
                self._add(backend, [self._atom_of[atom]], body)
        for body in _state_constraints(step, reached):
            self._add(backend, [], body)

    def _add(self, backend: clingo.Backend, heads: list[int], body: RuleBody) -> None:
        literals = [self._atom_of[abs(literal)] * (1 if literal > 0 else -1) for literal in body.literals]
        if body.weights:
            backend.add_weight_rule(heads, body.bound, list(zip(literals, body.weights, strict=True)))
        else:
            backend.add_rule(heads, literals)


def _state_constraints(step: NormalStep, reached: set[int]) -> list[RuleBody]:
    """Return the constraints of every state before a step: those of step t, moved to step t-1."""
    moved: dict[int, int] = {
        atom: step.ground.before[symbol]
        for symbol, atom in step.ground.now.items()
        if symbol in step.ground.before and step.ground.before[symbol] in reached
    }
    start = {step.ground.before[symbol] for symbol in step.ground.initial if symbol in step.ground.before}
    clauses = [body.literals for body in step.constraints if not body.weights]
    for atom in moved:
        clauses += [(*body.literals, -atom) for body in step.bodies.get(atom, ()) if not body.weights]
    constraints = []
    for literals in clauses:
        if all(abs(literal) in moved for literal in literals):
            body = RuleBody(tuple(_moved(literal, moved) for literal in literals))
            if not all((abs(literal) in start) == (literal > 0) for literal in body.literals):
                constraints.append(body)
    return constraints


def _moved(literal: int, moved: Mapping[int, int]) -> int:
    return moved[literal] if literal > 0 else -moved[-literal]
