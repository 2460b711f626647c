"""Compute the distances between all pairs of features, block by block in arrays of small integers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from prag_asp.similarity.edit_arrays import aligned_distances, small_type, unit_edit_distances, weighted_edit_distances
from prag_asp.similarity.edit_costs import Cost, CostTable
from prag_asp.similarity.edits import check_lengths
from prag_asp.similarity.features import Feature
from prag_asp.similarity.string_distances import StringDistance, spelled
from prag_asp.similarity.symbols import Symbol

Numbers = NDArray[np.intp]
"""Indices of features."""

Values = NDArray[Any]
"""Distances, as integers in some unit or as floats."""


CACHED = (128, 256)
"""The shape of blocks whose arrays, with two bytes for each pair, remain in the cache of a core."""

MULTIPLIED = (1024, 2048)
"""The shape of blocks that are products of matrices; large blocks convert their rows and columns less often."""


class DistanceTable(Protocol):
    """Distances between all pairs of a list of features; `denominator` is 0 if they are floats and not exact."""

    @property
    def denominator(self) -> int:
        """The number of units in a distance of 1."""
        ...

    @property
    def largest(self) -> int:
        """An upper bound on all distances, in units."""
        ...

    @property
    def shape(self) -> tuple[int, int]:
        """The shape (rows, columns) of a block that is computed efficiently."""
        ...

    def block(self, rows: Numbers, columns: Numbers) -> Values:
        """Return the distances between two lists of features, shape (rows, columns), in units."""
        ...

    def normalised(self, block: Values, rows: Numbers, columns: Numbers) -> NDArray[np.float32]:
        """Return the distances of a block, scaled to between 0 and 1."""
        ...


@dataclass(frozen=True)
class CodedSequences:
    """Sequences of symbol codes, shape (sequences, longest length); row i holds `lengths[i]` codes, then padding."""

    codes: Numbers
    lengths: NDArray[np.int64]

    def pairs(
        self, rows: Numbers, columns: Numbers, function: Callable[[Numbers, Numbers], Values], kind: type
    ) -> Values:
        """Return `function` of all pairs of sequences; in each array that it gets, all sequences are equally long."""
        result: Values = np.empty((len(rows), len(columns)), kind)
        for length in np.unique(self.lengths[rows]):
            here = np.flatnonzero(self.lengths[rows] == length)
            for width in np.unique(self.lengths[columns]):
                there = np.flatnonzero(self.lengths[columns] == width)
                block = function(self.codes[rows[here], :length], self.codes[columns[there], :width])
                if block.shape == result.shape:
                    return block.astype(kind, copy=False)
                result[np.ix_(here, there)] = block
        return result

    def sums(self, values: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the sum of the values of the symbols in each sequence; `values` is indexed by code."""
        counted = np.arange(self.codes.shape[1]) < self.lengths[:, None]
        total: NDArray[np.int64] = np.where(counted, values[self.codes], 0).sum(axis=1)
        return total


def coded(features: Sequence[Feature]) -> tuple[tuple[Symbol, ...], CodedSequences]:
    """Return the distinct symbols in the given features, and the features as sequences of symbol codes."""
    numbers: dict[Symbol, int] = {}
    lengths = np.array(list(map(len, features)), dtype=np.int64)
    codes = np.zeros((len(features), max(lengths.max(initial=0), 0)), dtype=np.intp)
    for row, feature in zip(codes, features, strict=True):
        row[: len(feature)] = [numbers.setdefault(each, len(numbers)) for each in feature]
    return tuple(numbers), CodedSequences(codes, lengths)


def steinhaus_block(block: Values, one: Values, other: Values) -> NDArray[np.float32]:
    """Return the Steinhaus transform of a block, given the distances of its rows and columns from the empty feature."""
    distances = block.astype(np.float32)
    total = one.astype(np.float32)[:, None] + other.astype(np.float32) + distances
    result: NDArray[np.float32] = np.divide(2 * distances, total, out=np.zeros_like(distances), where=distances > 0)
    return result


