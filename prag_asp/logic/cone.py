"""The cone of influence: what of a state can change which plans are valid.

A state has to tell only what some constraint reads, directly or through rules, now or later. An invariant that no
action can break from a state that satisfies it constrains nothing, so that it draws nothing into the cone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import clingo

from prag_asp.logic.normal import Body, NormalStep


@dataclass(frozen=True)
class Cone:
    """The state of a domain: its variables, timed atoms without their time, and the constraints that matter."""

    variables: tuple[clingo.Symbol, ...]
    constraints: tuple[Body, ...]


def find_cone(step: NormalStep, labels: Iterable[int] = ()) -> Cone:
    """Return the cone of influence of the constraints of a step, its final check and the atoms `labels`."""
    actions = set(step.occurs.values())
    direct: list[Body] = []
    candidates: list[Body] = []
    for body in step.constraints:
        (direct if any(abs(literal) in actions for literal in body.literals) else candidates).append(body)
    leaves = _leaves(step)
    roots = [*_atoms(direct), *labels, *leaves]
    reached = _reach(step, roots)
    asked = [body for body in candidates if not _reach(step, _atoms([body])) <= reached]
    kept = [body for body in candidates if body not in asked]
    broken = breakable(step, asked) if asked else []
    reached = _reach(step, [*roots, *_atoms(kept), *_atoms(broken)])
    before = {atom: symbol for symbol, atom in step.ground.before.items()}
    final = {step.ground.names[atom] for atom in leaves}
    variables = {before[atom] for atom in reached if atom in before}
    variables |= {clingo.Function(symbol.name, symbol.arguments[:-1]) for symbol in final}
    return Cone(tuple(sorted(variables)), (*direct, *kept, *broken))


def _leaves(step: NormalStep) -> set[int]:
    """Return the atoms of step t that the final check reads."""
    read = _atoms((*step.final, *(body for found in step.final_bodies.values() for body in found)))
    return {atom for atom in read if atom not in step.final_bodies and atom in step.ground.names}


def _atoms(bodies: Iterable[Body]) -> set[int]:
    return {abs(literal) for body in bodies for literal in body.literals}


def _reach(step: NormalStep, roots: Iterable[int]) -> set[int]:
    """Return the atoms that `roots` depend on, in this step and in all before."""
    before = {atom: symbol for symbol, atom in step.ground.before.items()}
    seen: set[int] = set()
    waiting = list(roots)
    while waiting:
        atom = waiting.pop()
        if atom in seen:
            continue
        seen.add(atom)
        waiting += _atoms(step.bodies.get(atom, ()))
        if atom in before and before[atom] in step.ground.now:
            waiting.append(step.ground.now[before[atom]])
    return seen


def breakable(step: NormalStep, asked: list[Body]) -> list[Body]:
    """Return those of the constraints `asked` that some action breaks from a state that satisfies all constraints.

    The states considered are those in which the rules and constraints that speak of the state alone hold: they hold
    after every step, and the ones assumed hold at the start. The rest is an induction over the steps.
    """
    reached = _reach(step, _atoms(asked))
    control = clingo.Control(["--warn=none"])
    with control.backend() as backend:
        known: dict[int, int] = {}

        def atom_of(atom: int) -> int:
            if atom not in known:
                known[atom] = backend.add_atom()
            return known[atom]

        def literals(body: Body) -> list[int]:
            return [atom_of(literal) if literal > 0 else -atom_of(-literal) for literal in body.literals]

        def add(heads: list[int], body: Body) -> None:
            if body.weights:
                backend.add_weight_rule(heads, body.bound, list(zip(literals(body), body.weights, strict=True)))
            else:
                backend.add_rule(heads, literals(body))

        free = sorted(set(step.ground.before.values()) & reached)
        actions = sorted(set(step.occurs.values()) & reached)
        backend.add_rule([atom_of(atom) for atom in (*free, *actions)], choice=True)
        backend.add_weight_rule([], 2, [(atom_of(action), 1) for action in actions])
        for atom in sorted(reached):
            for body in step.bodies.get(atom, ()):
                add([atom_of(atom)], body)
        for body in _state_constraints(step, reached):
            add([], body)
        some = backend.add_atom()
        broken, open_ = [], []
        for body in asked:
            broken.append(backend.add_atom())
            open_.append(backend.add_atom())
            backend.add_external(open_[-1], clingo.TruthValue.True_)
            add([broken[-1]], body)
            backend.add_rule([some], [broken[-1], open_[-1]])
    found: set[int] = set()
    while True:
        with control.solve(assumptions=[some], yield_=True) as handle:
            model = handle.model()
            new = [] if model is None else [i for i in range(len(asked)) if i not in found and model.is_true(broken[i])]
        if not new:
            return [asked[i] for i in sorted(found)]
        found.update(new)
        for i in new:
            control.assign_external(open_[i], False)


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
