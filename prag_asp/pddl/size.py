"""How many fluents and actions a problem has by its types, told before any of them is made."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from math import prod
from pathlib import Path

from prag_asp.errors import DomainError
from prag_asp.pddl.formula import Literal, conjuncts, literals
from prag_asp.pddl.model import DomainFile, ProblemFile, Schema

MOST_FLUENTS, MOST_ACTIONS = 10**6, 10**7
"""Fluents, and actions of one name, that a domain may have; a fluent takes 3 kB and 0.1 ms, an action more."""

LARGE = 10**4
"""Actions of one name beyond which only those are made whose conditions may ever hold."""

Kinds = Iterable[tuple[str, ...]]


def check_size(
    path: Path, domain: DomainFile, problem: ProblemFile, fluents: Mapping[str, Kinds], static: Iterable[str]
) -> None:
    """Check that fluents and actions are not too many; `fluents` are the types of arguments of what actions change.

    An action is counted by the types of those parameters of which no predicate has to hold, where none of the `static`
    predicates says of which objects there is one.

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
        bound = {term for each in asked(action) for term in each.terms}
        found = instances(each.types for each in action.parameters if each not in bound)
        if found > MOST_ACTIONS and not {each.predicate for each in literals(action.precondition)}.intersection(static):
            made_by = f"{action.name} makes {found:,} actions {told} {MOST_ACTIONS:,} can be made"
            raise DomainError(f"{path}:{action.line}: {made_by}; give its parameters types with fewer objects")


def large_actions(domain: DomainFile, problem: ProblemFile) -> frozenset[str]:
    """Return the names of the actions that have many instances by the types of their parameters."""
    instances = _instances(domain, problem)
    return frozenset(each.name for each in domain.actions if instances(each.types for each in each.parameters) > LARGE)


def asked(action: Schema) -> Iterator[Literal]:
    """Yield what has to be true for an action to occur, as far as it is plainly said."""
    parts = conjuncts(action.precondition)
    return (each for each in parts if isinstance(each, Literal) and each.positive)


def _instances(domain: DomainFile, problem: ProblemFile) -> Callable[[Kinds], int]:
    """Return a function that tells how many rows of objects there are that are of some types, one for each place."""
    objects = Counter(problem.objects.values())
    above = {kind: domain.above(kind) for kind in objects}
    return lambda kinds: prod(
        sum(number for name, number in objects.items() if not above[name].isdisjoint(each)) for each in kinds
    )
