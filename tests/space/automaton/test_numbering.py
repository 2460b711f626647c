"""Rows of words are numbered exactly, whatever they hash to."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp.space.automaton import numbering
from prag_asp.space.automaton.numbering import Numbering

ROWS = st.lists(st.tuples(st.integers(0, 3), st.integers(0, 2**64 - 1) | st.integers(0, 2)), max_size=40)


def numbered(batches: list[list[tuple[int, int]]]) -> None:
    table, known = Numbering(2), {}
    for batch in batches:
        rows = np.array(batch, dtype=np.uint64).reshape(-1, 2)
        expected = [known.setdefault(row, len(known)) for row in batch]
        assert table.add(rows).tolist() == expected
    assert len(table) == len(known)
    assert list(map(tuple, table.rows.tolist())) == list(known)


@given(st.lists(ROWS, max_size=6))
def test_rows_are_numbered_as_a_dictionary_numbers_them(batches: list[list[tuple[int, int]]]) -> None:
    numbered(batches)


def test_rows_that_all_hash_alike_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numbering, "_hash", lambda rows: np.full(len(rows), 7, dtype=np.uint64))
    numbered([[(i % 5, i) for i in range(30)], [(1, 1), (3, 3), (1, 2)], [(i % 2, i) for i in range(40)]])


def test_a_table_that_grows_many_times_keeps_its_numbers() -> None:
    table = Numbering(1)
    for start in range(0, 60_000, 7_000):
        values = np.arange(start, start + 10_000, dtype=np.uint64)[:, None] * np.uint64(2**40 + 1)
        assert table.add(values).tolist() == list(range(start, start + 10_000))
    assert len(table) == 66_000 and table.nbytes < 10**7
