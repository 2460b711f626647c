"""Read the draws of a dataset in order, as rows for another dataset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import pyarrow as pa

from prag_asp.dataset.store.domain_snapshot import MEND
from prag_asp.dataset.store.manifest import tally_of_draw
from prag_asp.dataset.store.schema import ROW_GROUP
from prag_asp.dataset.store.shards import row_groups
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.store.manifest import LengthTally, PartManifest, Shard


class DrawRows(NamedTuple):
    """A draw from another dataset: its row, its tally, and the rows of its initial states."""

    passed: bool
    row: pa.Table
    tally: LengthTally
    witnesses: pa.Table | None
    recordings: Sequence[Mapping[str, Any]]
    versions: str


class PartReader:
    """A reader of the draws of a part in order, with one row group of each table in memory."""

    def __init__(self, folder: Path, note: PartManifest) -> None:
        self._folder, self._note = folder, note
        self._next, self._shard = 0, 0
        self._tables: dict[str, _Cursor] = {}

    @property
    def draws(self) -> int:
        """The number of draws."""
        return self._note.draws

    def draw(self, number: int) -> DrawRows:
        """Return the draw with a number; the numbers must ascend from call to call.

        Raises:
            QueryError: a file is missing, differs from its record in dataset.json, or has no row for the draw.
        """
        shards = self._note.shards
        while self._shard < len(shards) and number >= shards[self._shard].end:
            self._shard += 1
            self._tables = {}
        if self._shard == len(shards):
            raise QueryError(f"{self._folder}: has no shard of the draw {number} of {self._note.name}; {MEND}")
        shard = shards[self._shard]
        if not self._tables:
            self._tables = {table: _Cursor(self._folder, table, shard) for table in ROW_GROUP}
        for table in ("tasks", "rejected"):
            row = self._tables[table].rows("draw", number)
            if row is not None:
                break
        else:
            raise QueryError(f"{self._folder}: has no row of the draw {number} of {self._note.name}; {MEND}")
        values = row.select(["length", "verdict"]).to_pylist()[0]
        witnesses, recordings = None, list[Mapping[str, Any]]()
        if table == "tasks":
            task = row["task"][0].as_py()
            witnesses = self._tables["witnesses"].rows("task", task)
            rows = self._tables["recordings"].rows("task", task)
            recordings = [] if rows is None else rows.to_pylist()
        starts = 0 if witnesses is None else witnesses.num_rows
        tally = tally_of_draw(values["length"], values["verdict"], starts, passed=table == "tasks")
        return DrawRows(table == "tasks", row, tally, witnesses, recordings, shard.versions)


class _Cursor:
    """A cursor over the rows of a table in a shard; the rows are sorted by a numeric column."""

    def __init__(self, folder: Path, table: str, shard: Shard) -> None:
        self._groups = row_groups(folder, table, shard, digest=True)
        self._rows: pa.Table | None = None
        self._keys: list[int] = []
        self._place = 0

    def rows(self, column: str, number: int) -> pa.Table | None:
        """Return the rows whose `column` equals `number`, or None; `number` must not decrease between calls."""
        pieces = []
        while self._forward(column):
            if self._keys[self._place] > number:
                break
            begin = self._place
            while self._place < len(self._keys) and self._keys[self._place] <= number:
                begin += self._keys[self._place] < number
                self._place += 1
            if self._place > begin:
                assert self._rows is not None
                pieces.append(self._rows.slice(begin, self._place - begin))
        return pa.concat_tables(pieces) if len(pieces) > 1 else pieces[0] if pieces else None

    def _forward(self, column: str) -> bool:
        """Move to the next row, and return whether there is one."""
        while self._place >= len(self._keys):
            self._rows = next(self._groups, None)
            if self._rows is None:
                self._keys, self._place = [], 0
                return False
            self._keys, self._place = self._rows[column].to_pylist(), 0
        return True
