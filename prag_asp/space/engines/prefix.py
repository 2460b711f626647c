"""Prefixes and plans as users write them."""

from __future__ import annotations

from collections.abc import Sequence

import clingo

from prag_asp.atom import Atom, parse_atom
from prag_asp.errors import QueryError
from prag_asp.program.entity_names import action_name, no_action
from prag_asp.program.facts import Facts
from prag_asp.space.engines.engine import ALL, Level


def parse_prefix(items: Sequence[str], by: Level, facts: Facts) -> tuple[str, ...]:
    """Return the prefix as the engines take it: actions without spaces, or names of actions.

    What has no arguments is a name, and means all actions of that name, one that is spelled like it among them.

    Raises:
        QueryError: an item is no action and no name of one, or a skeleton is asked to begin with a single action.
    """
    by_name: dict[str, list[str]] = {}
    for action in facts.actions:
        by_name.setdefault(action_name(action), []).append(str(action))
    actions = {str(action) for action in facts.actions}
    found = []
    for item in items:
        text = str(parse_atom(item))
        if text not in by_name and text not in actions:
            raise QueryError(no_action(text, [*by_name, *actions], facts))
        if by == "skeleton" and text not in by_name:
            raise QueryError(f"{text} is a single action; a skeleton begins with names such as {parse_atom(text).name}")
        one_of_several = by != "skeleton" and text in actions and len(by_name.get(text, ())) > 1
        found.append(f"{text}{ALL}" if one_of_several else text)
    return tuple(found)


def parse_plan(items: Sequence[str | Atom], facts: Facts) -> tuple[clingo.Symbol, ...]:
    """Return the actions of a plan; what has no arguments is the action that is spelled so.

    Raises:
        QueryError: an item is no action of the domain, or only the name of several.
    """
    actions = {str(action): action for action in facts.actions}
    names = set(map(action_name, facts.actions))
    found = []
    for item in items:
        text = str(parse_atom(str(item)))
        if text not in actions and text in names:
            example = min(each for each in actions if each.startswith(f"{text}("))
            raise QueryError(f"{text} is the name of actions; give one in full, such as {example}")
        if text not in actions:
            raise QueryError(no_action(text, [*names, *actions], facts))
        found.append(actions[text])
    return tuple(found)
