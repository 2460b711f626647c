"""Disjoint parts of a task space, for training and testing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import accumulate, pairwise

import clingo

from prag_asp.errors import QueryError
from prag_asp.exact_numbers import Number, parse_number
from prag_asp.program.entity_names import action_name, mentioned_entities, refuse_ambiguous
from prag_asp.program.facts import Facts


def parse_shares(shares: Mapping[str, Number | float]) -> dict[str, Fraction]:
    """Return shares as fractions; a float stands for its decimal digits, so 0.8 is 4/5.

    Raises:
        QueryError: the shares are not numbers above 0 that add up to 1.
    """
    fractions = {name: parse_number(f"share of {name!r}", str(share)) for name, share in shares.items()}
    if any(share <= 0 for share in fractions.values()) or sum(fractions.values()) != 1:
        raise QueryError(f"shares {dict(shares)}: they have to be above 0 and to add up to 1")
    return fractions


def divided(total: int, shares: Mapping[str, Fraction]) -> dict[str, range]:
    """Return consecutive ranges of the numbers below `total`, one for each share, each rounded by less than 1."""
    bounds = [0, *(int(total * share + Fraction(1, 2)) for share in accumulate(shares.values()))]
    return {name: range(low, high) for name, (low, high) in zip(shares, pairwise(bounds), strict=True)}


def held_out(what: str, facts: Facts, groups: Sequence[Sequence[clingo.Symbol]]) -> tuple[str, str]:
    """Return the conditions for tasks without `what` and for tasks with it.

    `what` is an entity, a class, an action, a name or a pair of names.

    Raises:
        QueryError: `what` is ambiguous, or is an entity that is interchangeable with one in the tasks without it.
    """
    refuse_ambiguous(what.strip(), facts)
    actions = {str(action): action for action in facts.actions}
    spelled = what.replace(" ", "")
    for group in groups:
        named = set(mentioned_entities(actions[spelled], group)) if spelled in actions else set()
        own = [entity for entity in group if str(entity) == spelled or entity in named]
        if own:
            others = ", ".join(str(entity) for entity in group if entity not in own) or "each other"
            raise QueryError(f"{own[0]} is interchangeable with {others}, so it is nothing new; hold out its class")
    is_action = ">" in what or spelled in actions or spelled in set(map(action_name, facts.actions))
    without, having = ("lacks", "has") if is_action else ("avoids", "uses")
    return f"{without} {what}", f"{having} {what}"
