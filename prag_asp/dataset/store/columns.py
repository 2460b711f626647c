"""Build Arrow columns from rows; rows are stored as flat arrays because a task has hundreds of facts.

Arrays are built from Python values via buffers, because `pyarrow.array` imports pandas if it is installed.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping, Sequence
from itertools import accumulate, chain
from typing import Any, NamedTuple, Protocol

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from prag_asp.atom import Atom
from prag_asp.dataset.store.schema import FACTS, SCHEMAS
from prag_asp.task import FrozenDict

TOGETHER = 256
"""The number of rows buffered as Python lists before they are packed as Arrow arrays, which take much less memory."""

NUMBERS: Mapping[pa.DataType, str] = {pa.int32(): "i4", pa.int64(): "i8", pa.float64(): "f8"}
"""The NumPy type for each numeric Arrow type in the tables."""

LARGEST = 2**31 - 1
"""The maximum number of bytes of text or of list items in a column, because Arrow's offsets have 32 bits."""

State = Mapping[Atom, bool]


class Fluents(dict[Atom, int]):
    """The numbers of the fluents in rows, assigned on first use; rows share most fluents."""

    def __missing__(self, fluent: Atom) -> int:
        self[fluent] = number = len(self)
        return number

    def texts(self) -> pa.Array:
        """Return the text of each fluent, in the order of their numbers."""
        return texts_of([str(fluent) for fluent in self])


class Column(Protocol):
    """A column that grows by one value at a time."""

    def add(self, value: Any) -> None:
        """Add a value."""
        ...

    def array(self) -> pa.Array:
        """Return the values."""
        ...


class PlainColumn:
    """A column of plain values."""

    def __init__(self, kind: pa.DataType) -> None:
        self._kind, self._values = kind, list[Any]()

    def add(self, value: Any) -> None:
        """Add a value."""
        self._values.append(value)

    def array(self) -> pa.Array:
        """Return the values."""
        return array_of(self._values, self._kind)


class FactsColumn:
    """A column with the facts of one state per row; all columns share the `fluents`."""

    def __init__(self, fluents: Fluents) -> None:
        self._fluents, self._sizes = fluents, array("i")
        self._numbers, self._values = array("i"), bytearray()
        self._encoded: dict[int, tuple[State, array[int], bytes]] = {}

    def add(self, state: State) -> None:
        """Add the facts of a state."""
        encoding = self._encoded.get(id(state))
        if encoding is None:
            encoding = state, array("i", map(self._fluents.__getitem__, state)), bytes(state.values())
            if isinstance(state, FrozenDict):  # a state is immutable, so it is encoded only once
                self._encoded[id(state)] = encoding
        _, numbers, values = encoding
        self._sizes.append(len(values))
        self._numbers.extend(numbers)
        self._values += values

    def array(self) -> pa.Array:
        """Return the values."""
        numbers = pa.Array.from_buffers(pa.int32(), len(self._numbers), [None, pa.py_buffer(self._numbers)])
        values = pa.Array.from_buffers(pa.bool_(), len(self._values), [None, bits(np.frombuffer(self._values, "?"))])
        facts = pa.StructArray.from_arrays([self._fluents.texts().take(numbers), values], fields=[*FACTS.value_type])
        return lists_of(self._sizes, facts, FACTS)


class StatesColumn:
    """A column with the facts of several states per row."""

    def __init__(self, fluents: Fluents) -> None:
        self._sizes, self._facts = array("i"), FactsColumn(fluents)

    def add(self, states: Sequence[State]) -> None:
        """Add the facts of several states."""
        for state in states:
            self._facts.add(state)
        self._sizes.append(len(states))

    def array(self) -> pa.Array:
        """Return the values."""
        return lists_of(self._sizes, self._facts.array(), pa.list_(FACTS))


class RowReference(NamedTuple):
    """A reference to a row: a table, and the index of the row."""

    table: pa.Table
    place: int