@dataclass(frozen=True)
class EditTable:
    """Edit distances; `sizes` holds the cost of deleting all symbols of each feature, in units."""

    costs: CostTable
    codes: CodedSequences
    sizes: NDArray[np.int64]
    shape: tuple[int, int] = CACHED

    @classmethod
    def of(cls, features: Sequence[Feature], cost: Cost) -> EditTable:
        """Return the table for the given features."""
        symbols, codes = coded(features)
        costs = CostTable.of(symbols, cost)
        return cls(costs, codes, codes.sums(costs.costs[-1]))

    @property
    def denominator(self) -> int:
        """The number of units in a cost of 1."""
        return self.costs.denominator

    @property
    def largest(self) -> int:
        """The cost of deleting and inserting the two largest features."""
        return 2 * int(self.sizes.max(initial=0))

    def block(self, rows: Numbers, columns: Numbers) -> Values:
        """Return the distances in units."""
        costs, kind = self.costs, small_type(self.largest)
        if costs.uniform:
            symbols = len(costs.symbols)
            return self.codes.pairs(rows, columns, lambda a, b: unit_edit_distances(a, b, symbols), kind)
        return self.codes.pairs(rows, columns, lambda a, b: weighted_edit_distances(a, b, costs.costs), kind)

    def normalised(self, block: Values, rows: Numbers, columns: Numbers) -> NDArray[np.float32]:
        """Return the Steinhaus transform."""
        return steinhaus_block(block, self.sizes[rows], self.sizes[columns])


@dataclass(frozen=True)
class PlaceTable:
    """Position-by-position distances between sequences of the same length; `codes` has shape (features, length)."""

    costs: CostTable
    codes: Numbers
    shape: tuple[int, int] = CACHED

    @classmethod
    def of(cls, features: Sequence[Feature], cost: Cost) -> PlaceTable:
        """Return the table for the given features.

        Raises:
            QueryError: the features have different lengths.
        """
        check_lengths({len(each) for each in features})
        symbols, codes = coded(features)
        return cls(CostTable.of(symbols, cost), codes.codes)

    @property
    def denominator(self) -> int:
        """The number of units in a cost of 1."""
        return self.costs.denominator

    @property
    def largest(self) -> int:
        """The highest cost of a replacement times the length, in units."""
        return int(self.costs.costs.max()) * int(self.codes.shape[1])

    def block(self, rows: Numbers, columns: Numbers) -> Values:
        """Return the distances in units."""
        return aligned_distances(self.codes[rows], self.codes[columns], self.costs.costs)

    def normalised(self, block: Values, rows: Numbers, columns: Numbers) -> NDArray[np.float32]:
        """Return the mean cost per position."""
        values: NDArray[np.float32] = block.astype(np.float32) / np.float32(
            max(self.codes.shape[1], 1) * self.denominator
        )
        return values


@dataclass(frozen=True)
class StateTable:
    """Edit distances between sequences of states, whose costs are computed only for the states in each block.

    `members[i, j]` is true if state i contains fact j, shape (states, facts).
    """

    members: NDArray[np.bool_]
    codes: CodedSequences
    denominator: int = 1
    shape: tuple[int, int] = CACHED

    @classmethod
    def of(cls, features: Sequence[Feature]) -> StateTable:
        """Return the table for the given features."""
        states, codes = coded(features)
        return cls(SetTable.of([tuple(state) for state in states]).members, codes)

    @cached_property
    def sizes(self) -> NDArray[np.int64]:
        """The cost of deleting each feature."""
        return self.codes.sums(1 + self.members.sum(axis=1, dtype=np.int64))

    @property
    def largest(self) -> int:
        """The cost of deleting and inserting the two largest features."""
        return 2 * int(self.sizes.max(initial=0))

    def block(self, rows: Numbers, columns: Numbers) -> Values:
        """Return the distances."""
        states = [np.unique(self.codes.codes[side]) for side in (rows, columns)]
        one, other = (self.members[each].astype(np.float32) for each in states)
        sizes, others = one.sum(axis=1), other.sum(axis=1)
        costs = np.zeros((len(one) + 1, len(other) + 1), dtype=np.int64)
        costs[:-1, :-1] = sizes[:, None] + others - 2 * (one @ other.T)
        costs[:-1, -1], costs[-1, :-1] = 1 + sizes, 1 + others
        first, second = states

        def distances(some: Numbers, more: Numbers) -> Values:
            return weighted_edit_distances(np.searchsorted(first, some), np.searchsorted(second, more), costs)

        return self.codes.pairs(rows, columns, distances, small_type(self.largest))

    def normalised(self, block: Values, rows: Numbers, columns: Numbers) -> NDArray[np.float32]:
        """Return the Steinhaus transform."""
        return steinhaus_block(block, self.sizes[rows], self.sizes[columns])


