"""Edit distances between all pairs of two lists of coded sequences, in NumPy.

Sequences of the same length are the rows of an array of codes. All functions return an array of shape (rows, columns).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.intp]
Distances = NDArray[np.unsignedinteger]

WORDS = (np.uint8, np.uint16, np.uint32, np.uint64)
"""Unsigned integer types, smallest first; NumPy is faster with smaller types."""


def small_type(largest: int) -> type[np.unsignedinteger]:
    """Return the smallest type that holds the integers from 0 to `largest`."""
    return next(word for word in WORDS if largest <= np.iinfo(word).max)


def weighted_edit_distances(rows: Codes, columns: Codes, costs: NDArray[np.int64]) -> Distances:
    """Return edit distances with costs (Wagner and Fischer 1974), for all pairs at once, cell by cell of the table.

    `costs` has the shape (symbols of rows + 1, symbols of columns + 1); the last row and column hold the costs of
    insertions and deletions.
    """
    length, width = rows.shape[1], columns.shape[1]
    kind = small_type(int((length + width + 1) * max(int(costs.max()), 1)))
    by_place = [np.ascontiguousarray(costs[:-1, columns[:, place]].astype(kind)) for place in range(width)]
    row_gaps, column_gaps = costs[rows, -1].astype(kind)[:, :, None], costs[-1, columns].astype(kind)
    shape = (len(rows), len(columns))
    before = [np.zeros(shape, kind)]
    for place in range(width):
        before.append(before[-1] + column_gaps[:, place])
    now, spare = [np.empty(shape, kind) for _ in range(width + 1)], np.empty(shape, kind)
    for step in range(length):
        np.add(before[0], row_gaps[:, step], out=now[0])
        for place in range(width):
            cell = now[place + 1]
            np.take(by_place[place], rows[:, step], axis=0, out=cell)
            np.add(cell, before[place], out=cell)
            np.add(before[place + 1], row_gaps[:, step], out=spare)
            np.minimum(cell, spare, out=cell)
            np.add(now[place], column_gaps[:, place], out=spare)
            np.minimum(cell, spare, out=cell)
        before, now = now, before
    return before[-1]


def unit_edit_distances(rows: Codes, columns: Codes, symbols: int) -> Distances:
    """Return Levenshtein distances with unit costs, using bit vectors (Myers 1999, as in Hyyrö 2003).

    A bit of `up` or `down` is set if the table grows or shrinks by 1 from one row to the next; the distance is the
    width plus the difference of the numbers of bits in the last column. Sequences with more than 64 symbols, the bits
    of a word, are compared by `weighted_edit_distances`.
    """
    length, width = rows.shape[1], columns.shape[1]
    if not 0 < length <= 64:
        return weighted_edit_distances(rows, columns, 1 - np.eye(symbols + 1, dtype=np.int64))
    kind = small_type((1 << length) - 1)
    matches = np.zeros((symbols, len(rows)), kind)
    for step in range(length):
        matches[rows[:, step], np.arange(len(rows))] |= kind(1 << step)
    shape = (len(columns), len(rows))
    one, mask = kind(1), kind((1 << length) - 1)
    up, down = np.full(shape, mask), np.zeros(shape, kind)
    equal, diagonal, across = np.empty(shape, kind), np.empty(shape, kind), np.empty(shape, kind)
    for place in range(width):
        np.take(matches, columns[:, place], axis=0, out=equal)
        np.bitwise_and(equal, up, out=diagonal)
        np.add(diagonal, up, out=diagonal)
        np.bitwise_xor(diagonal, up, out=diagonal)
        np.bitwise_or(diagonal, equal, out=diagonal)
        np.bitwise_or(diagonal, down, out=diagonal)
        np.bitwise_or(diagonal, up, out=across)  # where a row grows: down | ~(diagonal | up)
        np.invert(across, out=across)
        np.bitwise_or(across, down, out=across)
        np.bitwise_and(diagonal, up, out=up)  # where a row shrinks
        np.left_shift(across, one, out=across)
        np.bitwise_or(across, one, out=across)
        np.left_shift(up, one, out=up)
        np.bitwise_and(across, diagonal, out=down)
        np.bitwise_or(across, diagonal, out=across)
        np.invert(across, out=across)
        np.bitwise_or(up, across, out=up)
    ups, downs = _bit_counts(up & mask), _bit_counts(down & mask)
    distances: Distances = (small_type(length + width)(width) + ups - downs).T
    return distances


def _bit_counts(words: NDArray[np.unsignedinteger]) -> NDArray[np.uint8]:
    """Return the number of bits set in each word."""
    if hasattr(np, "bitwise_count"):
        counts: NDArray[np.uint8] = np.bitwise_count(words)
        return counts
    octets = words.view(np.uint8).reshape(*words.shape, -1)
    summed: NDArray[np.uint8] = np.unpackbits(octets, axis=-1).sum(axis=-1, dtype=np.uint8)
    return summed


def aligned_distances(rows: Codes, columns: Codes, costs: NDArray[np.int64]) -> Distances:
    """Return the sum of the costs over all positions; all sequences must have the same length."""
    kind = small_type(int(max(rows.shape[1], 1) * max(int(costs.max()), 1)))
    total, spare = (np.zeros((len(rows), len(columns)), kind) for _ in range(2))
    for place in range(rows.shape[1]):
        table = np.ascontiguousarray(costs[:-1, columns[:, place]].astype(kind))
        np.take(table, rows[:, place], axis=0, out=spare)
        np.add(total, spare, out=total)
    return total
