"""A numbering of rows of 64-bit words: a vectorised hash table with open addressing that compares whole rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.packed import Rows

EMPTY = -1
SMALLEST = 1024
FULLEST = 0.5
"""Maximum load factor, above which probing becomes slow."""

MULTIPLIER = np.uint64(0x9E3779B97F4A7C15)
SHIFT = np.uint64(32)


class Numbering:
    """Distinct rows, numbered from 0 in the order of their first occurrence."""

    def __init__(self, words: int) -> None:
        self._rows = np.zeros((SMALLEST, words), dtype=np.uint64)
        self._size = 0
        self._table = np.full(2 * SMALLEST, EMPTY, dtype=np.int64)

    def __len__(self) -> int:
        return self._size

    @property
    def rows(self) -> Rows:
        """All rows, in order of their numbers, shape (size, words)."""
        return self._rows[: self._size]

    @property
    def nbytes(self) -> int:
        """The memory in use, in bytes."""
        return self._rows.nbytes + self._table.nbytes

    def add(self, rows: Rows) -> NDArray[np.int64]:
        """Return the number of each row, shape (number of rows,); a new row gets the next number."""
        self._make_slots(self._size + len(rows))
        mask = len(self._table) - 1
        numbers = np.empty(len(rows), dtype=np.int64)
        size = self._size
        waiting = np.arange(len(rows))
        slots = (_hash(rows) & np.uint64(mask)).astype(np.int64)
        first_seen: list[NDArray[np.int64]] = []
        taken: list[NDArray[np.int64]] = []
        while len(waiting):
            occupants = self._table[slots]
            empty = np.flatnonzero(occupants == EMPTY)
            if len(empty):
                # Rows are assigned in reverse order: NumPy keeps the last assignment, so the first row that claims a
                # slot gets it.
                last_first = empty[::-1]
                self._table[slots[last_first]] = size + waiting[last_first]
                occupants[empty] = self._table[slots[empty]]
                won = empty[occupants[empty] == size + waiting[empty]]
                first_seen.append(waiting[won])
                taken.append(slots[won])
            numbers[waiting] = occupants
            differs = self._differs(occupants, rows, waiting, size)
            waiting = waiting[differs]
            slots = (slots[differs] + 1) & mask
        if first_seen:
            self._settle(rows, numbers, np.concatenate(first_seen), np.concatenate(taken))
        return numbers

    def _differs(
        self, occupants: NDArray[np.int64], rows: Rows, waiting: NDArray[np.int64], size: int
    ) -> NDArray[np.bool_]:
        """Return which waiting rows differ from the row in their slot; numbers from `size` on index `rows`."""
        result = np.empty(len(occupants), dtype=np.bool_)
        old = occupants < size
        result[old] = (self._rows[occupants[old]] != rows[waiting[old]]).any(axis=1)
        new = ~old
        result[new] = (rows[occupants[new] - size] != rows[waiting[new]]).any(axis=1)
        return result

    def _settle(
        self, rows: Rows, numbers: NDArray[np.int64], fresh: NDArray[np.int64], slots: NDArray[np.int64]
    ) -> None:
        """Assign numbers to the new rows, in the order of `rows`."""
        order = np.argsort(fresh)
        size, fresh = self._size, fresh[order]
        final = np.zeros(len(rows), dtype=np.int64)
        final[fresh] = size + np.arange(len(fresh))
        self._table[slots[order]] = final[fresh]
        new = numbers >= size
        numbers[new] = final[numbers[new] - size]
        self._size = size + len(fresh)
        if self._size > len(self._rows):
            larger = np.zeros((max(self._size, 2 * size), self._rows.shape[1]), dtype=np.uint64)
            larger[:size] = self._rows[:size]
            self._rows = larger
        self._rows[size : self._size] = rows[fresh]

    def _make_slots(self, size: int) -> None:
        """Make the table large enough for a given number of rows."""
        slots = len(self._table)
        while size > FULLEST * slots:
            slots *= 2
        if slots == len(self._table):
            return
        self._table = np.full(slots, EMPTY, dtype=np.int64)
        waiting, mask = np.arange(self._size), slots - 1
        places = (_hash(self.rows) & np.uint64(mask)).astype(np.int64)
        while len(waiting):
            free = self._table[places] == EMPTY
            self._table[places[free]] = waiting[free]
            left = self._table[places] != waiting
            waiting, places = waiting[left], (places[left] + 1) & mask


def _hash(rows: Rows) -> NDArray[np.uint64]:
    """Return a hash for each row, shape (number of rows,), by Fibonacci hashing (Knuth, TAOCP 3, 6.4), word by word."""
    mixed = np.zeros(len(rows), dtype=np.uint64)
    for word in rows.T:
        mixed = (mixed ^ word) * MULTIPLIER
        mixed ^= mixed >> SHIFT
    return mixed
