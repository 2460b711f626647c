"""The truth of atoms in many states, one integer for each atom: bit i is the truth in state i.

On integers, ``&`` and ``|`` take a fraction of the time that they take on arrays of bools, of a few states above all.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.bool_]
"""The truth of one atom in many states: shape (number of states,)."""


def all_true(size: int) -> int:
    """Return the bits of an atom that is true in each of `size` states."""
    return (1 << size) - 1


def bits_of(column: Column) -> int:
    """Return a column as an integer."""
    return int.from_bytes(np.packbits(column, bitorder="little").tobytes(), "little")


def each_bits(columns: NDArray[np.bool_]) -> Iterator[int]:
    """Yield the columns of several atoms, shape (atoms, states), as integers."""
    for octets in np.packbits(columns, axis=1, bitorder="little"):
        yield int.from_bytes(octets.tobytes(), "little")


def column_of(bits: int, size: int) -> Column:
    """Return an integer as the column of `size` states."""
    octets = np.frombuffer(bits.to_bytes(-(-size // 8), "little"), dtype=np.uint8)
    return np.unpackbits(octets, count=size, bitorder="little").view(np.bool_)


def columns_of(bits: Iterable[int], size: int) -> NDArray[np.bool_]:
    """Return several integers as the columns of `size` states, shape (integers, size)."""
    width = -(-size // 8)
    parts = [each.to_bytes(width, "little") for each in bits]
    octets = np.frombuffer(b"".join(parts), dtype=np.uint8).reshape(len(parts), width)
    return np.unpackbits(octets, axis=1, count=size, bitorder="little").view(np.bool_)
