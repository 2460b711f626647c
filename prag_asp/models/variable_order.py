"""The decision order of variables, from a tree decomposition of the primal graph.

Variables that share a clause are adjacent. Min-degree elimination (a heuristic; an optimal order is NP-hard) gives a
tree decomposition. Variables near its centre are decided first, so that the formula splits into halves without a common
clause (as Korhonen and Järvisalo 2021 do for model counting).

Reachability does not split into halves, so the variables of a formula with loops are ordered from one end to the other,
as Cuthill and McKee (1969) number the rows of a matrix to reduce its bandwidth, so that a case depends on few earlier
decisions. A formula with sums or clauses over all of its parts, such as "each cell is visited at some time", does not
split either; for such a clause, all that matters is whether an earlier decision has made one of its literals true.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import accumulate, chain

WIDEST = 120
"""The degree above which elimination ends; the remaining variables form one bag and are decided first."""


LONG = 6
"""The number of literals above which a clause does not make its variables neighbours in a sweep."""

LONGEST = 1000
"""The number of literals above which a clause is too long for a tree decomposition, which takes quadratic time."""

WIDE = 24
"""The width above which a formula without sums may be swept."""


@dataclass(frozen=True)
class DecisionOrder:
    """The variables in decision order, the width of their tree decomposition, and whether the formula is swept."""

    variables: tuple[int, ...]
    width: int
    swept: bool


def decision_order(
    clauses: Iterable[Sequence[int]], sums: Iterable[Sequence[int]] = (), *, looped: bool
) -> DecisionOrder:
    """Return the decision order for clauses and the variables of sums.

    A formula with loops is swept. So is a formula that has sums or is wide, if its frontier is no larger than its
    width.
    """
    groups = [tuple(sorted({abs(literal) for literal in clause})) for clause in clauses]
    summed = [tuple(each) for each in sums]
    groups += summed
    occurrences = Counter(chain.from_iterable(groups))
    graph = _primal_graph(groups, LONGEST)
    longest = max((len(group) - 1 for group in groups if len(group) > LONGEST), default=0)
    sweep = _sweep(graph) if looped else []
    eliminated, core = _eliminate(graph)
    width = max([len(bag) for _, bag in eliminated] + [len(core) - 1, longest, 0])
    if not looped and (summed or width > WIDE):
        sweep = _sweep(_primal_graph(groups, LONG))
        if _frontier(sweep, groups) > width:
            sweep = []
    depth = {variable: place for place, variable in enumerate(sweep)} if sweep else _depths(eliminated, core)
    ordered = sorted(occurrences, key=lambda variable: (depth[variable], -occurrences[variable], variable))
    return DecisionOrder(tuple(ordered), width, bool(sweep))


def sweep_order(groups: Sequence[tuple[int, ...]], longest: int) -> list[int]:
    """Return the variables of groups from one end to the other; groups of at most `longest` variables connect them."""
    return _sweep(_primal_graph(groups, longest))


def _primal_graph(groups: Sequence[tuple[int, ...]], longest: int) -> dict[int, set[int]]:
    """Return the neighbours of each variable, connected by groups of at most `longest` variables."""
    graph: dict[int, set[int]] = {}
    for group in groups:
        for variable in group:
            graph.setdefault(variable, set()).update(group if len(group) <= longest else ())
    for variable, neighbours in graph.items():
        neighbours.discard(variable)
    return graph


def _frontier(order: Sequence[int], groups: Sequence[tuple[int, ...]]) -> int:
    """Return the largest number of earlier variables and long groups that matter to the later variables of an order."""
    place = {variable: number for number, variable in enumerate(order)}
    last = list(range(len(order)))  # the last neighbour of the variable at each place
    changes = [0] * len(order)
    for group in groups:
        places = sorted(map(place.__getitem__, group))
        if len(group) > LONG:
            changes[places[0]] += 1
            changes[places[-1]] -= 1
        else:
            for each in places:
                last[each] = max(last[each], places[-1])
    for first, end in enumerate(last):
        changes[first] += 1
        changes[end] -= 1
    return max(accumulate(changes), default=0)


def _sweep(graph: Mapping[int, set[int]]) -> list[int]:
    """Return the variables by their distance from one end, component by component."""
    swept: list[int] = []
    seen: set[int] = set()
    for variable in sorted(graph, key=lambda node: (len(graph[node]), node)):
        if variable not in seen:
            end = _by_distance(graph, _by_distance(graph, variable)[-1])[-1]
            swept += _by_distance(graph, end)
            seen.update(swept)
    return swept


def _by_distance(graph: Mapping[int, set[int]], start: int) -> list[int]:
    reached, seen = [start], {start}
    for variable in reached:  # grows during the iteration
        for neighbour in sorted(graph[variable] - seen, key=lambda node: (len(graph[node]), node)):
            seen.add(neighbour)
            reached.append(neighbour)
    return reached


def _eliminate(graph: dict[int, set[int]]) -> tuple[list[tuple[int, set[int]]], set[int]]:
    """Return the variables in elimination order, each with its neighbours at that time, and the remaining variables."""
    waiting = [(len(neighbours), variable) for variable, neighbours in graph.items()]
    heapify(waiting)
    eliminated: list[tuple[int, set[int]]] = []
    while waiting:
        degree, variable = heappop(waiting)
        if variable not in graph or len(graph[variable]) != degree:
            continue
        if degree > WIDEST:
            break
        neighbours = graph.pop(variable)
        eliminated.append((variable, neighbours))
        for neighbour in neighbours:
            near = graph[neighbour]
            near |= neighbours
            near -= {variable, neighbour}
            heappush(waiting, (len(near), neighbour))
    return eliminated, set(graph)


def _depths(eliminated: Sequence[tuple[int, set[int]]], core: set[int]) -> dict[int, int]:
    """Return, for each variable, the distance from the centre of the tree to the nearest bag that contains it."""
    place = {variable: number for number, (variable, _) in enumerate(eliminated)}
    last = len(eliminated)  # the bag of the remaining variables joins all trees
    bags = [{variable, *neighbours} for variable, neighbours in eliminated] + [core]
    above = [
        min((place.get(neighbour, last) for neighbour in neighbours), default=last) for _, neighbours in eliminated
    ]
    size = [1] * (last + 1)
    for number, parent in enumerate(above):  # a bag precedes its parent
        size[parent] += size[number]
    near: list[list[int]] = [[] for _ in bags]
    for number, parent in enumerate(above):
        near[number].append(parent)
        near[parent].append(number)
    middle = last
    if not core:  # a centroid bag, whose removal leaves no component with more than half of the bags, or else the root
        heaviest, half = [0] * (last + 1), size[last] / 2
        for number, parent in enumerate(above):
            heaviest[parent] = max(heaviest[parent], size[number])
        middle = next((each for each in range(last + 1) if size[each] >= half and heaviest[each] <= half), last)
    depth: dict[int, int] = {}
    waiting, seen = deque([(middle, 0)]), {middle}
    while waiting:
        number, far = waiting.popleft()
        for variable in bags[number]:
            depth.setdefault(variable, far)
        new = [bag for bag in near[number] if bag not in seen]
        seen.update(new)
        waiting.extend((bag, far + 1) for bag in new)
    return depth
