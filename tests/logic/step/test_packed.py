"""Packed states have the bits that they are packed from, with few states and with many."""

from __future__ import annotations

import numpy as np
import pytest

from prag_asp.logic.step.packed import MANY, WORD, pack, unpack, words_for


@pytest.mark.parametrize("states", [0, 1, MANY - 1, MANY, 3 * MANY + 5])
@pytest.mark.parametrize("bits", [0, 1, 7, 8, 63, 64, 65, 130])
def test_columns_have_the_bits_of_the_words(states: int, bits: int) -> None:
    rows = np.random.default_rng(bits).integers(0, 2**64, (states, words_for(bits)), dtype=np.uint64)
    columns = unpack(rows, bits)
    assert columns.dtype == np.bool_ and columns.shape == (bits, states) and columns.flags.c_contiguous
    values = [[int(word) for word in row] for row in rows]
    for place in range(bits):
        word, shift = divmod(place, WORD)
        assert columns[place].tolist() == [bool(row[word] >> shift & 1) for row in values]
    assert np.array_equal(unpack(pack(columns), bits), columns)
