"""The Parquet files of a LeRobotDataset, which are grouped into chunks and written episode by episode."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from prag_asp.output import make_folder
from prag_asp.output.atomic_file import output_errors

CHUNK = 1000
"""The number of files in a chunk, as in LeRobot."""

MEGABYTE = 1 << 20

ROWS = 100
"""The number of rows of the table of episodes that are written at a time."""

Place = tuple[int, int]


def places() -> Iterator[Place]:
    """Yield the index of the chunk and the index within the chunk for each file in turn, endlessly."""
    chunk = 0
    while True:
        yield from ((chunk, file) for file in range(CHUNK))
        chunk += 1


class ChunkedTable:
    """A writer of the rows of one table to several files, each of about `megabytes` MB at most."""

    def __init__(self, folder: Path, pattern: str, schema: pa.Schema, megabytes: int) -> None:
        self._folder, self._pattern, self._limit = folder, pattern, megabytes * MEGABYTE
        self.schema = schema
        self._places = places()
        self._place = next(self._places)
        self._writer: pq.ParquetWriter | None = None
        self._rows: list[Mapping[str, Any]] = []

    def add(self, rows: pa.Table) -> Place:
        """Write rows as one row group, and return the indices of the chunk and the file.

        Raises:
            OutputError: the rows cannot be written.
        """
        path = self._path
        if self._writer is not None and path.stat().st_size >= self._limit:
            self.close()
            self._place = next(self._places)
            path = self._path
        with output_errors(path):
            if self._writer is None:
                make_folder(path.parent)
                self._writer = pq.ParquetWriter(path, rows.schema, compression="snappy")
            self._writer.write_table(rows)
        return self._place

    def add_row(self, row: Mapping[str, Any]) -> None:
        """Add a row of the table of episodes; rows are written in batches.

        Raises:
            OutputError: a file cannot be written.
        """
        self._rows.append(row)
        if len(self._rows) >= ROWS:
            self._flush()

    def close(self) -> None:
        """Write the remaining rows, and close the current file.

        Raises:
            OutputError: the file cannot be written.
        """
        if self._rows:
            self._flush()
        if self._writer is not None:
            writer, self._writer = self._writer, None
            with output_errors(self._path):
                writer.close()

    @property
    def _path(self) -> Path:
        chunk, file = self._place
        return self._folder / self._pattern.format(chunk_index=chunk, file_index=file)

    def _flush(self) -> None:
        """Write the buffered rows."""
        rows, self._rows = self._rows, []
        if self._writer is not None and self._path.stat().st_size >= self._limit:
            self.close()
            self._place = next(self._places)
        chunk, file = self._place
        placed = [{**row, "meta/episodes/chunk_index": chunk, "meta/episodes/file_index": file} for row in rows]
        self.add(pa.Table.from_pylist(placed, self.schema))


def texts_table(name: str, texts: Mapping[str, int]) -> pa.Table:
    """Return a table of texts with their numbers in the column ``NAME_index``; pandas uses the texts as the index."""
    number = f"{name}_index"
    columns = [
        {"name": number, "field_name": number, "pandas_type": "int64", "numpy_type": "int64", "metadata": None},
        {"name": name, "field_name": name, "pandas_type": "unicode", "numpy_type": "object", "metadata": None},
    ]
    note = {"index_columns": [name], "column_indexes": [], "columns": columns, "pandas_version": "2.0.0"}
    schema = pa.schema([(number, pa.int64()), (name, pa.string())], {"pandas": json.dumps(note)})
    return pa.table([list(texts.values()), list(texts)], schema=schema)


def write_table(path: Path, table: pa.Table) -> None:
    """Write a table as a file.

    Raises:
        OutputError: the file cannot be written.
    """
    with output_errors(path):
        pq.write_table(table, path, compression="snappy")
