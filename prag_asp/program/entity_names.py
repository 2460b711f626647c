"""The names of classes, entities and actions in queries; ambiguous names are refused."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import combinations

import clingo

from prag_asp.errors import QueryError
from prag_asp.program.facts import Facts
from prag_asp.program.predicates import MENTIONS, NAME
from prag_asp.wording import unknown


def named(facts: Facts) -> Mapping[str, set[str]]:
    """Return the names of classes, entities and actions; a ground action is also a name."""
    return {
        "class": set(map(str, facts.classes)),
        "entity": set(facts.entity_names),
        "action": {*map(str, facts.declared_actions), *facts.action_names},
    }


def shared_names(facts: Facts) -> list[str]:
    """Return the ambiguous names, which are shared by at least two of a class, an entity and an action."""
    others = {*facts.classes, *facts.entities}
    texts = {str(action) for action in facts.declared_actions if action in others}  # other names are not shared
    kinds = (set(map(str, facts.classes)), set(facts.entity_names), texts | facts.action_names)
    return sorted({name for one, other in combinations(kinds, 2) for name in one & other})


def ambiguity(name: str, facts: Facts) -> str | None:
    """Return the message about an ambiguous name, or None if the name is not ambiguous."""
    kinds = [f"the {kind}" for kind, names in named(facts).items() if name in names]
    if len(kinds) < 2:
        return None
    return f"{name} could be {', '.join(kinds[:-1])} or {kinds[-1]} of that name; rename one in the domain"


def no_action(name: str, names: Iterable[str], facts: Facts) -> str:
    """Return the message about a name that is not among the `names` of actions."""
    if name in named(facts)["action"]:
        return f"{name} can never occur, so it is pruned; prag-asp check says why"
    return unknown(name, names, "action")


def refuse_ambiguous(name: str, facts: Facts) -> None:
    """Check that a name is not ambiguous.

    Raises:
        QueryError: the name is shared by two or three of a class, an entity and an action.
    """
    message = ambiguity(name, facts)
    if message:
        raise QueryError(message)


def mentioned_entities(action: clingo.Symbol, entities: Iterable[clingo.Symbol]) -> Iterator[clingo.Symbol]:
    """Yield the entities in a term from left to right, with repetitions."""
    if action in entities:
        yield action
    elif action.type == clingo.SymbolType.Function:
        for argument in action.arguments:
            yield from mentioned_entities(argument, entities)


def action_name(action: clingo.Symbol) -> str:
    """Return the name of an action: its functor, or the whole term if it has none."""
    return action.name if action.type == clingo.SymbolType.Function and action.name else str(action)


def name_fact(action: clingo.Symbol) -> str:
    """Return the ``name`` fact of an action."""
    return NAME.fact(action, action_name(action))


def mention_facts(actions: Iterable[clingo.Symbol], entities: Collection[clingo.Symbol]) -> Iterator[str]:
    """Yield the ``mentions`` facts of actions."""
    for action in actions:
        for position, entity in enumerate(mentioned_entities(action, entities), 1):
            yield MENTIONS.fact(action, position, entity)
