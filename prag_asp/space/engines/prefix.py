"""Parsers of levels, prefixes and plans as users write them."""

from __future__ import annotations

from collections.abc import Sequence

import clingo

from prag_asp.atom import Atom, parse_atom
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.program.entity_names import action_name, no_action
from prag_asp.program.facts import Facts
from prag_asp.space.engines.engine import ALL, LEVELS, Level
from prag_asp.space.plans.canonical_plan import canonical_prefix

Prefix = Sequence[str | Atom]
"""The first steps of a plan, each an action or the name of an action."""


def checked_level(by: Level) -> Level:
    """Return a level, after checking that it exists.

    Raises:
        QueryError: there is no such level.
    """
    if by not in LEVELS:
        raise QueryError(f"no level {by!r}; there are {', '.join(LEVELS)}")
    return by


def engine_prefix(prefix: Prefix, by: Level, length: int, domain: Domain, model: DomainLogic) -> tuple[str, ...]:
    """Return a prefix as the engines for a level and length expect it; for tasks, with canonical names.

    `domain` has no conditions; `model` is the logic of the domain with the conditions.

    Raises:
        QueryError: the prefix is a text, names no action of the domain, or has no canonical names.
    """
    if isinstance(prefix, str):
        raise QueryError(f"prefix {prefix!r}: give a list, such as [{prefix!r}]")
    if not prefix:
        return ()
    items = [str(item) for item in prefix]
    reduction = domain.reduction
    if reduction and {*items} <= {action_name(action) for action in reduction.facts.actions}:
        return parse_prefix(items, by, reduction.facts)
    parsed = parse_prefix(items, by, domain.facts)
    if by != "task" or not parsed:
        return parsed
    return canonical_prefix(parsed, model.domain.facts.actions_by_text, model.symmetries(length))


def parse_prefix(items: Sequence[str], by: Level, facts: Facts) -> tuple[str, ...]:
    """Return the parsed items of a prefix: actions without spaces, or names of actions.

    An item without arguments is a name and stands for all actions of that name, including one that has no arguments.

    Raises:
        QueryError: an item is neither an action nor the name of one, or a skeleton begins with a single action.
    """
    by_name: dict[str, list[str]] = {}
    actions = facts.actions_by_text
    for each, action in actions.items():
        by_name.setdefault(action_name(action), []).append(each)
    parsed = []
    for item in items:
        text = str(parse_atom(item))
        if text not in by_name and text not in actions:
            raise QueryError(no_action(text, [*by_name, *actions], facts))
        if by == "skeleton" and text not in by_name:
            raise QueryError(f"{text} is a single action; a skeleton begins with names such as {parse_atom(text).name}")
        one_of_several = by != "skeleton" and text in actions and len(by_name.get(text, ())) > 1
        parsed.append(f"{text}{ALL}" if one_of_several else text)
    return tuple(parsed)


def parse_plan(items: Sequence[str | Atom], facts: Facts) -> tuple[clingo.Symbol, ...]:
    """Return the actions of a plan; an item without arguments is the action with exactly this text.

    Raises:
        QueryError: an item is not an action of the domain, or is only the name of several actions.
    """
    actions = facts.actions_by_text
    plan = []
    for item in items:
        text = str(parse_atom(str(item)))
        if text not in actions:
            names = set(map(action_name, facts.actions))
            if text in names:
                example = min(action for action in actions if action.startswith(f"{text}("))
                raise QueryError(f"{text} is the name of actions; give one in full, such as {example}")
            raise QueryError(no_action(text, [*names, *actions], facts))
        plan.append(actions[text])
    return tuple(plan)
