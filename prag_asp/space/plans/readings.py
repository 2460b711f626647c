"""The readings of a plan: its decompositions into whole composites and free actions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from prag_asp.atom import Atom, atom_of
from prag_asp.program.composition import composite_actions
from prag_asp.program.facts import Facts


@dataclass(frozen=True)
class Composite:
    """A composite with its parts, each an action or a composite.

    It prints as ``serve(cup)[take(cup) pour[open close]]``.
    """

    term: Atom
    parts: tuple[Atom | Composite, ...]

    def __str__(self) -> str:
        return f"{self.term}[{' '.join(map(str, self.parts))}]"

    def actions(self) -> Iterator[Atom]:
        """Yield the atomic actions, in order."""
        for part in self.parts:
            if isinstance(part, Composite):
                yield from part.actions()
            else:
                yield part


Reading = tuple[Atom | Composite, ...]
"""A plan decomposed into free actions and whole composites."""


@dataclass(frozen=True)
class Hierarchy:
    """The units of readings: `units` maps a sequence of actions to its free action and its composites.

    The free action comes first, followed by the composites in clingo's order of terms. If the domain has no composites,
    `units` is None: every action is free.
    """

    units: Mapping[tuple[Atom, ...], tuple[Atom | Composite, ...]] | None

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """The possible numbers of actions of a unit, in increasing order."""
        return (1,) if self.units is None else tuple(sorted({len(actions) for actions in self.units}))

    def at(self, actions: tuple[Atom, ...]) -> tuple[Atom | Composite, ...]:
        """Return the free action and the composites that consist of exactly these actions."""
        return actions if self.units is None else self.units.get(actions, ())


def hierarchy_of(facts: Facts) -> Hierarchy:
    """Return the composites and the free actions of a domain."""
    if not facts.composites:
        return Hierarchy(None)
    atoms = {term: atom_of(term) for term in (*facts.declared_actions, *facts.composites)}
    whole: dict[Atom, Composite] = {}
    units: dict[tuple[Atom, ...], tuple[Atom | Composite, ...]] = {(atoms[a],): (atoms[a],) for a in facts.free}
    words = composite_actions(facts)
    for composite in words:  # composites follow the composites that they contain
        parts = (atoms[part] for _, part in facts.stages[composite])
        whole[atoms[composite]] = Composite(atoms[composite], tuple(whole.get(part, part) for part in parts))
    for composite in facts.composites:
        word = tuple(atoms[action] for action in words[composite])
        units[word] = (*units.get(word, ()), whole[atoms[composite]])
    return Hierarchy(units)


@dataclass(frozen=True)
class Readings:
    """The readings of one plan, enumerated lazily, and their exact number.

    They are in lexicographic order of their units. Units that begin at the same action are ordered by their number of
    actions; among units of equal length, a free action precedes the composites, which are in clingo's order of terms.
    """

    actions: tuple[Atom, ...]
    hierarchy: Hierarchy

    @cached_property
    def _counts(self) -> Sequence[int]:
        """The number of readings of the actions from each index to the end."""
        counts = [0] * len(self.actions) + [1]
        for place in range(len(self.actions) - 1, -1, -1):
            counts[place] = sum(len(units) * counts[end] for end, units in self._units(place))
        return counts

    def _units(self, place: int) -> Iterator[tuple[int, tuple[Atom | Composite, ...]]]:
        """Yield the end indices of the units that begin at index `place`, each with the units that end there."""
        for length in self.hierarchy.lengths:
            if place + length > len(self.actions):
                break
            units = self.hierarchy.at(self.actions[place : place + length])
            if units:
                yield place + length, units

    def count(self) -> int:
        """Return the number of readings, without enumerating them."""
        return self._counts[0]

    def __iter__(self) -> Iterator[Reading]:
        units: list[Atom | Composite] = []
        waiting = [iter(self._branches(0))]
        if not self.actions:
            yield ()
        while waiting:
            end, unit = next(waiting[-1], (0, None))
            if unit is None:
                waiting.pop()
                del units[-1:]
            elif end == len(self.actions):
                yield (*units, unit)
            else:
                units.append(unit)
                waiting.append(iter(self._branches(end)))

    def _branches(self, place: int) -> Iterator[tuple[int, Atom | Composite]]:
        """Yield the units at index `place` that lead to a reading, each preceded by its end index."""
        if self._counts[place]:
            for end, units in self._units(place):
                if self._counts[end]:
                    yield from ((end, unit) for unit in units)
