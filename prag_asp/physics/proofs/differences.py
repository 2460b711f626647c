"""Systems of difference constraints: whether any coordinates satisfy all lower bounds on their differences.

A system is unsatisfiable if and only if its graph has a cycle of positive length, which the Bellman-Ford algorithm
finds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from prag_asp.physics.predicates.gaps import ORIGIN, ROUNDING, Gap, Node


def impossible_row(gaps: Sequence[Gap]) -> tuple[Node, ...]:
    """Return a cycle of positive length: nodes, each of which has to be above the one before; () if there is none.

    The cycle begins at the origin if it passes it.
    """
    reached = dict.fromkeys((node for gap in gaps for node in gap[:2]), 0.0)
    last: dict[Node, Gap] = {}
    changed = _relax(gaps, reached, last)
    for _ in range(len(reached)):
        if changed is None:
            return ()
        changed = _relax(gaps, reached, last)
    row = () if changed is None else _cycle(last, changed, len(reached))
    if ORIGIN in row:
        turn = row.index(ORIGIN)
        return (*row[turn:], *row[:turn])
    return row


def _relax(gaps: Sequence[Gap], reached: dict[Node, float], last: dict[Node, Gap]) -> Node | None:
    """Raise every coordinate that violates a gap, and return the last one raised."""
    changed = None
    for gap in gaps:
        low, high, least = gap
        if reached[low] + least > reached[high] + ROUNDING:
            reached[high], last[high], changed = reached[low] + least, gap, high
    return changed


def _cycle(last: Mapping[Node, Gap], node: Node, steps: int) -> tuple[Node, ...]:
    """Return the cycle of positive length to which the last gaps lead back from a node, the lowest node first."""
    for _ in range(steps):
        if node not in last:
            return ()
        node = last[node].low
    row, length, current = [node], last[node].least, last[node].low
    while current != node:
        row.append(current)
        length += last[current].least
        current = last[current].low
    return tuple(reversed(row)) if length > ROUNDING else ()


def lowest(gaps: Iterable[Gap], start: Node) -> Mapping[Node, float]:
    """Return lower bounds on the differences of coordinates from that of `start`, as far as gaps imply any.

    The gaps have to be satisfiable.
    """
    gaps = list(gaps)
    bounds = {start: 0.0}
    changed = True
    while changed:
        changed = False
        for low, high, least in gaps:
            if low in bounds and bounds[low] + least > bounds.get(high, float("-inf")) + ROUNDING:
                bounds[high] = bounds[low] + least
                changed = True
    return bounds
