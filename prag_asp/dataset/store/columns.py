"""Columns that rows are added to, each row by a few plain lists: a task has hundreds of facts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any, Protocol

import pyarrow as pa

from prag_asp.atom import Atom
from prag_asp.dataset.store.schema import FACTS, SCHEMAS
from prag_asp.task import FrozenDict

TOGETHER = 256
"""Rows that wait as lists, which take much room; more are kept as Arrow has them."""

Known = Mapping[Atom, bool]


class Column(Protocol):
    """A column that grows by one value at a time."""

    def add(self, value: Any) -> None:
        """Add a value."""
        ...

    def array(self) -> pa.Array:
        """Return the values."""
        ...


class Plain:
    """Values that Arrow takes as they are."""

    def __init__(self, kind: pa.DataType) -> None:
        self._kind, self._values = kind, list[Any]()

    def add(self, value: Any) -> None:
        """Add a value."""
        self._values.append(value)

    def array(self) -> pa.Array:
        """Return the values."""
        return pa.array(self._values, self._kind)


class Facts:
    """What is known of a state, for each row."""

    def __init__(self) -> None:
        self._ends, self._fluents, self._values = [0], list[str](), list[bool]()

    def add(self, known: Known) -> None:
        """Add what is known of a state."""
        fluents, values = _spelled(known) if isinstance(known, FrozenDict) else _texts(known)
        self._fluents += fluents
        self._values += values
        self._ends.append(len(self._values))

    def array(self) -> pa.Array:
        """Return the values."""
        columns = [pa.array(self._fluents, pa.string()), pa.array(self._values, pa.bool_())]
        facts = pa.StructArray.from_arrays(columns, fields=list(FACTS.value_type))
        return pa.ListArray.from_arrays(pa.array(self._ends, pa.int32()), facts, type=FACTS)


class States:
    """What is known of several states, for each row."""

    def __init__(self) -> None:
        self._ends, self._facts = [0], Facts()

    def add(self, states: Sequence[Known]) -> None:
        """Add what is known of some states."""
        for known in states:
            self._facts.add(known)
        self._ends.append(self._ends[-1] + len(states))

    def array(self) -> pa.Array:
        """Return the values."""
        return pa.ListArray.from_arrays(pa.array(self._ends, pa.int32()), self._facts.array(), type=pa.list_(FACTS))


class Rows:
    """The rows of a table that are still to be written; some may have been before."""

    def __init__(self, table: str, before: pa.Table | None = None) -> None:
        self._schema = SCHEMAS[table]
        # What is read names the items of lists otherwise, which would show in the bytes.
        self._whole = [] if before is None else [before.cast(self._schema)]
        self._columns, self._waiting = self._new(), 0
        self._taken, self._numbers = list[pa.Table](), dict[str, list[int]]()
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

    def take(self, rows: pa.Table, **numbers: int) -> None:
        """Add rows of another such table, with other `numbers` in some columns."""
        if self._waiting and not self._taken:
            self._gather()
        self._taken.append(rows)
        for name, number in numbers.items():
            self._numbers.setdefault(name, []).extend([number] * rows.num_rows)
        self.count += rows.num_rows
        self._waiting += rows.num_rows
        if self._waiting >= TOGETHER:
            self._gather()

    def table(self) -> pa.Table:
        """Return all rows, each column in one piece, so that the same rows are written as the same bytes."""
        self._gather()
        return pa.concat_tables(self._whole).combine_chunks()

    def _gather(self) -> None:
        if self._taken:
            taken = pa.concat_tables(self._taken).cast(self._schema)
            for name, numbers in self._numbers.items():
                field = self._schema.field(name)
                taken = taken.set_column(self._schema.get_field_index(name), field, pa.array(numbers, field.type))
            self._whole.append(taken)
            self._taken, self._numbers, self._waiting = [], {}, 0
        elif self._waiting:
            arrays = [column.array() for column in self._columns.values()]
            self._whole.append(pa.Table.from_arrays(arrays, schema=self._schema))
            self._columns, self._waiting = self._new(), 0

    def _new(self) -> dict[str, Column]:
        return {field.name: _column(field.type) for field in self._schema}


def _column(kind: pa.DataType) -> Column:
    if kind == FACTS:
        return Facts()
    return States() if kind == pa.list_(FACTS) else Plain(kind)


@lru_cache(maxsize=1 << 13)
def _spelled(known: FrozenDict[Atom, bool]) -> tuple[list[str], list[bool]]:
    return _texts(known)


def _texts(known: Known) -> tuple[list[str], list[bool]]:
    return list(map(_text, known)), list(known.values())


_text = lru_cache(maxsize=1 << 16)(str)
"""The text of a fluent: the states of a space have few fluents, each in thousands of states."""
