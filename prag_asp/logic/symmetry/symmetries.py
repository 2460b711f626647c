"""The entities of a program that are interchangeable on their own or together with others.

Two kinds of swaps generate all renamings: swaps of two entities of a group, and swaps of two aligned units of a joint
group, which exchange their i-th entities for all i. Each group or joint group lies within one unit or outside all
units: a tray has its own cups, and each cup its own saucer. Hence the renamings of one joint group permute its units in
all ways, and the renamings of all groups are a product of wreath products.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import factorial, prod

import clingo

from prag_asp.program.predicates import INTRODUCED, UNIT_INTRODUCED

Unit = tuple[clingo.Symbol, ...]


@dataclass(frozen=True)
class Symmetries:
    """Groups of two or more interchangeable entities, and joint groups of two or more units, outer ones first."""

    groups: tuple[tuple[clingo.Symbol, ...], ...] = ()
    joint: tuple[tuple[Unit, ...], ...] = ()

    def __bool__(self) -> bool:
        return bool(self.groups or self.joint)

    @property
    def order(self) -> int:
        """The number of renamings, which is the number of plans for a task that names all entities."""
        return prod(factorial(len(each)) for each in (*self.groups, *self.joint))

    @cached_property
    def entities(self) -> frozenset[clingo.Symbol]:
        """All entities that some renaming moves."""
        units = (entity for units in self.joint for unit in units for entity in unit)
        return frozenset(entity for group in self.groups for entity in group).union(units)

    @cached_property
    def orbits(self) -> tuple[tuple[clingo.Symbol, ...], ...]:
        """The orbits of entities under the renamings, in clingo's order of terms."""
        orbit_of: dict[clingo.Symbol, set[clingo.Symbol]] = {}
        for alike in (*self.groups, *(row for units in self.joint for row in zip(*units, strict=True))):
            joined = set(alike).union(*(orbit_of.get(entity, ()) for entity in alike))
            orbit_of |= dict.fromkeys(joined, joined)
        return tuple(dict.fromkeys(tuple(sorted(orbit_of[entity])) for entity in sorted(orbit_of)))

    @cached_property
    def innermost(self) -> tuple[tuple[Unit, ...], ...]:
        """The groups, as units of one entity, and the joint groups whose units contain no other group."""
        innermost: list[tuple[Unit, ...]] = [tuple((entity,) for entity in group) for group in self.groups]
        inside = {entity for group in self.groups for entity in group}
        for units in reversed(self.joint):
            members = {entity for unit in units for entity in unit}
            if inside.isdisjoint(members):
                innermost.append(units)
            inside |= members
        return tuple(innermost)

    @cached_property
    def naming(self) -> dict[clingo.Symbol, Unit]:
        """The atoms of a task step that record that an entity or unit has been named, each with its unit."""
        atoms: dict[clingo.Symbol, Unit] = {}
        for entity in (entity for group in self.groups for entity in group):
            atoms[INTRODUCED.timeless(entity)] = (entity,)
        for number, units in enumerate(self.joint):
            for place, unit in enumerate(units):
                name = clingo.Function("", [clingo.Number(number), clingo.Number(place)])
                atoms[UNIT_INTRODUCED.timeless(name)] = unit
        return atoms

    def is_settled(self, entity: clingo.Symbol, named: set[clingo.Symbol]) -> bool:
        """Return whether every renaming that fixes the entities `named` also fixes a given entity."""
        if entity in named:
            return True
        alone = all(entity not in group for group in self.groups)
        return alone and all(not named.isdisjoint(unit) for unit in self.units_of(entity))

    def units_of(self, entity: clingo.Symbol) -> Iterator[Unit]:
        """Yield the units that an entity belongs to."""
        return (unit for units in self.joint for unit in units if entity in unit)

    def names(self, mentioned: Iterable[clingo.Symbol]) -> dict[clingo.Symbol, clingo.Symbol]:
        """Return the renaming under which a plan introduces the members of each group and each joint group in order.

        `mentioned` are the entities of a plan in the order in which the plan names them. Exactly one renaming of a plan
        introduces, at each point, the least entity that the previous ones allow (a chain of stabilizers, Sims 1970):
        the units of a joint group in order, and the groups within each unit in order.
        """
        names = {entity: entity for entity in mentioned if entity in self.entities}
        for alike in (*self.joint, *(tuple((entity,) for entity in group) for group in self.groups)):
            unit_of = {entity: unit for unit in alike for entity in unit}
            introduced = dict.fromkeys(unit_of[name] for name in names.values() if name in unit_of)
            places = {old: new for pair in zip(introduced, alike, strict=False) for old, new in zip(*pair, strict=True)}
            names = {entity: places.get(name, name) for entity, name in names.items()}
        return names
