"""Equivalent copies of atoms in loops: copies that derive each other are equal, so one represents all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Sequence

from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.program.finite.components import components


def merge_copies(
    copies: Container[int], clauses: Sequence[Sequence[Literal]]
) -> tuple[dict[Literal, Literal], set[int]]:
    """Return the representatives of the literals of other copies, and the variables that further clauses read.

    A copy derives another by a binary clause; if no other clause derives the latter, the two are equivalent. The least
    copy that further clauses read represents its class, so that unread copies do not matter.
    """
    pairs: list[tuple[int, int]] = []
    read: set[int] = set()
    for clause in clauses:
        first, second = (min(clause), max(clause)) if len(clause) == 2 else (1, 1)
        if first < 0 < second and -first in copies and second in copies:
            pairs.append((-first, second))
        else:
            read.update(map(abs, clause))
    ways = Counter(literal for clause in clauses for literal in clause if literal > 0)
    graph: dict[int, list[int]] = {}
    for first, second in pairs:
        graph.setdefault(first, []).append(second)
        if ways[second] == 1:
            graph.setdefault(second, []).append(first)
    groups = [group for group in components(graph, lambda copy: graph.get(copy, ())) if len(group) > 1]
    group_of = {copy: place for place, group in enumerate(groups) for copy in group}
    for first, second in pairs:  # a clause between two groups reads both
        if first not in group_of or group_of[first] != group_of.get(second):
            read |= {first, second}
    one: dict[Literal, Literal] = {}
    for group in groups:
        chosen = min((copy for copy in group if copy in read), default=min(group))
        one |= {sign * copy: sign * chosen for copy in group for sign in (1, -1) if copy != chosen}
    return one, read
