"""The tree of classes, and the distances between entities and between actions in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from prag_asp.atom import Atom, parse_atom

ROOT = ""
"""The parent of all classes without a declared parent."""

LEAST_DIAMETER = 4
"""The number of edges between entities of two children of the root: entity, class, root, class, entity."""


@dataclass(frozen=True)
class ClassTree:
    """Entities with their classes, and classes with their direct parents.

    The distance between two entities is the number of edges on the shortest path between them, divided by the number of
    edges on the longest such path between entities of any two classes (Rada et al. 1989). It is 0 for the same entity,
    and 1 for entities of the two classes that are farthest apart. Without `parents`, the distance is 1/2 within a class
    and 1 otherwise. The lengths of shortest paths in a graph are a metric.
    """

    classes: Mapping[str, str]
    parents: Mapping[str, tuple[str, ...]]

    @cached_property
    def _paths(self) -> Mapping[str, Mapping[str, int]]:
        """The number of edges between two classes."""
        names = {*self.classes.values(), *self.parents, *(each for above in self.parents.values() for each in above)}
        edges: dict[str, set[str]] = {name: set() for name in (*names, ROOT)}
        for name in names:
            for above in self.parents.get(name, ()) or (ROOT,):
                edges[name].add(above)
                edges[above].add(name)
        paths: dict[str, dict[str, int]] = {}
        for name in edges:
            paths[name] = {name: 0}
            for place in (queue := [name]):
                for near in sorted(edges[place]):
                    if near not in paths[name]:
                        paths[name][near] = paths[name][place] + 1
                        queue.append(near)
        return paths

    @cached_property
    def diameter(self) -> int:
        """The number of edges between entities of the classes that are farthest apart."""
        longest = max((max(lengths.values()) for name, lengths in self._paths.items() if name != ROOT), default=0)
        return max(2 + longest, LEAST_DIAMETER)

    def entity_distance(self, one: str, other: str) -> Fraction:
        """Return the distance between two entities, from 0 to 1."""
        if one == other:
            return Fraction(0)
        return Fraction(2 + self._paths[self.classes[one]][self.classes[other]], self.diameter)

    def common_class(self, one: str, other: str) -> str:
        """Return the lowest class that contains both entities, or "" if only the root does; both must have a class."""
        above, others = self._above(self.classes[one]), self._above(self.classes[other])
        return min({*above} & {*others}, key=lambda name: (above[name] + others[name], name))

    def _above(self, name: str) -> dict[str, int]:
        """Return a class and all its superclasses, with the numbers of edges that lead to them."""
        above = {name: 0}
        for place in (queue := [name]):
            for parent in self.parents.get(place, ()) or (() if place == ROOT else (ROOT,)):
                if parent not in above:
                    above[parent] = above[place] + 1
                    queue.append(parent)
        return above

    def atom_distance(self, one: Atom, other: Atom) -> Fraction:
        """Return the mean distance between the arguments of two actions or facts, or 1 if names or arities differ."""
        if one == other:
            return Fraction(0)
        if one.name != other.name or len(one.arguments) != len(other.arguments):
            return Fraction(1)
        distances = [self._term_distance(*pair) for pair in zip(one.arguments, other.arguments, strict=True)]
        return sum(distances, Fraction(0)) / len(distances)

    def _term_distance(self, one: str, other: str) -> Fraction:
        if one == other:
            return Fraction(0)
        if one in self.classes and other in self.classes:
            return self.entity_distance(one, other)
        if "(" in one and "(" in other and '"' not in one + other and not {one, other} & {*self.classes}:
            return self.atom_distance(parse_atom(one), parse_atom(other))
        return Fraction(1)
