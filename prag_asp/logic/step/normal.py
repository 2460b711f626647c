"""A ground step in normal form: the definition of each atom, and constraints.

The action is an input, not a choice. A rule that allows an action therefore becomes a constraint: an action that occurs
must be allowed, and an action that is derived must occur.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import count

import clingo

from prag_asp.errors import EngineError
from prag_asp.logic.ground.ground_step import GroundStep
from prag_asp.logic.ground.rules import Rule
from prag_asp.program.predicates import OCCURS


@dataclass(frozen=True)
class RuleBody:
    """A conjunction of literals or, with `weights`, the condition that the weights of true literals reach `bound`."""

    literals: tuple[int, ...]
    bound: int = 0
    weights: tuple[int, ...] = ()


@dataclass(frozen=True)
class NormalStep:
    """A step whose only choice is the action.

    `occurs` maps each action to its atom; `bodies` holds the bodies that derive each atom, `constraints` the bodies
    that must be false in a step. `final_bodies` and `final` are the corresponding bodies for the check after the last
    step.
    """

    ground: GroundStep
    occurs: Mapping[clingo.Symbol, int]
    bodies: Mapping[int, tuple[RuleBody, ...]]
    constraints: tuple[RuleBody, ...]
    final_bodies: Mapping[int, tuple[RuleBody, ...]]
    final: tuple[RuleBody, ...]


def normal_step(ground: GroundStep) -> NormalStep:
    """Return the normal form of a ground step.

    Raises:
        EngineError: the step is not a function of the state and the action.
    """
    if ground.obstacles:
        raise ground.obstacles[0].error()
    rules = (rule for part in ("step", "check") for rule in ground.rules.get(part, ()))
    choosable = {atom for rule in rules if rule.choice for atom in rule.heads}
    timed = ((symbol, atom) for symbol, atom in ground.now.items() if symbol.match(*OCCURS.without_time))
    occurs = {symbol.arguments[0]: atom for symbol, atom in sorted(timed)}
    others = choosable - set(occurs.values())
    if others:
        named = [ground.names[atom] for atom in others if atom in ground.names]
        spelled = [str(clingo.Function(each.name, [*each.arguments[:-1], clingo.Function("t")])) for each in named]
        raise EngineError(f"a step chooses more than its action: {min(spelled, default='an unnamed atom')}")
    allowed, bodies, constraints = _step_rules(ground, set(occurs.values()))
    final_bodies: dict[int, list[RuleBody]] = {}
    final: list[RuleBody] = []
    for rule in ground.rules.get("check", ()):
        for head in _single_head(rule):
            final_bodies.setdefault(head, []).append(_body(rule))
        if not rule.heads:
            final.append(_body(rule))
    _add_unnamed(ground, final_bodies, final)
    return NormalStep(
        ground, {action: atom for action, atom in occurs.items() if atom in allowed}, _frozen(bodies),
        tuple(constraints), _frozen(final_bodies), tuple(final),
    )  # fmt: skip


def _step_rules(ground: GroundStep, actions: set[int]) -> tuple[set[int], dict[int, list[RuleBody]], list[RuleBody]]:
    bodies: dict[int, list[RuleBody]] = {}
    constraints: list[RuleBody] = []
    support: dict[int, list[RuleBody]] = {}
    recorded = (rule for part in ground.rules.values() for rule in part)
    fresh = count(1 + max([0, *ground.names, *(abs(atom) for rule in recorded for atom in (*rule.heads, *rule.body))]))
    for rule in ground.rules.get("step", ()):
        body = _body(rule)
        if not rule.heads:
            constraints.append(body)
        for head in _single_head(rule):
            if head not in actions:
                bodies.setdefault(head, []).append(body)
                continue
            support.setdefault(head, []).append(body)
            if not rule.choice:
                derived = next(fresh)
                bodies[derived] = [body]
                constraints.append(RuleBody((derived, -head)))
    for action, allowed in support.items():
        if not any(not body.literals and body.bound <= 0 for body in allowed):
            _refuse_circular(allowed, bodies, actions)
            atom = next(fresh)
            bodies[atom] = allowed
            constraints.append(RuleBody((action, -atom)))
    return set(support), bodies, constraints


def _add_unnamed(ground: GroundStep, final_bodies: dict[int, list[RuleBody]], final: Iterable[RuleBody]) -> None:
    """Add the definitions of the unnamed atoms that the final check reads to `final_bodies`.

    An atom with an unnamed argument, such as ``p(_,t)``, has one definition in the part that reads it first, and each
    later part extends the definition.
    """
    defined: dict[int, list[RuleBody]] = {}
    for part in ground.rules.values():
        for rule in part:
            for head in rule.heads:
                if head not in ground.names:
                    defined.setdefault(head, []).append(_body(rule))
    waiting = [body for derivations in final_bodies.values() for body in derivations] + list(final)
    while waiting:
        for literal in waiting.pop().literals:
            atom = abs(literal)
            if atom not in final_bodies and atom in defined:
                final_bodies[atom] = defined[atom]
                waiting += defined[atom]


def _single_head(rule: Rule) -> tuple[int, ...]:
    if len(rule.heads) > 1 and not rule.choice:
        raise EngineError("a rule of a step has a disjunction as its head")
    return rule.heads


def _body(rule: Rule) -> RuleBody:
    return RuleBody(rule.body, rule.bound, rule.weights)


def _frozen(bodies: Mapping[int, list[RuleBody]]) -> dict[int, tuple[RuleBody, ...]]:
    return {atom: tuple(derivations) for atom, derivations in bodies.items()}


def _refuse_circular(allowed: Iterable[RuleBody], bodies: Mapping[int, list[RuleBody]], actions: set[int]) -> None:
    """Check that no action depends on actions in the same step, because it could then support itself.

    Raises:
        EngineError: an action depends on the actions of its own step.
    """
    seen: set[int] = set()
    waiting = [abs(literal) for body in allowed for literal in body.literals]
    while waiting:
        atom = waiting.pop()
        if atom in actions:
            raise EngineError("which actions may occur depends on what occurs in the same step")
        if atom not in seen:
            seen.add(atom)
            waiting += [abs(literal) for body in bodies.get(atom, ()) for literal in body.literals]
