"""A partition of entities into kinds by the terms that name them: renamings that keep the terms keep the kinds.

The partition is refined by the kinds that terms relate. The largest part of a split kind keeps its number, so that an
entity is processed again only if its part has at most half the size (Hopcroft 1971).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping

from prag_asp.logic.symmetry.renaming import Shaped


def refine_partition(facts: Mapping[int, Hashable], terms: Iterable[Shaped]) -> dict[int, int]:
    """Return the kind of each entity, a number, given its initial value `facts` and the terms that name entities."""
    naming: dict[int, list[Shaped]] = {entity: [] for entity in facts}
    for term in dict.fromkeys(terms):
        for entity in dict.fromkeys(term[1]):
            naming[entity].append(term)
    numbers: dict[Hashable, int] = {}
    kinds = {entity: numbers.setdefault(each, len(numbers)) for entity, each in facts.items()}
    members: dict[int, set[int]] = {kind: set() for kind in numbers.values()}
    for entity, kind in kinds.items():
        members[kind].add(entity)
    touched = {entity: None for entity in facts if len(members[kinds[entity]]) > 1}
    while touched:
        parts: dict[int, dict[Hashable, list[int]]] = {}
        for entity in touched:
            signature = sorted(
                (shape, *(-1 if each == entity else kinds[each] for each in inside)) for shape, inside in naming[entity]
            )
            parts.setdefault(kinds[entity], {}).setdefault(tuple(signature), []).append(entity)
        moved: list[int] = []
        for kind, split in parts.items():
            # The untouched entities form one part; the touched ones differ from them and are new.
            others = len(members[kind]) > sum(map(len, split.values()))
            ordered = sorted(split.values(), key=len, reverse=True)
            for part in ordered if others else ordered[1:]:
                new = len(members)
                members[new] = set(part)
                members[kind] -= members[new]
                kinds |= dict.fromkeys(part, new)
                moved += part
        around = (each for entity in moved for _, inside in naming[entity] for each in inside)
        touched = {entity: None for entity in around if len(members[kinds[entity]]) > 1}
    return kinds
