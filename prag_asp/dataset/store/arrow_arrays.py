"""Arrow arrays of Python's values, from buffers: `pyarrow.array` imports pandas first, wherever that is installed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import accumulate, chain
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

NUMBERS: Mapping[pa.DataType, str] = {pa.int32(): "i4", pa.int64(): "i8", pa.float64(): "f8"}
"""The kinds of numbers in tables, and what NumPy calls them."""

LARGEST = 2**31 - 1
"""Bytes of texts, and items of lists, that Arrow counts by 32 bits."""


def array_of(values: Sequence[Any], kind: pa.DataType) -> pa.Array:
    """Return values as Arrow has them: texts, truth, numbers of `NUMBERS`, lists and mappings of them, or None."""
    there = [value is not None for value in values]
    known = None if all(there) else bits(there)
    if pa.types.is_list(kind):
        lists = values if known is None else [value or () for value in values]
        items = array_of([*chain.from_iterable(lists)], kind.value_type)
        return lists_of(map(len, lists), items, kind, known)
    if pa.types.is_struct(kind):
        rows = values if known is None else [value or {} for value in values]
        children = [array_of([row.get(field.name) for row in rows], field.type) for field in kind]
        return pa.Array.from_buffers(kind, len(values), [known], children=children)
    if pa.types.is_string(kind):
        return texts_of(values if known is None else [value or "" for value in values], known)
    if pa.types.is_boolean(kind):
        return pa.Array.from_buffers(kind, len(values), [known, bits(values)])
    numbers = np.array(values if known is None else [value or 0 for value in values], dtype=NUMBERS[kind])
    return pa.Array.from_buffers(kind, len(values), [known, pa.py_buffer(numbers)])


def texts_of(texts: Sequence[str], known: pa.Buffer | None = None) -> pa.Array:
    """Return texts as Arrow has them."""
    encoded = [text.encode() for text in texts]
    buffers = [known, offsets(map(len, encoded)), pa.py_buffer(b"".join(encoded))]
    return pa.Array.from_buffers(pa.string(), len(texts), buffers)


def lists_of(sizes: Iterable[int], items: pa.Array, kind: pa.DataType, known: pa.Buffer | None = None) -> pa.Array:
    """Return items as lists of some sizes in a row."""
    begins = offsets(sizes)
    return pa.Array.from_buffers(kind, begins.size // 4 - 1, [known, begins], children=[items])


def offsets(sizes: Iterable[int]) -> pa.Buffer:
    """Return where each of some lengths begins, and where the last one ends.

    Raises:
        OverflowError: they are more together than Arrow counts.
    """
    ends = [*accumulate(sizes, initial=0)]
    if ends[-1] > LARGEST:
        raise OverflowError(f"{ends[-1]:,} bytes or items are too many for a column")
    return pa.py_buffer(np.array(ends, dtype="i4"))


def bits(truth: Sequence[Any] | NDArray[np.bool_]) -> pa.Buffer:
    """Return truth values as the bits that Arrow has for them; what is not known counts as false."""
    return pa.py_buffer(np.packbits(np.array(truth, dtype=np.bool_), bitorder="little"))
