"""The actions that a composite stands for."""

from __future__ import annotations

from collections.abc import Mapping

import clingo

from prag_asp.program.facts import Facts

Actions = tuple[clingo.Symbol, ...]


def composite_actions(facts: Facts) -> Mapping[clingo.Symbol, Actions]:
    """Return the atomic actions of each composite, in their order; the composites have to form no cycle."""
    found: dict[clingo.Symbol, Actions] = {}
    waiting = list(reversed(facts.composites))
    while waiting:
        composite = waiting[-1]
        parts = [part for _, part in facts.stages[composite]]
        unknown = [part for part in parts if part in facts.stages and part not in found]
        if unknown:
            waiting += unknown
        else:
            waiting.pop()
            found[composite] = tuple(action for part in parts for action in found.get(part, (part,)))
    return found
