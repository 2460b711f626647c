"""Everything that can never occur in a domain, found in one pass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from prag_asp.program.facts import Facts, without
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import PRUNED
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Statement
from prag_asp.pruning.reachability import (
    RelaxedReach,
    Unreachable,
    find_relaxed_reach,
    find_unreachable,
    static_values,
)
from prag_asp.pruning.rejected_actions import RejectedActions, find_rejected_actions
from prag_asp.pruning.rejected_composites import RejectedComposites, find_rejected_composites


@dataclass(frozen=True)
class Pruning:
    """What can never occur in a domain, and the `facts` that are left.

    `composites` is None where the domain has none, `reach` where it is not known what is reachable. Where the encodings
    do not read what is pruned, the facts are whole, and `is_applied` is false.
    """

    facts: Facts
    actions: RejectedActions
    composites: RejectedComposites | None
    reach: RelaxedReach | None
    unreachable: Unreachable
    is_applied: bool


def find_pruning(
    step: Program, grounder: Grounder, facts: Facts, statements: Sequence[Statement], encodings: Path | None
) -> Pruning:
    """Return what can never occur of the `facts` that a domain states.

    `step` is the program of a step without user rules. `grounder` holds the ground base part, with the program of
    relaxed steps if the folder of `encodings` has it.
    """
    actions = find_rejected_actions(step, grounder.control, facts, statements)
    composites = find_rejected_composites(step, facts, actions, statements) if facts.composites else None
    applied = any(atom.signature == PRUNED for each in statements if not each.own for atom in each.body)
    if not applied:
        return Pruning(facts, actions, composites, None, Unreachable(), is_applied=False)
    left = without(facts, {*actions.rejections, *(composites.composites if composites else ())})
    reach = find_relaxed_reach(grounder, left, statements, encodings) if encodings else None
    unreachable = find_unreachable(reach, left) if reach else Unreachable()
    static = static_values(reach, left) if reach else ()
    left = replace(left, unreachable=unreachable.actions, static=static)
    return Pruning(left, actions, composites, reach, unreachable, is_applied=True)
