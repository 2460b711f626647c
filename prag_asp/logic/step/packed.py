"""States packed into 64-bit words, one row for each state: bit v of a row is the value of variable v."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.uint64]
"""Packed states, shape (number of states, number of words)."""

WORD = 64
LITTLE = np.dtype("<u8")

MANY = 256
"""The number of states from which it is faster to transpose octets and then split them into bits than to do the
opposite: with 3000 states, it takes a tenth of the time."""


def words_for(bits: int) -> int:
    """Return the number of words, at least one, that hold a given number of bits."""
    return max(-(-bits // WORD), 1)


def pack(columns: NDArray[np.bool_]) -> Rows:
    """Return states, given as columns of shape (number of variables, number of states), as packed rows."""
    bits, size = columns.shape
    octets = np.zeros((size, 8 * words_for(bits)), dtype=np.uint8)
    packed = np.packbits(columns, axis=0, bitorder="little")
    octets[:, : len(packed)] = packed.T
    return octets.view(LITTLE).astype(np.uint64, copy=False)


def unpack(rows: Rows, bits: int) -> NDArray[np.bool_]:
    """Return packed states as columns, shape (number of variables, number of states)."""
    octets = np.ascontiguousarray(rows, dtype=LITTLE).view(np.uint8)
    if len(rows) < MANY:
        return np.ascontiguousarray(np.unpackbits(octets, axis=1, count=bits, bitorder="little").T).view(np.bool_)
    octets = np.ascontiguousarray(octets[:, : -(-bits // 8)].T)
    columns = np.empty((len(octets), 8, len(rows)), dtype=np.uint8)
    for bit in range(8):
        np.bitwise_and(octets >> bit, 1, out=columns[:, bit])
    return columns.reshape(-1, len(rows))[:bits].view(np.bool_)


def mask_of(places: list[int], words: int) -> Rows:
    """Return the words in which exactly the given bits are set, shape (number of words,)."""
    mask = [0] * words
    for place in places:
        mask[place // WORD] |= 1 << place % WORD
    return np.array(mask, dtype=np.uint64)
