"""Entities that are interchangeable only together with others, such as each cup with its own saucer.

The search is for minimal renamings that swap several pairs at once. It begins with one pair, finds an atom or a rule
without an image, and also moves the blocks that this atom or rule names, until every atom and rule has an image. The
two sides of such a swap are two units; the swaps for further units share the first side. Each unit then becomes one
block, so that units of units are found as well: trays with their own cups, which have their own saucers.

Only groups of pairwise swappable units are found, so that the generated group is known. The rotations and reflections
of a ring are not such a group, so a ring has at most the two sides of one reflection.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from prag_asp.logic.symmetry.renaming import Shaped, by_entity

Block = tuple[int, ...]
"""Entities that move together, in an order that is the same for blocks of the same kind."""

Swap = dict[int, int]
"""A swap of blocks: the index of each block that it moves, with the index of the block that takes its place."""

FEWEST, MOST = 4, 256
"""The smallest and the largest bound on the number of blocks that one swap moves; between them, the bound is doubled.
"""

TRIES = 8
"""The number of further pairs that one search tries, per block that it may move."""

WORK, EACH, RULES = 300_000, 40, 8
"""The bound on the number of atoms that all searches rename: a constant, plus a number for each occurrence of an entity
in an atom. An atom whose rules are renamed counts as `RULES` atoms."""


@dataclass(frozen=True)
class MissingImage:
    """An atom or a rule without an image under a renaming: the entities that it names, and the rest of its content."""

    entities: frozenset[int]
    kept_by: Callable[[Mapping[int, int]], bool]


class Renamed(Protocol):
    """A structure that renamings must map onto itself."""

    @property
    def exact(self) -> Iterable[Shaped]:
        """Terms, each with a mark, that every renaming maps onto themselves."""
        ...

    def lacking(self, names: Mapping[int, int], entities: Iterable[int]) -> Iterator[MissingImage]:
        """Yield the atoms that name at least one of the given entities and have no image."""
        ...

    def broken(self, names: Mapping[int, int]) -> Iterator[MissingImage]:
        """Yield the rules without an image, given that all atoms have one."""
        ...

    def size(self, entities: Iterable[int]) -> int:
        """Return the number of atoms that name each entity, summed over the given entities."""
        ...


def joint_groups(blocks: Sequence[Block], classes: Mapping[int, Hashable], rules: Renamed) -> list[list[Block]]:
    """Return groups of aligned units, outer ones first, given blocks that cannot be swapped on their own.

    Entities of different `classes` are not interchangeable.
    """
    kinds = refine_partition(classes, rules.exact)
    groups: list[list[Block]] = []
    search: _UnitSearch | None = None
    while True:
        alike: dict[tuple[int, ...], list[int]] = {}
        for place, block in enumerate(blocks):
            alike.setdefault(tuple(kinds[entity] for entity in block), []).append(place)
        swappable = [places for places in alike.values() if len(places) > 1]
        if not swappable:
            return groups
        if search is None:
            search = _UnitSearch(rules, WORK + EACH * rules.size(kinds))
        search.begin(blocks, swappable)
        new = search.groups()
        if not new:
            return groups
        moved = {place for units in new for unit in units for place in unit}
        units_of = [[tuple(e for place in unit for e in blocks[place]) for unit in units] for units in new]
        groups = units_of + groups
        joined = [tuple(entity for unit in units for entity in unit) for units in units_of]
        blocks = [*(block for place, block in enumerate(blocks) if place not in moved), *joined]


def refine_partition(classes: Mapping[int, Hashable], terms: Iterable[Shaped]) -> dict[int, int]:
    """Return the kind of each entity as a number, given its class and the terms that name entities.

    Renamings that preserve the terms preserve the kinds. The partition is refined according to the kinds that terms
    relate. When a kind is split, its largest part keeps the number, so an entity is processed again only if its part
    has shrunk to at most half its size (Hopcroft 1971).
    """
    naming = {**{entity: [] for entity in classes}, **by_entity(dict.fromkeys(terms))}
    numbers: dict[Hashable, int] = {}
    kinds = {entity: numbers.setdefault(each, len(numbers)) for entity, each in classes.items()}
    members: dict[int, set[int]] = {kind: set() for kind in numbers.values()}
    for entity, kind in kinds.items():
        members[kind].add(entity)
    touched = {entity: None for entity in classes if len(members[kinds[entity]]) > 1}
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


class _UnitSearch:
    """The search for swaps of blocks, and for groups of units that they swap."""

    def __init__(self, rules: Renamed, work: int) -> None:
        self._rules = rules
        self._left = work
        self._alone: set[Block] = set()

    def begin(self, blocks: Sequence[Block], classes: list[list[int]]) -> None:
        """Begin with new blocks, given in classes of blocks that may be swapped."""
        self._blocks, self._classes = blocks, classes
        self._class_of = {place: places for places in classes for place in places}
        self._rank = {place: rank for places in classes for rank, place in enumerate(places)}
        self._place_of = {entity: place for place in self._class_of for entity in blocks[place]}
        self._taken: set[int] = set()

    def groups(self) -> list[list[tuple[int, ...]]]:
        """Return the groups of the smallest aligned units; a unit is given by the indices of its blocks."""
        waiting = [[place for place in places if self._blocks[place] not in self._alone] for places in self._classes]
        while self._left > 0 and (waiting := [candidates for candidates in waiting if len(candidates) > 1]):
            most = FEWEST
            while most < 2 * max(min(len(self._class_of), MOST), FEWEST):
                if groups := self._smallest(waiting, most):
                    return groups
                most *= 2
            self._alone |= {self._blocks[candidates[0]] for candidates in waiting}
            waiting = [candidates[1:] for candidates in waiting]
        return []

    def _smallest(self, waiting: Sequence[Sequence[int]], most: int) -> list[list[tuple[int, ...]]]:
        """Return groups of the smallest units, of up to `most` blocks each, that swaps of the first blocks yield."""
        stars: list[list[Swap]] = []
        for remaining in waiting:
            if not {place for star in stars for swap in star for place in swap}.issuperset(remaining):
                stars.append(list(self._star(remaining, most)))
        smallest = min((len(swap) for star in stars for swap in star), default=0)
        groups = [units for star in stars if (units := self._units(star, smallest))]
        for places in waiting if groups else ():
            if self._taken.isdisjoint(places):
                continue
            remaining = self._free(places)
            while len(remaining) > 1:
                if units := self._units(list(self._star(remaining, smallest)), smallest):
                    groups.append(units)
                remaining = self._free(remaining[1:])
        return groups

    def _free(self, places: Iterable[int]) -> list[int]:
        return [place for place in places if place not in self._taken]

    def _star(self, places: Sequence[int], most: int) -> Iterator[Swap]:
        """Yield a swap of the first block with each of the others, if there is one that moves at most `most` blocks."""
        self._most = min(most, MOST)
        first = places[0]
        for other in places[1:]:
            self._tries = TRIES * self._most
            if swap := self._swap({first: other, other: first}, frozenset(), 0):
                yield swap

    def _units(self, star: Sequence[Swap], size: int) -> list[tuple[int, ...]]:
        """Return the units of `size` blocks that swaps of one block with others yield; mark their blocks as used."""
        swaps = [swap for swap in star if len(swap) == size and self._taken.isdisjoint(swap)]
        if not swaps:
            return []
        first = next(iter(swaps[0]))
        # The blocks that all swaps move, or one side of a single swap.
        side = {place for place, goes in swaps[0].items() if place < goes}
        for further in swaps[1:]:
            common = swaps[0].keys() & further.keys()
            apart = {*common, *(swap[place] for swap in (swaps[0], further) for place in common)}
            if 2 * len(common) == size and len(apart) == 3 * len(common):
                side = common
                break
        # Units of the same kind have their blocks in the same order.
        unit = tuple(sorted(side, key=lambda place: (self._class_of[place], place)))
        units = [unit]
        used = set(unit)
        for swap in swaps:
            other = tuple(swap.get(place, place) for place in unit)
            if swap.keys() == {*unit, *other} and used.isdisjoint(other):
                units.append(other)
                used.update(other)
        assert first in unit, "a swap moves the block it was found for"
        self._taken |= used
        return units

    def _swap(self, moved: Swap, fixed: frozenset[int], clean: int) -> Swap | None:
        """Return a swap that extends `moved`, does not move the blocks `fixed`, and maps the rules onto themselves.

        Unless further blocks move, all atoms that name entities of the first `clean` blocks have images.
        """
        self._tries -= 1
        if len(moved) > self._most or self._tries < 0 or self._left <= 0:
            return None
        names = self._names(moved)
        for place in list(moved)[clean:]:
            self._left -= 1 + self._rules.size(self._blocks[place])
            missing = next(self._rules.lacking(names, self._blocks[place]), None)
            if missing is not None:
                break
            clean += 1
        else:
            self._left -= RULES * self._rules.size(names)
            missing = next(self._rules.broken(names), None)
        if missing is None:
            return moved
        places = {self._place_of[entity] for entity in missing.entities if entity in self._place_of}
        for place in sorted(places - moved.keys() - fixed):
            settled = places <= {place, *moved, *fixed}
            for partner in self._partners(place, moved, fixed):
                self._left -= 1
                longer = {**moved, place: partner, partner: place}
                if settled and not missing.kept_by(self._names({p: longer[p] for p in places if p in longer})):
                    continue
                if extended := self._swap(longer, fixed, clean):
                    return extended
            fixed |= {place}
        return None

    def _names(self, moved: Swap) -> dict[int, int]:
        """Return the renaming of entities that a swap of blocks induces."""
        pairs = (zip(self._blocks[place], self._blocks[goes], strict=True) for place, goes in moved.items())
        return {entity: name for pair in pairs for entity, name in pair}

    def _partners(self, place: int, moved: Swap, fixed: frozenset[int]) -> Iterator[int]:
        """Yield the blocks with which a block may be swapped, starting with the one at the first pair's distance."""
        first, other = next(iter(moved.items()))
        places, step = self._class_of[place], self._rank[other] - self._rank[first]
        likely = self._rank[place] + step
        order = [places[likely]] if 0 <= likely < len(places) else []
        for partner in dict.fromkeys([*order, *places]):
            if partner != place and partner not in moved and partner not in fixed and partner not in self._taken:
                yield partner
