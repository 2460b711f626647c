"""Counting a level whose domain falls into parts that have nothing in common: each part by itself, then all shuffled.

A plan of the whole is a plan of each part, together with which of its steps belong to which part; so the plans of
length n are the sum, over the ways to write n as a sum of one length for each part, of the multinomial coefficient and
the product of the parts' counts (the product formula of exponential generating functions; Stanley, Enumerative
Combinatorics 2, 5.1). For that a part has to stay as it is while another one acts, which is tested on every state.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import comb, prod

from prag_asp.logic.step.transition import Transition
from prag_asp.processes.stage import stage
from prag_asp.space.automaton.automaton import Completions
from prag_asp.space.automaton.explore import Extent
from prag_asp.space.engines.reach import HALTED, Explorer, Halt, Reach
from prag_asp.space.limits import Budget

MANY_EDGES = 5_000_000
"""Edges of a part beyond which nothing is won by finding its words apart."""


@dataclass(frozen=True)
class Apart:
    """How many words there are, the states explored for that, and which limit ended it, in words."""

    found: int
    states: int
    stopped: str


def count_apart(explorer: Explorer, parts: Sequence[Transition], length: int, budget: Budget) -> Apart | None:
    """Return the number of words of a length of a level, given by the independent parts of its domain.

    None where some part does not rest while another acts. A limit leaves words out; none is wrong. Of skeletons, no two
    parts have a name of actions in common, or two of theirs could be shuffled to the same one.
    """
    found = reach_apart(explorer, parts, length, budget)
    if found is None:
        return None
    counts = [_terms(reach.completions, length) for reach in found]
    stage("counting shuffles")
    number, late = shuffled(counts, budget.to_close().spent)
    return Apart(number, sum(reach.states for reach in found), stopped_at_first(found) or late)


def reach_apart(
    explorer: Explorer, parts: Sequence[Transition], length: int, budget: Budget, halt: Halt | None = None
) -> list[Reach] | None:
    """Return what each part reaches within a length; None where `halt` says so, or one does not rest as another acts.

    Once a limit ended one, no more than the first state of the others is looked at.
    """
    found: list[Reach] = []
    for part in parts:
        steps = 0 if stopped_at_first(found) else length
        found.append(explorer.reach(part, steps, budget, halt, allow=part.rests))
        if found[-1].stopped == HALTED:
            return None
    return found


def large(extent: Extent) -> bool:
    """Return whether a part has too many edges for its words to be found apart."""
    return extent.edges > MANY_EDGES


def stopped_at_first(reaches: Sequence[Reach]) -> str:
    """Return the limit that ended one of them first, in words, or ""."""
    return next((reach.stopped for reach in reaches if reach.stopped), "")


def shuffled(counts: Sequence[Sequence[int]], spent: Callable[[], str | None] = lambda: None) -> tuple[int, str]:
    """Return the number of shuffles of one word of each part that have the greatest length, and "".

    `counts` has, for each part, the numbers of words of the lengths 0, 1, ..., n. Where `spent` says that a limit is
    reached, that is returned, and no more than the words of the parts that were shuffled until then.
    """
    first, *others = counts
    whole, length = list(first), len(first) - 1
    for place, part in enumerate(others, 1):
        wanted = range(length + 1) if place < len(others) else range(length, length + 1)
        used = [k for k, count in enumerate(part) if count]
        following = []
        for n in wanted:
            stopped = spent()
            if stopped:
                return whole[length] * prod(rest[0] for rest in others[place - 1 :]), stopped
            following.append(sum(comb(n, k) * part[k] * whole[n - k] for k in used if k <= n))
        whole = following
    return whole[-1], ""


def _terms(completions: Completions, length: int) -> list[int]:
    """Return the number of words of each length up to one."""
    if not completions.automaton.states:
        return [0] * (length + 1)
    row = completions.row(0)
    terms = [int(row[0])]
    for _ in range(length):
        row = completions.following(row)
        terms.append(int(row[0]))
    return terms
