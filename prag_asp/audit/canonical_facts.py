"""Facts up to renaming of objects within a class: forms are equal if and only if a renaming maps one to the other.

Objects are coloured by their classes, colours are refined by the facts that name them (Weisfeiler and Leman 1968), and
an object of a class that remains tied is individualized, with the smallest result over all choices (McKay 1981). Parts
that share no tied object are independent, so each of them has its own form. A choice is skipped if a complete renaming
maps it to an earlier choice; this renaming is an automorphism, so the result is the same.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, TypeAlias

Relation: TypeAlias = "tuple[str, tuple[Hashable, ...]]"
"""A label with an ordered list of objects."""

Form: TypeAlias = "tuple[object, ...]"
"""A nested tuple of strings and numbers without the names of objects."""

_Token: TypeAlias = "tuple[int, int]"
"""A distinguished object: the depth at which it was distinguished, and its rank at this depth."""


def canonical_form(colours: Mapping[Any, str], relations: Iterable[Relation]) -> Form:
    """Return the form of relations between coloured objects; forms are equal only for isomorphic relations.

    Two structures are isomorphic if a bijection between their objects preserves colours and maps one set of relations
    to the other. `colours` contains all objects in the relations, and may contain others.
    """
    numbers = {each: number for number, each in enumerate(colours)}
    rows = {(label, tuple(numbers[each] for each in objects)) for label, objects in relations}
    return _form({numbers[each]: colour for each, colour in colours.items()}, sorted(rows), 0, greedy=False)


def _form(
    colours: Mapping[int, object], relations: Sequence[tuple[str, tuple[object, ...]]], depth: int, *, greedy: bool
) -> Form:
    """Return the form of a part; objects are numbers, or tokens if distinguished. `greedy` tries only first choices."""
    ranks = _refined(colours, relations)
    cells: dict[int, list[int]] = {}
    for each, rank in ranks.items():
        cells.setdefault(rank, []).append(each)
    head = tuple((colours[cells[rank][0]], len(cells[rank])) for rank in sorted(cells))
    token = {cell[0]: (depth, rank) for rank, cell in cells.items() if len(cell) == 1}
    rows = [(label, tuple(token.get(each, each) for each in objects)) for label, objects in relations]  # type: ignore[call-overload]
    fixed = tuple(
        sorted((label, objects) for label, objects in rows if not any(isinstance(each, int) for each in objects))
    )
    parts: list[Form] = []
    for members, own in _components([each for each in ranks if each not in token], rows):
        if len(members) == 1:
            named = [
                (label, tuple((depth, -1) if isinstance(each, int) else each for each in objects))
                for label, objects in own
            ]
            parts.append((0, ranks[members[0]], tuple(sorted(named))))
        else:
            parts.append((1, _individualized({each: ranks[each] for each in members}, own, depth + 1, greedy=greedy)))
    return head, fixed, tuple(sorted(parts))


def _individualized(
    ranks: Mapping[int, int], relations: Sequence[tuple[str, tuple[object, ...]]], depth: int, *, greedy: bool
) -> Form:
    """Return the smallest form over all choices of an object from the first smallest class."""
    cells: dict[int, list[int]] = {}
    for each, rank in ranks.items():
        cells.setdefault(rank, []).append(each)
    _, chosen = min((len(cell), rank) for rank, cell in cells.items())
    best: Form | None = None
    seen: set[Form] = set()
    for each in cells[chosen]:
        colours = {other: (rank, int(other == each)) for other, rank in ranks.items()}
        first = _form(colours, relations, depth, greedy=True)
        if greedy:
            return first
        if first in seen:
            continue
        seen.add(first)
        found = _form(colours, relations, depth, greedy=False)
        if best is None or found < best:
            best = found
    assert best is not None
    return best


def _refined(colours: Mapping[int, object], relations: Sequence[tuple[str, tuple[object, ...]]]) -> dict[int, int]:
    """Return the ranks of the objects after colour refinement."""
    order = {colour: rank for rank, colour in enumerate(sorted(set(colours.values())))}  # type: ignore[type-var]
    ranks = {each: order[colour] for each, colour in colours.items()}
    while True:
        seen: dict[int, list[tuple[object, ...]]] = {each: [] for each in ranks}
        for label, objects in relations:
            view = tuple((0, ranks[each]) if isinstance(each, int) else (1, each) for each in objects)
            for place, each in enumerate(objects):
                if isinstance(each, int):
                    same = tuple(other == each for other in objects)
                    seen[each].append((label, place, view, same))
        signatures = {each: (ranks[each], tuple(sorted(rows))) for each, rows in seen.items()}
        numbers = {signature: rank for rank, signature in enumerate(sorted(set(signatures.values())))}
        if len(numbers) == len(set(ranks.values())):
            return ranks
        ranks = {each: numbers[signature] for each, signature in signatures.items()}


def _components(
    objects: Sequence[int], relations: Sequence[tuple[str, tuple[object, ...]]]
) -> list[tuple[list[int], list[tuple[str, tuple[object, ...]]]]]:
    """Return the connected components: their objects and the relations between these."""
    leader = {each: each for each in objects}

    def find(each: int) -> int:
        while leader[each] != each:
            leader[each] = leader[leader[each]]
            each = leader[each]
        return each

    rows = [(row, [each for each in row[1] if isinstance(each, int)]) for row in relations]
    for _, members in rows:
        for each in members[1:]:
            leader[find(each)] = find(members[0])
    groups: dict[int, tuple[list[int], list[tuple[str, tuple[object, ...]]]]] = {}
    for each in objects:
        groups.setdefault(find(each), ([], []))[0].append(each)
    for row, members in rows:
        if members:
            groups[find(members[0])][1].append(row)
    return list(groups.values())
