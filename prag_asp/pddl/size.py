"""How many fluents and actions a problem has by its types, told before any of them is made."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from math import prod
from pathlib import Path

from prag_asp.errors import DomainError
from prag_asp.pddl.definitions import DomainFile, ProblemFile, Schema
from prag_asp.pddl.formulas import Equality, Literal, Variable, conjuncts, demanded, literals, variables

MOST_FLUENTS, MOST_ACTIONS = 10**6, 10**7
"""Fluents, and actions of one name, that a domain may have; a fluent takes 3 kB and 0.1 ms, an action more."""

LARGE = 10**4
"""Actions of one name beyond which only those are made whose conditions may ever hold."""

Kinds = Iterable[tuple[str, ...]]


def check_size(
    path: Path, domain: DomainFile, problem: ProblemFile, fluents: Mapping[str, Kinds], static: Collection[str]
) -> None:
    """Check that fluents and actions are not too many; `fluents` are the types of arguments of what actions change.

    Of actions, that is told which the start and the types of parameters alone tell: see `fewest_instances`.

    Raises:
        DomainError: they are; the message tells the line in the domain.
    """
    instances = _instances(domain, problem)
    told = f"of {len(problem.objects):,} objects, and no more than"
    made = {name: instances(kinds) for name, kinds in fluents.items()}
    if sum(made.values()) > MOST_FLUENTS:
        name = max(made, key=made.__getitem__)
        made_by = f"{name} makes {made[name]:,} of {sum(made.values()):,} fluents {told} {MOST_FLUENTS:,} can be made"
        hint = "give its arguments types with fewer objects"
        raise DomainError(f"{path}:{domain.predicates[name].line}: {made_by}; {hint}")
    for action in domain.actions:
        if instances(each.types for each in action.parameters) > MOST_ACTIONS:
            found = fewest_instances(action, domain, problem, static, {*fluents, *static})
            if found > MOST_ACTIONS:
                made_by = f"{action.name} makes at least {found:,} actions {told} {MOST_ACTIONS:,} can be made"
                raise DomainError(f"{path}:{action.line}: {made_by}; give its parameters types with fewer objects")


def fewest_instances(
    action: Schema, domain: DomainFile, problem: ProblemFile, static: Collection[str], required: Collection[str]
) -> int:
    """Return a number of instances that an action has at least if it has any; 0 where that takes more to know.

    Each of the `required` predicates that must be true has at least the rows of the initial state. Parameters that none
    names have all objects of their types, but for one that each of those before them is. Where predicates or parameters
    are joined in other ways, nothing is known. What depends on the state otherwise rules no instance out.
    """
    rows = [each for each in demanded(action.precondition) if each.predicate in required]
    bound = [term for each in rows for term in variables(each)]
    free = [each for each in action.parameters if each not in bound]
    ranks: dict[Variable | str, int] = {term: rank for rank, term in enumerate([*bound, *free], 1)}
    unlike: Counter[Variable | str] = Counter()
    for part in conjuncts(action.precondition):
        if isinstance(part, Equality) and not part.positive and part.left != part.right:
            unlike[max(part.left, part.right, key=lambda term: ranks.get(term, 0))] += 1
        elif not (isinstance(part, Literal) and part.positive) and all(
            each.predicate in static for each in literals(part)
        ):
            return 0
    if len(set(bound)) < len(bound) or not unlike.keys().isdisjoint(bound):
        return 0
    instances = _instances(domain, problem)
    added = {effect.literal.predicate for each in domain.actions for effect in each.effects if effect.literal.positive}
    found = [max(each.predicate in added, _true_at_start(each, domain, problem)) for each in rows]
    return prod(found) * prod(max(0, instances([each.types]) - unlike[each]) for each in free)


def _true_at_start(literal: Literal, domain: DomainFile, problem: ProblemFile) -> int:
    """Return for how many values of its variables a literal is true at the start."""
    found: set[tuple[str, ...]] = set()
    for each in problem.initial:
        if each.predicate == literal.predicate:
            names = tuple(map(str, each.terms))
            values = dict(zip(literal.terms, names, strict=True))
            if tuple(map(values.__getitem__, literal.terms)) == names and all(
                term == name
                if isinstance(term, str)
                else not domain.above(problem.objects[name]).isdisjoint(term.types)
                for term, name in values.items()
            ):
                found.add(names)
    return len(found)


def large_actions(domain: DomainFile, problem: ProblemFile) -> frozenset[str]:
    """Return the names of the actions that have many instances by the types of their parameters."""
    instances = _instances(domain, problem)
    return frozenset(each.name for each in domain.actions if instances(each.types for each in each.parameters) > LARGE)


def _instances(domain: DomainFile, problem: ProblemFile) -> Callable[[Kinds], int]:
    """Return a function that tells how many rows of objects there are that are of some types, one for each place."""
    objects = Counter(problem.objects.values())
    above = {kind: domain.above(kind) for kind in objects}
    return lambda kinds: prod(
        sum(number for name, number in objects.items() if not above[name].isdisjoint(each)) for each in kinds
    )
