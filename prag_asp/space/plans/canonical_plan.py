"""Canonical names in plans: interchangeable entities are introduced in order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import clingo

from prag_asp.errors import QueryError
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.program.entity_names import mentioned_entities


def canonical_names(plan: Iterable[clingo.Symbol], symmetries: Symmetries) -> dict[clingo.Symbol, clingo.Symbol]:
    """Return canonical names for the interchangeable entities of a plan: the first entity used gets the first name."""
    return symmetries.names(entity for action in plan for entity in mentioned_entities(action, symmetries.entities))


def canonical_prefix(
    prefix: Sequence[str], actions: Mapping[str, clingo.Symbol], symmetries: Symmetries
) -> tuple[str, ...]:
    """Return the canonical form of `prefix`, whose items are keys of `actions` or names of actions.

    Raises:
        QueryError: an action after a name without arguments is the first to use an interchangeable entity.
    """
    renaming = canonical_names((actions[item] for item in prefix if item in actions), symmetries)
    introduced: set[clingo.Symbol] = set()
    for place, item in enumerate(prefix):
        used = set(mentioned_entities(actions[item], symmetries.entities)) if item in actions else set()
        new = {entity for entity in used if not symmetries.is_settled(entity, introduced)}
        if new and any(earlier not in actions for earlier in prefix[:place]):
            raise QueryError(
                f"{item} names the interchangeable {min(map(str, new))}, but follows an action name without arguments: "
                "give the actions before it in full, or count plans"
            )
        introduced |= used
    return tuple(str(renamed(actions[item], renaming)) if item in actions else item for item in prefix)
