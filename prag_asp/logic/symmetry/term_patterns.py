"""Terms as patterns with slots for entities, so that renaming entities is arithmetic on arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import perm, prod

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.symmetry.renaming import Shapes
from prag_asp.logic.symmetry.symmetries import Unit

LARGEST_TABLE, LARGEST_CODE = 2**24, 2**62
NOBODY = -1


@dataclass(frozen=True)
class Patterns:
    """Terms, each as a pattern and the distinct units that it names, from left to right.

    A unit is called an entity here; an entity that is interchangeable on its own is a unit of one entity. `pattern` has
    shape (terms,); `entities` has a row for each term, padded with -1; `named` is the number of entities that each
    pattern names, and `places` is the total number of entities. The terms are `complete` if every renaming of a term
    that permutes the groups is a term again.
    """

    pattern: NDArray[np.int64]
    entities: NDArray[np.int64]
    named: NDArray[np.int64]
    places: int
    complete: bool

    @cached_property
    def arity(self) -> NDArray[np.int64]:
        """The number of entities that each term names, shape (terms,)."""
        return self.named[self.pattern]

    def find(self, pattern: NDArray[np.int64], entities: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the numbers of terms given as patterns, shape (m,), and entities, shape (m, most)."""
        codes = self._codes(pattern, entities)
        if self._table is not None:
            return self._table[codes]
        order, known = self._sorted
        return order[np.searchsorted(known, codes)]

    def _codes(self, pattern: NDArray[np.int64], entities: NDArray[np.int64]) -> NDArray[np.int64]:
        code = pattern
        for column in entities.T:
            code = code * (self.places + 1) + column + 1
        return code

    @cached_property
    def _table(self) -> NDArray[np.int64] | None:
        """The term for each code, or None if there are too many codes."""
        size = len(self.named) * (self.places + 1) ** self.entities.shape[1]
        if size > LARGEST_TABLE:
            return None
        table = np.full(size, NOBODY, dtype=np.int64)
        table[self._codes(self.pattern, self.entities)] = np.arange(len(self.pattern))
        return table

    @cached_property
    def _sorted(self) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
        codes = self._codes(self.pattern, self.entities)
        order = np.argsort(codes)
        return order, codes[order]


def read_patterns(terms: Sequence[clingo.Symbol], groups: Sequence[Sequence[Unit]]) -> Patterns | None:
    """Return terms as patterns, with the units of all groups numbered in order, or None if codes are too large."""
    units = [unit for group in groups for unit in group]
    group_of = [place for place, group in enumerate(groups) for _ in group]
    members = [(number, slot) for number, unit in enumerate(units) for slot in range(len(unit))]
    shapes = Shapes({entity: place for place, entity in enumerate(each for unit in units for each in unit)})
    kinds: dict[tuple[int, tuple[object, ...]], int] = {}
    signatures: list[tuple[int, ...]] = []
    named: list[list[int]] = []
    pattern = np.empty(len(terms), dtype=np.int64)
    for row, term in enumerate(terms):
        shape, entities = shapes.of(term)
        inside = [members[entity] for entity in entities]
        different = list(dict.fromkeys(number for number, _ in inside))
        signature = tuple(group_of[number] for number in different)
        kind = (shape, (*((different.index(number), slot) for number, slot in inside), *signature))
        if kind not in kinds:
            kinds[kind] = len(kinds)
            signatures.append(signature)
        pattern[row] = kinds[kind]
        named.append(different)
    table = np.full((len(terms), max(map(len, named), default=0)), NOBODY, dtype=np.int64)
    for row, different in enumerate(named):
        table[row, : len(different)] = different
    if len(kinds) * (len(units) + 1) ** table.shape[1] > LARGEST_CODE:
        return None
    # The number of ways to name distinct units, the i-th of which is from group ``signature[i]``.
    numbers_of_renamings = [
        prod(perm(len(group), signature.count(place)) for place, group in enumerate(groups)) for signature in signatures
    ]
    complete = np.bincount(pattern, minlength=len(kinds)).tolist() == numbers_of_renamings
    return Patterns(pattern, table, np.array([*map(len, signatures)], dtype=np.int64), len(units), complete)
