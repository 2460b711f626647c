"""The actions and composites that can never occur: counts omit them, and the linter reports them.

    rejected actions -> rejected composites -> (relaxed rules) -> relaxed reachability, static fluents

An action is *pruned* if every state rejects it; its preconditions and effects are dropped. It is *unreachable* if its
preconditions are relaxed-unreachable; no step tries it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from prag_asp.program.facts import Assignment, Facts, without
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import PRUNED
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Statement
from prag_asp.pruning.reachability import RelaxedReach, Unreachable, find_relaxed_reach
from prag_asp.pruning.rejected_actions import RejectedActions, find_rejected_actions
from prag_asp.pruning.rejected_composites import RejectedComposites, find_rejected_composites

__all__ = ["Pruning", "find_pruning"]

OPPOSITE = {"true": "false", "false": "true"}


@dataclass(frozen=True)
class Pruning:
    """The actions and composites that can never occur in a domain, and the remaining `facts`.

    `composites` is None if the domain has none, and `reach` is None if reachability is unknown. If the encodings do not
    read ``_pruned``, all facts remain, and `is_applied` is false.
    """

    facts: Facts
    actions: RejectedActions
    composites: RejectedComposites | None
    reach: RelaxedReach | None
    unreachable: Unreachable
    is_applied: bool

    @classmethod
    def none(cls, facts: Facts) -> Pruning:
        """Return the pruning that keeps all facts, for encodings whose meaning is unknown."""
        return cls(facts, RejectedActions({}, {}), None, None, Unreachable(), is_applied=False)


def find_pruning(
    step: Program, grounder: Grounder, facts: Facts, statements: Sequence[Statement], encodings: Path | None
) -> Pruning:
    """Return the pruning of the `facts` of a domain.

    `step` is the program of a step without user rules. `grounder` has grounded the base part, and contains the program
    of relaxed steps if the folder of `encodings` has it.
    """
    actions = find_rejected_actions(step, grounder.control, facts, statements)
    composites = find_rejected_composites(step, facts, actions, statements) if facts.composites else None
    applied = any(atom.signature == PRUNED for each in statements if not each.own for atom in each.body)
    if not applied:
        return Pruning(facts, actions, composites, None, Unreachable(), is_applied=False)
    remaining = without(facts, {*actions.rejections, *(composites.composites if composites else ())})
    reach = find_relaxed_reach(grounder, remaining, statements, encodings) if encodings else None
    unreachable = Unreachable()
    static: Assignment = ()
    if reach:
        goal = tuple(each for each in remaining.goal if each not in reach.standing)
        never = tuple(action for action in remaining.actions if action not in reach.actions)
        # If no action is reachable, one action represents all.
        unreachable = Unreachable(never, goal)
        if not reach.actions:
            unreachable = Unreachable((), goal, next(iter(remaining.tried), None))
        # The opposite of a static value is unreachable. Invariants may restrict values as well.
        if not (remaining.exclusive or remaining.implies or remaining.impossible):
            initially = remaining.initially
            static = tuple(each for each in initially if (each[0], OPPOSITE[each[1]]) not in reach.values)
    remaining = replace(remaining, unreachable=unreachable.actions, static=static)
    return Pruning(remaining, actions, composites, reach, unreachable, is_applied=True)
