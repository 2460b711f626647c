"""What a word has to begin with."""

from __future__ import annotations

from collections.abc import Sequence

from prag_asp.atom import parse_atom
from prag_asp.errors import QueryError
from prag_asp.logic.ground.program import action_name
from prag_asp.program.facts import Facts
from prag_asp.program.names import no_action
from prag_asp.space.engines.protocol import Level


def parse_prefix(items: Sequence[str], by: Level, facts: Facts) -> tuple[str, ...]:
    """Return the prefix as the engines take it: actions without spaces, or names of actions.

    Raises:
        QueryError: an item is no action and no name of one, or a skeleton is asked to begin with a single action.
    """
    names = {action_name(action) for action in facts.actions}
    actions = {str(action) for action in facts.actions}
    found = []
    for item in items:
        text = str(parse_atom(item))
        if text not in names and text not in actions:
            raise QueryError(no_action(text, [*names, *actions], facts))
        if by == "skeleton" and text not in names:
            raise QueryError(f"{text} is a single action; a skeleton begins with names such as {parse_atom(text).name}")
        found.append(text)
    return tuple(found)
