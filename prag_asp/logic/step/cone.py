"""The cone of influence: the part of a state that decides which plans are valid.

A state needs only the atoms that constraints read, directly or through rules, now or later. If no action can break an
invariant that holds, the invariant does not constrain plans, so it adds nothing to the cone.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from itertools import count

import clingo

from prag_asp.logic.ground.ground_step import timeless
from prag_asp.logic.step.normal import NormalStep, RuleBody


@dataclass(frozen=True)
class Cone:
    """The variables of a state (timed atoms without their time), and the constraints that restrict plans."""

    variables: tuple[clingo.Symbol, ...]
    constraints: tuple[RuleBody, ...]


def find_cone(step: NormalStep, labels: Iterable[int] = ()) -> Cone:
    """Return the cone of influence of the constraints of a step, its final check and the atoms `labels`."""
    actions = set(step.occurs.values())
    direct: list[RuleBody] = []
    candidates: list[RuleBody] = []
    for body in step.constraints:
        (direct if any(abs(literal) in actions for literal in body.literals) else candidates).append(body)
    final = _atoms((*step.final, *(body for bodies in step.final_bodies.values() for body in bodies)))
    leaves = {atom for atom in final if atom not in step.final_bodies and atom in step.ground.names}
    roots = [*_atoms(direct), *labels, *leaves]
    reached = _influence(step, roots)
    constraints = [body for body in candidates if _atoms([body]) <= reached]
    broken = find_breakable(step, [body for body in candidates if not _atoms([body]) <= reached])
    reached = _influence(step, [*roots, *_atoms(constraints), *_atoms(broken)])
    variables = {symbol for symbol, atom in step.ground.before.items() if atom in reached}
    variables |= {timeless(step.ground.names[atom]) for atom in leaves}
    return Cone(tuple(sorted(variables)), (*direct, *constraints, *broken))


def _influence(step: NormalStep, roots: Iterable[int]) -> set[int]:
    """Return `roots` and the atoms on which they depend, in this step and in all earlier ones."""
    now, before = step.ground.now, {atom: symbol for symbol, atom in step.ground.before.items()}
    seen: set[int] = set()
    waiting = list(roots)
    while waiting:
        atom = waiting.pop()
        if atom not in seen:
            seen.add(atom)
            waiting += _atoms(step.bodies.get(atom, ()))
            if before.get(atom) in now:
                waiting.append(now[before[atom]])
    return seen


def _atoms(bodies: Iterable[RuleBody]) -> set[int]:
    return {abs(literal) for body in bodies for literal in body.literals}


SINGLE_SOLVES = 64
"""The number of answer sets after which a broken constraint closes all constraints of its shape; an answer set takes
about 10 ms."""


def find_breakable(step: NormalStep, invariants: list[RuleBody]) -> list[RuleBody]:
    """Return the constraints of `invariants` that some action breaks from a state that satisfies all constraints.

    The steps start from any state that satisfies the rules and constraints that read only the state; these hold after
    every step. The assumed constraints hold initially; the claim follows by induction over the steps. The answer sets
    of a program are the steps from such states that break an open constraint; a constraint is closed once a step breaks
    it.

    If many constraints are broken one by one, each closes all constraints of its shape. Some of these may be
    unbreakable; they enlarge the cone, but exclude nothing.
    """
    if not invariants:
        return []
    control, some, broken, open_ = _breaking_steps(step, invariants)
    shapes = [_shape(step, body) for body in invariants]
    found: set[int] = set()
    waiting = set(range(len(invariants)))
    for solve in count():
        with control.solve(assumptions=[some], yield_=True) as handle:
            model = handle.model()
            if model is None:
                break
            new = {number for number in waiting if model.is_true(broken[number])}
        if solve >= SINGLE_SOLVES:
            new_shapes = {shapes[number] for number in new}
            new = {number for number in waiting if shapes[number] in new_shapes}
        found |= new
        waiting -= new
        for number in new:
            control.assign_external(open_[number], False)
    return [invariants[number] for number in sorted(found)]


def _shape(step: NormalStep, body: RuleBody) -> tuple[tuple[bool, str, str, int], ...]:
    """Return the signs, predicates and fluents of a constraint's literals, without arguments."""
    shape = []
    for literal in body.literals:
        symbol = step.ground.names.get(abs(literal), clingo.Function("unnamed"))
        fluent = next((each for each in symbol.arguments if each.type is clingo.SymbolType.Function), symbol)
        shape.append((literal > 0, symbol.name, fluent.name, len(fluent.arguments)))
    return tuple(sorted(shape))


def _breaking_steps(
    step: NormalStep, invariants: Sequence[RuleBody]
) -> tuple[clingo.Control, int, Sequence[int], Sequence[int]]:
    """Return the program whose answer sets are steps that break constraints, and its atoms.

    One atom states that some open constraint is broken; for each constraint, one atom states that it is broken, and an
    external atom that it is open.
    """
    reached = sorted(_influence(step, _atoms(invariants)))
    control = clingo.Control(["--warn=none", "--heuristic=Domain"])
    with control.backend() as backend:
        atom_of = {atom: backend.add_atom() for atom in reached}

        def add(heads: list[int], body: RuleBody) -> None:
            literals = [atom_of[abs(literal)] * (1 if literal > 0 else -1) for literal in body.literals]
            if body.weights:
                backend.add_weight_rule(heads, body.bound, list(zip(literals, body.weights, strict=True)))
            else:
                backend.add_rule(heads, literals)

        actions = sorted(atom_of[action] for action in step.occurs.values() if action in atom_of)
        state = sorted(atom_of[atom] for atom in step.ground.before.values() if atom in atom_of)
        backend.add_rule([*state, *actions], choice=True)
        backend.add_weight_rule([], 2, [(action, 1) for action in actions])
        for atom in reached:
            for body in step.bodies.get(atom, ()):
                add([atom_of[atom]], body)
        for body in _state_constraints(step, atom_of):
            add([], body)
        some = backend.add_atom()
        broken, open_ = ([backend.add_atom() for _ in invariants] for _ in range(2))
        for body, breaks, is_open in zip(invariants, broken, open_, strict=True):
            backend.add_external(is_open, clingo.TruthValue.True_)
            add([breaks], body)
            backend.add_rule([some], [breaks, is_open])
            # A model that breaks many constraints saves as many models. Only the sign of these atoms is preferred:
            # deciding them first would try every pair of constraints that cannot be broken together.
            backend.add_heuristic(breaks, clingo.backend.HeuristicType.Sign, 1, 1, [is_open])
    return control, some, broken, open_


def _state_constraints(step: NormalStep, reached: Collection[int]) -> list[RuleBody]:
    """Return the constraints on the state before a step: those of step t, moved to step t-1."""
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
            body = RuleBody(tuple(moved[abs(literal)] * (1 if literal > 0 else -1) for literal in literals))
            if not all((abs(literal) in start) == (literal > 0) for literal in body.literals):
                constraints.append(body)
    return constraints