class TableBuilder:
    """A builder that collects the rows of a table; the rows of an earlier run, if any, come first."""

    def __init__(self, table: str, before: pa.Table | None = None) -> None:
        self._schema = SCHEMAS[table]
        # In a table that was read, the items of lists have a different name, which would change the bytes.
        self._whole = [] if before is None else [before.cast(self._schema)]
        self._columns, self._waiting = self._new(), 0
        self._taken, self._numbers = list[tuple[pa.Table, int, int]](), dict[str, list[int]]()
        self.count = 0 if before is None else before.num_rows

    def add(self, row: Mapping[str, Any]) -> None:
        """Add a row."""
        if self._taken:
            self._gather()
        for name, column in self._columns.items():
            column.add(row[name])
        self.count += 1
        self._waiting += 1
        if self._waiting == TOGETHER:
            self._gather()

    def take(self, row: RowReference, rows: int = 1, **numbers: int) -> None:
        """Add consecutive rows of another table; `numbers` holds values for columns to replace or add."""
        if self._waiting and not self._taken:
            self._gather()
        table, first, last = self._taken[-1] if self._taken else (None, 0, 0)
        if table is row.table and last == row.place:  # a slice of many rows costs as little as a slice of one row
            self._taken[-1] = (row.table, first, last + rows)
        else:
            self._taken.append((row.table, row.place, row.place + rows))
        for name, number in numbers.items():
            self._numbers.setdefault(name, []).extend([number] * rows)
        self.count += rows
        self._waiting += rows
        if self._waiting >= TOGETHER:
            self._gather()

    def table(self) -> pa.Table:
        """Return all rows, each column as a single chunk, so that equal rows are written as equal bytes."""
        self._gather()
        return pa.concat_tables(self._whole).combine_chunks()

    def _gather(self) -> None:
        if self._taken:
            own = pa.schema([field for field in self._schema if field.name not in self._numbers])
            taken = pa.concat_tables(table.slice(first, last - first) for table, first, last in self._taken)
            taken = taken.select(own.names).cast(own)
            columns = [
                array_of(self._numbers[field.name], field.type) if field.name in self._numbers else taken[field.name]
                for field in self._schema
            ]
            self._whole.append(pa.Table.from_arrays(columns, schema=self._schema))
            self._taken, self._numbers, self._waiting = [], {}, 0
        elif self._waiting:
            arrays = [column.array() for column in self._columns.values()]
            self._whole.append(pa.Table.from_arrays(arrays, schema=self._schema))
            self._columns, self._waiting = self._new(), 0

    def _new(self) -> dict[str, Column]:
        fluents, columns = Fluents(), dict[str, Column]()
        for field in self._schema:
            if field.type in (FACTS, pa.list_(FACTS)):
                columns[field.name] = (FactsColumn if field.type == FACTS else StatesColumn)(fluents)
            else:
                columns[field.name] = PlainColumn(field.type)
        return columns


def array_of(values: Sequence[Any], kind: pa.DataType) -> pa.Array:
    """Return an Arrow array of texts, truth values, `NUMBERS`, or lists or mappings of these; None becomes null."""
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
    """Return an Arrow array of texts; `validity` is a bitmap that marks the texts that are not null."""
    encoded = [text.encode() for text in texts]
    buffers = [validity, offsets(map(len, encoded)), pa.py_buffer(b"".join(encoded))]
    return pa.Array.from_buffers(pa.string(), len(texts), buffers)


def lists_of(sizes: Iterable[int], items: pa.Array, kind: pa.DataType, validity: pa.Buffer | None = None) -> pa.Array:
    """Return an Arrow array of lists, which are consecutive runs of the items with the given sizes."""
    begins = offsets(sizes)
    return pa.Array.from_buffers(kind, begins.size // 4 - 1, [validity, begins], children=[items])


def offsets(sizes: Iterable[int]) -> pa.Buffer:
    """Return the offsets of items with the given sizes, followed by the end of the last item.

    Raises:
        OverflowError: the sum of the sizes exceeds 32 bits.
    """
    ends = [*accumulate(sizes, initial=0)]
    if ends[-1] > LARGEST:
        raise OverflowError(f"{ends[-1]:,} bytes or items are too many for a column")
    return pa.py_buffer(np.array(ends, dtype="i4"))


def bits(truth: Sequence[Any] | NDArray[np.bool_]) -> pa.Buffer:
    """Return truth values as an Arrow bitmap, in which None counts as false."""
    return pa.py_buffer(np.packbits(np.array(truth, dtype=np.bool_), bitorder="little"))


def packed(table: pa.Table) -> bytes:
    """Return rows as an Arrow IPC stream."""
    stream = pa.BufferOutputStream()
    with pa.ipc.new_stream(stream, table.schema) as writer:
        writer.write_table(table)
    content: bytes = stream.getvalue().to_pybytes()
    return content


def unpacked(content: bytes) -> pa.Table:
    """Return the rows of an Arrow IPC stream."""
    with pa.ipc.open_stream(content) as reader:
        return reader.read_all()
