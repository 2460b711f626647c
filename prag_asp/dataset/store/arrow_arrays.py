"""Arrow arrays built from Python values by way of buffers: `pyarrow.array` imports pandas where it is installed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import accumulate, chain
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

NUMBERS: Mapping[pa.DataType, str] = {pa.int32(): "i4", pa.int64(): "i8", pa.float64(): "f8"}
"""The NumPy type of each numeric Arrow type in the tables."""

LARGEST = 2**31 - 1
"""The most bytes of text, or items of lists, in a column: Arrow's offsets have 32 bits."""


def array_of(values: Sequence[Any], kind: pa.DataType) -> pa.Array:
    """Return an Arrow array of texts, truth values, numbers of `NUMBERS`, lists or mappings of these, or None."""
    is_valid = [value is not None for value in values]
    validity = None if all(is_valid) else bits(is_valid)
    if pa.types.is_list(kind):
        lists = values if validity is None else [value or () for value in values]
        items = array_of([*chain.from_iterable(lists)], kind.value_type)
        return lists_of(map(len, lists), items, kind, validity)
    if pa.types.is_struct(kind):
        rows = values if validity is None else [value or {} for value in values]
        children = [array_of([row.get(field.name) for row in rows], field.type) for field in kind]
        return pa.Array.from_buffers(kind, len(values), [validity], children=children)
    if pa.types.is_string(kind):
        return texts_of(values if validity is None else [value or "" for value in values], validity)
    if pa.types.is_boolean(kind):
        return pa.Array.from_buffers(kind, len(values), [validity, bits(values)])
    numbers = np.array(values if validity is None else [value or 0 for value in values], dtype=NUMBERS[kind])
    return pa.Array.from_buffers(kind, len(values), [validity, pa.py_buffer(numbers)])


def texts_of(texts: Sequence[str], validity: pa.Buffer | None = None) -> pa.Array:
    """Return an Arrow array of texts; `validity` is the bitmap of those that are not null."""
    encoded = [text.encode() for text in texts]
    buffers = [validity, offsets(map(len, encoded)), pa.py_buffer(b"".join(encoded))]
    return pa.Array.from_buffers(pa.string(), len(texts), buffers)


def lists_of(sizes: Iterable[int], items: pa.Array, kind: pa.DataType, validity: pa.Buffer | None = None) -> pa.Array:
    """Return an Arrow array of lists: consecutive runs of the items, of the given sizes."""
    begins = offsets(sizes)
    return pa.Array.from_buffers(kind, begins.size // 4 - 1, [validity, begins], children=[items])


def offsets(sizes: Iterable[int]) -> pa.Buffer:
    """Return the offset of each item, given their sizes, and the end of the last.

    Raises:
        OverflowError: their sum exceeds 32 bits.
    """
    ends = [*accumulate(sizes, initial=0)]
    if ends[-1] > LARGEST:
        raise OverflowError(f"{ends[-1]:,} bytes or items are too many for a column")
    return pa.py_buffer(np.array(ends, dtype="i4"))


def bits(truth: Sequence[Any] | NDArray[np.bool_]) -> pa.Buffer:
    """Return truth values as an Arrow bitmap; None counts as false."""
    return pa.py_buffer(np.packbits(np.array(truth, dtype=np.bool_), bitorder="little"))
