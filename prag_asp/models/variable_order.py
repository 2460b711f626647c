"""In which order variables are decided, by the width of the formula's graph.

Variables that share a clause are neighbours. Eliminating them by least degree (a heuristic; finding the best order is
NP-hard) gives a tree decomposition. What is decided first lies near its middle, so that a formula falls apart into
halves that have no clause in common (as Korhonen and Järvisalo 2021 do for model counting).

What is reachable is no matter of halves: a formula with loops is swept from one end to the other, as Cuthill and McKee
(1969) number the rows of a matrix of small bandwidth, so that little has to be known of what was decided before.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

WIDEST = 120
"""Neighbours of a variable from which on the elimination ends: what is left is decided first, as one bag."""


@dataclass(frozen=True)
class DecisionOrder:
    """The variables of a formula, what is decided first at the beginning, and the width of their tree."""

    variables: tuple[int, ...]
    width: int


def decision_order(clauses: Iterable[Sequence[int]], *, swept: bool) -> DecisionOrder:
    """Return the order for clauses of any literals: from the middle, or `swept` from one end to the other."""
    occurrences: dict[int, int] = {}
    graph: dict[int, set[int]] = {}
    for clause in clauses:
        variables = sorted({abs(literal) for literal in clause})
        for variable in variables:
            occurrences[variable] = occurrences.get(variable, 0) + 1
            graph.setdefault(variable, set()).update(variables)
    for variable, neighbours in graph.items():
        neighbours.discard(variable)
    sweep = _sweep(graph) if swept else ()
    eliminated, core = _eliminate(graph)
    depth = {each: place for place, each in enumerate(sweep)} if swept else _depths(eliminated, core)
    ordered = sorted(occurrences, key=lambda each: (depth[each], -occurrences[each], each))
    bags = [len(bag) for _, bag in eliminated]
    return DecisionOrder(tuple(ordered), max([*bags, len(core) - 1, 0]))


def _sweep(graph: Mapping[int, set[int]]) -> list[int]:
    """Return the variables by their distance from one end, part by part."""
    found: list[int] = []
    seen: set[int] = set()
    for variable in sorted(graph, key=lambda each: (len(graph[each]), each)):
        if variable not in seen:
            end = _by_distance(graph, _by_distance(graph, variable)[-1])[-1]
            found += _by_distance(graph, end)
            seen.update(found)
    return found


def _by_distance(graph: Mapping[int, set[int]], start: int) -> list[int]:
    found, seen = [start], {start}
    for variable in found:  # grows on the way
        for each in sorted(graph[variable] - seen, key=lambda each: (len(graph[each]), each)):
            seen.add(each)
            found.append(each)
    return found


def _eliminate(graph: dict[int, set[int]]) -> tuple[list[tuple[int, set[int]]], set[int]]:
    """Return the variables in the order of their elimination, each with its neighbours then, and those left."""
    waiting = [(len(neighbours), variable) for variable, neighbours in graph.items()]
    heapify(waiting)
    found: list[tuple[int, set[int]]] = []
    while waiting:
        degree, variable = heappop(waiting)
        if variable not in graph or len(graph[variable]) != degree:
            continue
        if degree > WIDEST:
            break
        neighbours = graph.pop(variable)
        found.append((variable, neighbours))
        for each in neighbours:
            near = graph[each]
            near |= neighbours
            near -= {variable, each}
            heappush(waiting, (len(near), each))
    return found, set(graph)


def _depths(eliminated: Sequence[tuple[int, set[int]]], core: set[int]) -> dict[int, int]:
    """Return how far from the middle of the tree the nearest bag of each variable lies."""
    place = {variable: number for number, (variable, _) in enumerate(eliminated)}
    last = len(eliminated)  # the bag of what is left, where all trees meet
    bags = [{variable, *neighbours} for variable, neighbours in eliminated] + [core]
    above = [min((place.get(each, last) for each in neighbours), default=last) for _, neighbours in eliminated]
    size = [1] * (last + 1)
    for number, parent in enumerate(above):  # a bag comes before the one above it
        size[parent] += size[number]
    near: list[list[int]] = [[] for _ in bags]
    for number, parent in enumerate(above):
        near[number].append(parent)
        near[parent].append(number)
    middle = last if core else _middle(above, size, last)
    depth: dict[int, int] = {}
    waiting, seen = deque([(middle, 0)]), {middle}
    while waiting:
        number, far = waiting.popleft()
        for variable in bags[number]:
            depth.setdefault(variable, far)
        new = [each for each in near[number] if each not in seen]
        seen.update(new)
        waiting.extend((each, far + 1) for each in new)
    return depth


def _middle(above: Sequence[int], size: Sequence[int], last: int) -> int:
    """Return a bag without which no part of the tree has more than half of the bags, or the root of an empty tree."""
    heaviest = [0] * (last + 1)
    for number, parent in enumerate(above):
        heaviest[parent] = max(heaviest[parent], size[number])
    half = size[last] / 2
    return next((number for number in range(last + 1) if size[number] >= half and heaviest[number] <= half), last)
