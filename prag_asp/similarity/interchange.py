"""Interchangeable entities as plain values, and the renamings that matter when two tasks are compared.

Swaps of two entities of a group, and swaps of two aligned units of a joint group, generate all renamings, as in
`prag_asp.logic.symmetry.symmetries`. The distance between two tasks is the smallest over the renamings of one of them.
Two renamings give the same distance if a renaming that fixes all entities of the other task turns one of them into the
other, so one representative of each such class (a double coset) is enough. For k and l entities from a group of any
size, these are the partial matchings between the k and the l entities.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar

Entity = TypeVar("Entity", bound=Hashable)


@dataclass(frozen=True)
class Interchange(Generic[Entity]):
    """Groups of interchangeable entities, and joint groups of units (tuples of entities), which are swapped whole."""

    groups: tuple[tuple[Entity, ...], ...] = ()
    joint: tuple[tuple[tuple[Entity, ...], ...], ...] = ()

    @cached_property
    def entities(self) -> frozenset[Entity]:
        """All entities that some renaming moves."""
        units = (entity for units in self.joint if len(units) > 1 for unit in units for entity in unit)
        return frozenset(entity for group in self.groups if len(group) > 1 for entity in group).union(units)

    def fixing(self, fixed: Iterable[Entity]) -> Interchange[Entity]:
        """Return the renamings that fix each of the given entities (the pointwise stabilizer)."""
        still = frozenset(fixed)
        groups = (tuple(entity for entity in group if entity not in still) for group in self.groups)
        joint = (tuple(unit for unit in units if still.isdisjoint(unit)) for units in self.joint)
        return Interchange(
            tuple(group for group in groups if len(group) > 1), tuple(units for units in joint if len(units) > 1)
        )

    @cached_property
    def _places(self) -> Mapping[Entity, list[tuple[tuple[tuple[Entity, ...], ...], int, int]]]:
        """The groups and joint groups of each entity, with the index of its unit, and its index within that unit."""
        places: dict[Entity, list[tuple[tuple[tuple[Entity, ...], ...], int, int]]] = {}
        for alike in (*(tuple((each,) for each in group) for group in self.groups), *self.joint):
            for number, unit in enumerate(alike):
                for place, entity in enumerate(unit):
                    places.setdefault(entity, []).append((alike, number, place))
        return places

    def orbit(self, entity: Entity) -> Mapping[Entity, Mapping[Entity, Entity]]:
        """Return the images of an entity, beginning with itself, each with a renaming that moves the entity there."""
        renamings: dict[Entity, dict[Entity, Entity]] = {entity: {}}
        reached: set[tuple[int, int]] = set()  # positions in units whose entities are all in the orbit
        for image in (queue := [entity]):
            for alike, number, place in self._places.get(image, ()):
                if (id(alike), place) in reached:
                    continue
                reached.add((id(alike), place))
                unit = alike[number]
                for other in (other for other in alike if other[place] not in renamings):
                    swap = {**dict(zip(unit, other, strict=True)), **dict(zip(other, unit, strict=True))}
                    renamings[other[place]] = _then(renamings[image], swap)
                    queue.append(other[place])
        return renamings

    def renamings(self, mentioned: Iterable[Entity], fixed: Iterable[Entity] = ()) -> Iterator[Mapping[Entity, Entity]]:
        """Yield the new names of the entities of a plan, one renaming for each class that matters.

        `mentioned` are the entities in the plan that is renamed, and `fixed` are those in the other plan. The first
        renaming changes nothing; entities that keep their names are not in the mappings.
        """
        movable = tuple(dict.fromkeys(entity for entity in mentioned if entity in self.entities))
        for renaming in self._images(movable, self.fixing(fixed), {}):
            yield {old: renaming[old] for old in movable if renaming.get(old, old) != old}

    def _images(
        self, rest: tuple[Entity, ...], free: Interchange[Entity], renaming: dict[Entity, Entity]
    ) -> Iterator[Mapping[Entity, Entity]]:
        """Yield renamings of `rest`, each followed by `renaming`: one for each class of those that `free` identifies.

        The stabilizers of the entities chosen so far form a chain on both sides (Sims 1970).
        """
        if not rest:
            yield renaming
            return
        entity, seen = rest[0], set[Entity]()
        for place, way in self.orbit(entity).items():
            target = renaming.get(place, place)
            if target not in seen:
                seen.update(free.orbit(target))
                inner = self.fixing([entity])
                yield from inner._images(rest[1:], free.fixing([target]), _then(way, renaming))


def _then(first: Mapping[Entity, Entity], second: Mapping[Entity, Entity]) -> dict[Entity, Entity]:
    """Return the composition of two renamings."""
    return {**second, **{old: second.get(new, new) for old, new in first.items()}}
