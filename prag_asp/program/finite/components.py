"""Strongly connected components of a graph."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from typing import TypeVar

Node = TypeVar("Node", bound=Hashable)


def components(roots: Iterable[Node], below: Callable[[Node], Iterable[Node]]) -> Iterator[list[Node]]:
    """Yield the strongly connected components that are reachable from `roots` (Tarjan 1972, without recursion).

    `below` returns the successors of a node. Each component comes after all the other components that it reaches.
    """
    index: dict[Node, int] = {}
    low: dict[Node, int] = {}
    path: list[Node] = []
    waiting: set[Node] = set()

    def entered(node: Node) -> tuple[Node, Iterator[Node]]:
        index[node] = low[node] = len(index)
        path.append(node)
        waiting.add(node)
        return node, iter(below(node))

    for root in roots:
        work = [] if root in index else [entered(root)]
        while work:
            node, rest = work[-1]
            for other in rest:
                if other not in index:
                    work.append(entered(other))
                    break
                if other in waiting:
                    low[node] = min(low[node], index[other])
            else:
                work.pop()
                if work:
                    above = work[-1][0]
                    low[above] = min(low[above], low[node])
                if low[node] == index[node]:
                    component = [path.pop()]
                    while component[-1] != node:
                        component.append(path.pop())
                    waiting.difference_update(component)
                    yield component
