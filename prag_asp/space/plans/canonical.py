"""The canonical name of a plan: interchangeable entities introduced in their order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import clingo

from prag_asp.errors import QueryError
from prag_asp.logic.ground.program import mentioned_entities
from prag_asp.logic.symmetry.renaming import renamed


def canonical_names(
    plan: Iterable[clingo.Symbol], groups: Sequence[Sequence[clingo.Symbol]]
) -> dict[clingo.Symbol, clingo.Symbol]:
    """Return new names for the entities of `groups` that a plan uses: in each group, the first used is the first."""
    group_of = {entity: group for group in groups for entity in group}
    names: dict[clingo.Symbol, clingo.Symbol] = {}
    introduced: dict[clingo.Symbol, int] = {}
    for action in plan:
        for entity in mentioned_entities(action, group_of):
            if entity not in names:
                group = group_of[entity]
                names[entity] = group[introduced.setdefault(group[0], 0)]
                introduced[group[0]] += 1
    return names


def canonical_prefix(
    prefix: Sequence[str], actions: Mapping[str, clingo.Symbol], groups: Sequence[Sequence[clingo.Symbol]]
) -> tuple[str, ...]:
    """Return what tasks begin with where some renaming of them begins with `prefix`: `actions` by their texts or names.

    Raises:
        QueryError: after a mere name, an action speaks of an interchangeable entity for the first time.
    """
    renaming = canonical_names((actions[item] for item in prefix if item in actions), groups)
    grouped = {entity for group in groups for entity in group}
    introduced: set[clingo.Symbol] = set()
    for place, item in enumerate(prefix):
        used = set(mentioned_entities(actions[item], grouped)) if item in actions else set()
        if used - introduced and any(earlier not in actions for earlier in prefix[:place]):
            raise QueryError(
                f"{item} names the interchangeable {min(map(str, used - introduced))}, but it comes after a mere name: "
                "give the actions before it in full, or count plans"
            )
        introduced |= used
    return tuple(str(renamed(actions[item], renaming)) if item in actions else item for item in prefix)
