"""The tables of a report, from which its figures, its page and its CSV files are made."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from io import StringIO

Value = str | int | float | None
"""The value of a cell; None is an empty cell. Counts are exact whole numbers of any size."""


@dataclass(frozen=True)
class ReportTable:
    """A table: its name (also of its CSV file), its title, the names of its columns, its rows, and a note for readers.

    A section of a report begins at each table with a `section`.
    """

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Value, ...], ...]
    note: str = ""

    def column(self, name: str) -> tuple[Value, ...]:
        """Return the values of a column."""
        place = self.columns.index(name)
        return tuple(row[place] for row in self.rows)

    def records(self) -> list[dict[str, Value]]:
        """Return each row as a mapping from column names to values."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


def csv_text(table: ReportTable) -> str:
    """Return a table as CSV (RFC 4180): a line of column names and one for each row; floats have all their digits."""
    buffer = StringIO()
    writer = csv.writer(buffer, lineterminator="\r\n")
    writer.writerow(table.columns)
    writer.writerows(table.rows)
    return buffer.getvalue()


def shown_value(value: Value) -> str:
    """Return a value for readers: grouped digits, four significant digits of floats, and long numbers shortened."""
    if value is None:
        return ""
    if isinstance(value, bool | str):
        return str(value)
    if isinstance(value, float):
        return f"{value:.4g}"
    return f"{value:,}" if abs(value) < 10**30 else f"{len(str(abs(value))):,} digits"


def with_columns(table: ReportTable, names: Sequence[str]) -> ReportTable:
    """Return a table with some of its columns, in this order."""
    places = [table.columns.index(name) for name in names]
    rows = tuple(tuple(row[place] for place in places) for row in table.rows)
    return ReportTable(table.name, table.title, tuple(names), rows, table.note)


def natural_order(text: str) -> list[tuple[int, str]]:
    """Return a sort key for which ``cube_2`` comes before ``cube_10``."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", text)]
