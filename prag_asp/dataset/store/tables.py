"""Rows of the tables of a data set, read from the shards that have them and from no others."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow.compute as pc

from prag_asp.dataset.store.schema import ROW_GROUP
from prag_asp.dataset.store.shards import open_shard

if TYPE_CHECKING:
    import pyarrow as pa

    from prag_asp.dataset.store.manifest import PartNote, Shard

Row = Mapping[str, Any]


class Tables:
    """The tables of a data set in a folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def place(self, note: PartNote, table: str, number: int) -> tuple[Shard, int]:
        """Return the shard of a row of a part, and its place there; there is such a row."""
        ends = list(accumulate(shard.rows(table) for shard in note.shards))
        at = bisect_right(ends, number)
        return note.shards[at], number - (ends[at - 1] if at else 0)

    def row(self, table: str, shard: Shard, place: int) -> Row:
        """Return a row of a shard."""
        group, within = divmod(place, ROW_GROUP[table])
        with open_shard(self._folder, table, shard.files[table]) as file:
            found: Row = file.read_row_group(group).slice(within, 1).to_pylist()[0]
        return found

    def rows(self, note: PartNote, table: str, columns: Sequence[str] | None = None) -> Iterator[Row]:
        """Yield the rows of a part, each with some columns or with all."""
        for shard in note.shards:
            yield from self.of_shard(table, shard, columns)

    def of_shard(self, table: str, shard: Shard, columns: Sequence[str] | None = None) -> Iterator[Row]:
        """Yield the rows of a shard."""
        for _, found in self._groups(table, shard, columns):
            yield from found.to_pylist()

    def found(self, note: PartNote, length: int, rank: int, draw: int | None) -> Iterator[Row]:
        """Yield the row of the task of a rank; where its draw is known, one shard alone is looked into."""
        shards: Sequence[Shard] = note.shards
        if draw is not None:
            at = bisect_right([shard.end for shard in shards], draw)
            shards = shards[at : at + 1]
        for shard in shards:
            for first, keys in self._groups("tasks", shard, ["length", "rank"]):
                same = pc.and_(pc.equal(keys["length"], length), pc.equal(keys["rank"], str(rank)))
                for place in pc.indices_nonzero(same).to_pylist():
                    yield self.row("tasks", shard, first + place)

    def starts(self, note: PartNote, table: str, task: Row) -> Iterator[Row]:
        """Yield the rows of the first states of a task, which stand in one shard with it."""
        shard = note.shards[bisect_right([shard.end for shard in note.shards], task["draw"])]
        for first, keys in self._groups(table, shard, ["task"]):
            for place in pc.indices_nonzero(pc.equal(keys["task"], task["task"])).to_pylist():
                yield self.row(table, shard, first + place)

    def _groups(self, table: str, shard: Shard, columns: Sequence[str] | None = None) -> Iterator[tuple[int, pa.Table]]:
        """Yield the rows of a shard in groups, each with the place of its first one; no file stays open meanwhile."""
        if not shard.rows(table):
            return
        for group in range(-(-shard.rows(table) // ROW_GROUP[table])):
            with open_shard(self._folder, table, shard.files[table]) as file:
                found = file.read_row_group(group, columns=None if columns is None else [*columns])
            yield group * ROW_GROUP[table], found
