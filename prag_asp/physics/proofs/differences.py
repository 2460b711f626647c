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
    heights = dict.fromkeys((node for gap in gaps for node in gap[:2]), 0.0)
    last: dict[Node, Gap] = {}
    node = ORIGIN
    for _ in range(len(heights) + 1):
        changed = False
        for gap in gaps:
            low, high, least = gap
            if heights[low] + least > heights[high] + ROUNDING:
                heights[high], last[high], node, changed = heights[low] + least, gap, high, True
        if not changed:
            return ()
    # The last gaps lead back from the node that was raised last into a cycle.
    for _ in heights:
        if node not in last:
            return ()
        node = last[node].low
    row, length, current = [node], last[node].least, last[node].low
    while current != node:
        row.append(current)
        length += last[current].least
        current = last[current].low
    if length <= ROUNDING:
        return ()
    row.reverse()
    turn = row.index(ORIGIN) if ORIGIN in row else 0
    return (*row[turn:], *row[:turn])


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
