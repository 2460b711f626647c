"""The cone of influence: what of a state can change which plans are valid.

A state has to tell only what some constraint reads, directly or through rules, now or later. An invariant that no
action can break from a state that satisfies it constrains nothing, so that it draws nothing into the cone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import clingo

from prag_asp.logic.ground.ground_step import timeless
from prag_asp.logic.step.normal import Body, NormalStep


@dataclass(frozen=True)
class Cone:
    """The state of a domain: its variables, timed atoms without their time, and the constraints that matter."""

    variables: tuple[clingo.Symbol, ...]
    constraints: tuple[Body, ...]


def find_cone(step: NormalStep, labels: Iterable[int] = ()) -> Cone:
    """Return the cone of influence of the constraints of a step, its final check and the atoms `labels`."""
    influence = _Influence(step)
    actions = set(step.occurs.values())
    direct: list[Body] = []
    candidates: list[Body] = []
    for body in step.constraints:
        (direct if any(abs(literal) in actions for literal in body.literals) else candidates).append(body)
    leaves = _leaves(step)
    roots = [*_atoms(direct), *labels, *leaves]
    reached = influence.of(roots)
    asked = [body for body in candidates if not _atoms([body]) <= reached]
    kept = [body for body in candidates if _atoms([body]) <= reached]
    broken = breakable(step, asked) if asked else []
    reached = influence.of([*roots, *_atoms(kept), *_atoms(broken)])
    variables = {influence.before[atom] for atom in reached if atom in influence.before}
    variables |= {timeless(step.ground.names[atom]) for atom in leaves}
    return Cone(tuple(sorted(variables)), (*direct, *kept, *broken))


def _leaves(step: NormalStep) -> set[int]:
    """Return the atoms of step t that the final check reads."""
    read = _atoms((*step.final, *(body for found in step.final_bodies.values() for body in found)))
    return {atom for atom in read if atom not in step.final_bodies and atom in step.ground.names}


def _atoms(bodies: Iterable[Body]) -> set[int]:
    return {abs(literal) for body in bodies for literal in body.literals}


@dataclass(frozen=True)
class _Influence:
    """What the atoms of a step depend on, in this step and in all before."""

    step: NormalStep

    @cached_property
    def before(self) -> Mapping[int, clingo.Symbol]:
        """The atoms of step t-1 with their symbols, which have no time."""
        return {atom: symbol for symbol, atom in self.step.ground.before.items()}

    def of(self, roots: Iterable[int]) -> set[int]:
        """Return the atoms that `roots` depend on, and these."""
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


def breakable(step: NormalStep, asked: list[Body]) -> list[Body]:
    """Return those of the constraints `asked` that some action breaks from a state that satisfies all constraints.

    The states considered are those in which the rules and constraints that speak of the state alone hold: they hold
    after every step, and the ones assumed hold at the start. The rest is an induction over the steps.
    """
    question = _Question(step, asked)
    found: set[int] = set()
    while True:
        new = question.broken() - found
        if not new:
            return [asked[number] for number in sorted(found)]
        found |= new
        question.leave_out(new)


class _Question:
    """A program whose answer sets are steps, from any state considered, that break a constraint still asked for."""

    def __init__(self, step: NormalStep, asked: list[Body]) -> None:
        self._control = clingo.Control(["--warn=none"])
        self._atom_of: dict[int, int] = {}
        with self._control.backend() as backend:
            self._add_steps(backend, step, _Influence(step).of(_atoms(asked)))
            self._some = backend.add_atom()
            self._broken = [backend.add_atom() for _ in asked]
            self._open = [backend.add_atom() for _ in asked]
            for body, broken, open_ in zip(asked, self._broken, self._open, strict=True):
                backend.add_external(open_, clingo.TruthValue.True_)
                self._add(backend, [broken], body)
                backend.add_rule([self._some], [broken, open_])

    def broken(self) -> set[int]:
        """Return the numbers of some constraints asked for that one step breaks; none where none can be."""
        with self._control.solve(assumptions=[self._some], yield_=True) as handle:
            model = handle.model()
            if model is None:
                return set()
            return {number for number, atom in enumerate(self._broken) if model.is_true(atom)}

    def leave_out(self, numbers: Iterable[int]) -> None:
        """Ask for these constraints no more."""
        for number in numbers:
            self._control.assign_external(self._open[number], False)

    def _add_steps(self, backend: clingo.Backend, step: NormalStep, reached: set[int]) -> None:
        """Add the choice of a state and an action, the rules of a step, and what every state satisfies."""
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

    def _add(self, backend: clingo.Backend, heads: list[int], body: Body) -> None:
        literals = [self._atom_of[abs(literal)] * (1 if literal > 0 else -1) for literal in body.literals]
        if body.weights:
            backend.add_weight_rule(heads, body.bound, list(zip(literals, body.weights, strict=True)))
        else:
            backend.add_rule(heads, literals)


def _state_constraints(step: NormalStep, reached: set[int]) -> list[Body]:
    """Return what every state before a step satisfies: rules and constraints of step t, moved to step t-1."""
    moved: dict[int, int] = {
        atom: step.ground.before[symbol]
        for symbol, atom in step.ground.now.items()
        if symbol in step.ground.before and step.ground.before[symbol] in reached
    }
    start = {step.ground.before[symbol] for symbol in step.ground.initial if symbol in step.ground.before}
    clauses = [body.literals for body in step.constraints if not body.weights]
    for atom in moved:
        clauses += [(*body.literals, -atom) for body in step.bodies.get(atom, ()) if not body.weights]
    found = []
    for literals in clauses:
        if all(abs(literal) in moved for literal in literals):
            body = Body(tuple(_moved(literal, moved) for literal in literals))
            if not all((abs(literal) in start) == (literal > 0) for literal in body.literals):
                found.append(body)
    return found


def _moved(literal: int, moved: Mapping[int, int]) -> int:
    return moved[literal] if literal > 0 else -moved[-literal]
