"""How many fluents and actions a problem has, told before they are made where no machine holds them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from math import prod
from pathlib import Path

from prag_asp.errors import DomainError
from prag_asp.pddl.formula import literals
from prag_asp.pddl.model import DomainFile, ProblemFile

MOST_FLUENTS, MOST_ACTIONS = 10**6, 10**7
"""Fluents, and actions of one name, that a domain may have; a fluent takes 3 kB and 0.1 ms, an action more."""

Kinds = tuple[tuple[str, ...], ...]


def check_size(
    path: Path, domain: DomainFile, problem: ProblemFile, fluents: Mapping[str, Kinds], static: Iterable[str]
) -> None:
    """Check that fluents and actions are not too many; `fluents` are the types of arguments of what actions change.

    An action is counted by its types where none of the `static` predicates says of which objects there is one.

    Raises:
        DomainError: they are; the message tells the line in the domain.
    """
    objects = Counter(problem.objects.values())
    above = {kind: domain.above(kind) for kind in objects}
    told = f"of {len(problem.objects):,} objects, and no more than"

    def instances(kinds: Kinds) -> int:
        return prod(sum(objects[name] for name in objects if not above[name].isdisjoint(each)) for each in kinds)

    made = {name: instances(kinds) for name, kinds in fluents.items()}
    if sum(made.values()) > MOST_FLUENTS:
        name = max(made, key=made.__getitem__)
        made_by = f"{name} makes {made[name]:,} of {sum(made.values()):,} fluents {told} {MOST_FLUENTS:,} can be made"
        hint = "give its arguments types with fewer objects"
        raise DomainError(f"{path}:{domain.predicates[name].line}: {made_by}; {hint}")
    for action in domain.actions:
        found = instances(tuple(each.types for each in action.parameters))
        if found > MOST_ACTIONS and not {each.predicate for each in literals(action.precondition)}.intersection(static):
            made_by = f"{action.name} makes {found:,} actions {told} {MOST_ACTIONS:,} can be made"
            raise DomainError(f"{path}:{action.line}: {made_by}; give its parameters types with fewer objects")
