"""Copies of atoms in loops that derive each other: where one is true, all are, so one of them can stand for all."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from prag_asp.logic.formula.clauses import Literal
from prag_asp.program.finite.components import components


def equivalent(copies: Collection[int], clauses: Sequence[Sequence[Literal]]) -> dict[Literal, Literal]:
    """Return for the literals of copies those that stand for them, where it is another.

    A copy derives another by a clause of these two. Of those that derive each other, the least one stands for all that
    some other clause reads, so that copies that nothing else reads leave no trace.
    """
    derived: dict[int, list[int]] = {}
    others: list[Sequence[Literal]] = []
    for clause in clauses:
        first, second = (min(clause), max(clause)) if len(clause) == 2 else (1, 1)
        if first < 0 < second and -first in copies and second in copies:
            derived.setdefault(-first, []).append(second)
        else:
            others.append(clause)
    read = {abs(literal) for clause in others for literal in clause}
    one: dict[Literal, Literal] = {}
    groups = [group for group in components(derived, lambda copy: derived.get(copy, ())) if len(group) > 1]
    group_of = {copy: place for place, group in enumerate(groups) for copy in group}
    for copy, below in derived.items():  # a clause between two groups reads both
        for other in below:
            if copy not in group_of or group_of[copy] != group_of.get(other):
                read |= {copy, other}
    for group in groups:
        chosen = min((copy for copy in group if copy in read), default=min(group))
        one |= {sign * copy: sign * chosen for copy in group for sign in (1, -1) if copy != chosen}
    return one
