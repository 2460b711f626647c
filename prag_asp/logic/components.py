"""Strongly connected components of a graph."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence


def components(graph: Mapping[int, Sequence[int]]) -> Iterator[list[int]]:
    """Yield the strongly connected components, each after those that it leads to (Tarjan 1972, without recursion).

    `graph` maps each node to the nodes that it leads to; one that is no key is left out.
    """
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    path: list[int] = []
    waiting: set[int] = set()
    for root in graph:
        if root in index:
            continue
        work = [_entered(root, graph, index, low, path, waiting)]
        while work:
            node, rest = work[-1]
            for below in rest:
                if below not in index:
                    work.append(_entered(below, graph, index, low, path, waiting))
                    break
                if below in waiting:
                    low[node] = min(low[node], index[below])
            else:
                work.pop()
                if work:
                    above = work[-1][0]
                    low[above] = min(low[above], low[node])
                if low[node] == index[node]:
                    found = [path.pop()]
                    while found[-1] != node:
                        found.append(path.pop())
                    waiting.difference_update(found)
                    yield found


def _entered(
    node: int,
    graph: Mapping[int, Sequence[int]],
    index: dict[int, int],
    low: dict[int, int],
    path: list[int],
    waiting: set[int],
) -> tuple[int, Iterator[int]]:
    index[node] = low[node] = len(index)
    path.append(node)
    waiting.add(node)
    return node, (below for below in graph[node] if below in graph)