@dataclass(frozen=True)
class SetTable:
    """Sizes of symmetric differences between sets; `members` has shape (features, elements)."""

    members: NDArray[np.bool_]
    denominator: int = 1
    shape: tuple[int, int] = MULTIPLIED

    @cached_property
    def sizes(self) -> NDArray[np.int64]:
        """The number of elements in each set."""
        sizes: NDArray[np.int64] = self.members.sum(axis=1, dtype=np.int64)
        return sizes

    @classmethod
    def of(cls, features: Sequence[Feature]) -> SetTable:
        """Return the table for the given features."""
        elements, codes = coded(features)
        members = np.zeros((len(features), len(elements)), dtype=np.bool_)
        for row, each, length in zip(members, codes.codes, codes.lengths, strict=True):
            row[each[:length]] = True
        return cls(members)

    @property
    def largest(self) -> int:
        """Twice the number of elements in the largest set."""
        return 2 * int(self.sizes.max(initial=0))

    def block(self, rows: Numbers, columns: Numbers) -> Values:
        """Return the sizes of the symmetric differences; products of 32-bit floats are exact for counts up to 2**24."""
        one = self.members[rows]
        shared = np.flatnonzero(one.any(axis=0))
        common = (
            one.take(shared, axis=1).astype(np.float32)
            @ self.members[columns].take(shared, axis=1).astype(np.float32).T
        )
        values: Values = self.sizes[rows][:, None] + self.sizes[columns] - 2 * common
        return values.astype(small_type(self.largest))

    def normalised(self, block: Values, rows: Numbers, columns: Numbers) -> NDArray[np.float32]:
        """Return the Jaccard distances."""
        return steinhaus_block(block, self.sizes[rows], self.sizes[columns])


@dataclass(frozen=True)
class StringTable:
    """Distances between texts; if `bounded`, they are floats between 0 and 1."""

    texts: list[str]
    function: StringDistance
    bounded: bool
    shape: tuple[int, int] = CACHED

    @classmethod
    def of(cls, features: Sequence[Feature], function: StringDistance, *, bounded: bool) -> StringTable:
        """Return the table for the given features."""
        return cls(spelled(*features), function, bounded)

    @property
    def denominator(self) -> int:
        """0 for floats, and 1 otherwise."""
        return 0 if self.bounded else 1

    @property
    def largest(self) -> int:
        """Twice the length of the longest text, or 1 if `bounded`."""
        return 1 if self.bounded else 2 * max(map(len, self.texts), default=0)

    def block(self, rows: Numbers, columns: Numbers) -> Values:
        """Return the distances."""
        kind = np.float32 if self.bounded else small_type(self.largest)
        others = [self.texts[at] for at in columns]
        return np.array([[self.function(self.texts[at], text) for text in others] for at in rows], dtype=kind).reshape(
            len(rows), len(columns)
        )

    def normalised(self, block: Values, rows: Numbers, columns: Numbers) -> NDArray[np.float32]:
        """Return the distances themselves, or the Steinhaus transform of numbers of edits."""
        if self.bounded:
            return block.astype(np.float32)
        sizes = np.array(list(map(len, self.texts)), dtype=np.int64)
        return steinhaus_block(block, sizes[rows], sizes[columns])


@dataclass(frozen=True)
class MixedTable:
    """Weighted means of the normalised distances of several tables of the same features."""

    parts: tuple[tuple[float, DistanceTable], ...]
    denominator: int = 0
    largest: int = 1
    shape: tuple[int, int] = CACHED

    def block(self, rows: Numbers, columns: Numbers) -> Values:
        """Return the weighted means."""
        blocks = (w * table.normalised(table.block(rows, columns), rows, columns) for w, table in self.parts)
        values: Values = np.array(list(blocks)).sum(axis=0, dtype=np.float32)
        return values

    def normalised(self, block: Values, rows: Numbers, columns: Numbers) -> NDArray[np.float32]:
        """Return the distances themselves."""
        return block.astype(np.float32)
