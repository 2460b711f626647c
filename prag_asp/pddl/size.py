"""The numbers of fluents and actions of a problem, computed from its types before grounding."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from math import prod
from pathlib import Path

from prag_asp.errors import DomainError
from prag_asp.pddl.definitions import DomainFile, ProblemFile, Schema
from prag_asp.pddl.formulas import Equality, Literal, Variable, conjuncts, demanded, literals, variables

MOST_FLUENTS, MOST_ACTIONS = 10**6, 10**7
"""The maximum numbers of fluents, and of actions with the same name. A fluent takes 3 kB and 0.1 ms, and an action
takes more."""

LARGE = 10**4
"""The number of actions with the same name above which only those with relaxed-reachable preconditions are grounded."""

Kinds = Iterable[tuple[str, ...]]


def check_size(
    path: Path, domain: DomainFile, problem: ProblemFile, fluents: Mapping[str, Kinds], static: Collection[str]
) -> None:
    """Check the number of fluents and actions; `fluents` are the argument types of predicates that actions change.

    Actions are counted by `fewest_instances`, which reads only the initial state and the types of parameters.

    Raises:
        DomainError: there are more than the limits allow; the message gives the line in the domain.
    """
    instances = _instances(domain, problem)
    limit = f"with {len(problem.objects):,} objects, more than the limit of"
    fluent_counts = {name: instances(kinds) for name, kinds in fluents.items()}
    total = sum(fluent_counts.values())
    if total > MOST_FLUENTS:
        name = max(fluent_counts, key=fluent_counts.__getitem__)
        text = f"{name} has {fluent_counts[name]:,} of {total:,} fluents {limit} {MOST_FLUENTS:,}"
        hint = "give its arguments types with fewer objects"
        raise DomainError(f"{path}:{domain.predicates[name].line}: {text}; {hint}")
    for action in domain.actions:
        if instances(each.types for each in action.parameters) > MOST_ACTIONS:
            fewest = fewest_instances(action, domain, problem, static, {*fluents, *static})
            if fewest > MOST_ACTIONS:
                text = f"{action.name} has at least {fewest:,} instances {limit} {MOST_ACTIONS:,}"
                raise DomainError(f"{path}:{action.line}: {text}; give its parameters types with fewer objects")


def fewest_instances(
    action: Schema, domain: DomainFile, problem: ProblemFile, static: Collection[str], required: Collection[str]
) -> int:
    """Return a lower bound on the number of instances of an action that has any, or 0 if the types allow none.

    A positive precondition on a `required` predicate has at least the instances that hold initially. A parameter that
    is not bound by such a precondition ranges over all objects of its types, except those from which it must differ.
    Preconditions joined by a shared parameter give no bound. Other conditions on the state exclude no instance.
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
    row_counts = [max(each.predicate in added, _true_at_start(each, domain, problem)) for each in rows]
    return prod(row_counts) * prod(max(0, instances([each.types]) - unlike[each]) for each in free)


def _true_at_start(literal: Literal, domain: DomainFile, problem: ProblemFile) -> int:
    """Return the number of instances of a literal that are true in the initial state."""
    matches: set[tuple[str, ...]] = set()
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
                matches.add(names)
    return len(matches)


def large_actions(domain: DomainFile, problem: ProblemFile) -> frozenset[str]:
    """Return the names of the actions for which the parameter types allow more than `LARGE` instances."""
    instances = _instances(domain, problem)
    return frozenset(each.name for each in domain.actions if instances(each.types for each in each.parameters) > LARGE)


def _instances(domain: DomainFile, problem: ProblemFile) -> Callable[[Kinds], int]:
    """Return a function that counts tuples of objects, given a set of alternative types for each position."""
    objects = Counter(problem.objects.values())
    above = {kind: domain.above(kind) for kind in objects}
    return lambda kinds: prod(
        sum(number for name, number in objects.items() if not above[name].isdisjoint(each)) for each in kinds
    )
