"""Terms as patterns with places for entities, so that renaming entities is arithmetic on arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import perm, prod

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.symmetry.renaming import Shapes

LARGEST_TABLE, LARGEST_CODE = 2**24, 2**62
NOBODY = -1


@dataclass(frozen=True)
class Patterns:
    """Terms, each as a pattern and the different entities that it names, from the left.

    `pattern` has shape (terms,); `entities` has shape (terms, most entities in a term), filled up with -1; `named`
    is how many entities each pattern names, `places` the number of entities in all. They are `complete` where every
    renaming of a term that permutes the groups is a term again.
    """

    pattern: NDArray[np.int64]
    entities: NDArray[np.int64]
    named: NDArray[np.int64]
    places: int
    complete: bool

    @cached_property
    def arity(self) -> NDArray[np.int64]:
        """How many entities each term names, shape (terms,)."""
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
        """The term of each code, where there are not too many codes."""
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


def read_patterns(terms: Sequence[clingo.Symbol], groups: Sequence[Sequence[clingo.Symbol]]) -> Patterns | None:
    """Return terms as patterns, with the entities of all groups numbered in order; None where codes grow too large."""
    number = {entity: place for place, entity in enumerate(e for group in groups for e in group)}
    group_of = [place for place, group in enumerate(groups) for _ in group]
    shapes = Shapes(number)
    kinds: dict[tuple[int, tuple[int, ...]], int] = {}
    signatures: list[tuple[int, ...]] = []
    named: list[list[int]] = []
    pattern = np.empty(len(terms), dtype=np.int64)
    for row, term in enumerate(terms):
        shape, entities = shapes.of(term)
        different = list(dict.fromkeys(entities))
        signature = tuple(group_of[entity] for entity in different)
        kind = (shape, (*(different.index(entity) for entity in entities), -1, *signature))
        if kind not in kinds:
            kinds[kind] = len(kinds)
            signatures.append(signature)
        pattern[row] = kinds[kind]
        named.append(different)
    table = np.full((len(terms), max(map(len, named), default=0)), NOBODY, dtype=np.int64)
    for row, different in enumerate(named):
        table[row, : len(different)] = different
    if len(kinds) * (len(number) + 1) ** table.shape[1] > LARGEST_CODE:
        return None
    sizes = [len(group) for group in groups]
    wanted = [_renamings(signature, sizes) for signature in signatures]
    complete = np.bincount(pattern, minlength=len(kinds)).tolist() == wanted
    return Patterns(pattern, table, np.array([*map(len, signatures)], dtype=np.int64), len(number), complete)


def _renamings(signature: tuple[int, ...], sizes: Sequence[int]) -> int:
    """Return the number of ways to name different entities, of which the i-th is from group ``signature[i]``."""
    return prod(perm(size, signature.count(group)) for group, size in enumerate(sizes))
