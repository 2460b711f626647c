"""What a word has to begin with."""

from __future__ import annotations

from collections.abc import Sequence

import clingo

from prag_asp.atom import Atom, parse_atom
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


def parse_plan(actions: Sequence[str | Atom], facts: Facts) -> list[clingo.Symbol]:
    """Return a sequence of actions, each given in full or by a name that is its own alone.

    Raises:
        QueryError: one is no action of the domain, or the name of several.
    """
    known = {str(action): action for action in facts.actions}
    plan = parse_prefix([str(action) for action in actions], "plan", facts)
    for action in plan:
        if action not in known:
            example = min(each for each in known if each.startswith(f"{action}("))
            raise QueryError(f"{action} is the name of several actions; give one in full, such as {example}")
    return [known[action] for action in plan]
