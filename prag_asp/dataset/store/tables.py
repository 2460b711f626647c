"""Read rows from the tables in the shards of a dataset."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.dataset.store.domain_snapshot import MEND
from prag_asp.dataset.store.schema import ROW_GROUP
from prag_asp.dataset.store.shards import open_shard, row_groups
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.store.manifest import PartManifest, Shard

Row = Mapping[str, Any]


class TableReader:
    """A reader of the tables of a dataset in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._rank_cache: dict[str, list[tuple[int, str]]] = {}

    def place(self, note: PartManifest, table: str, number: int) -> tuple[Shard, int]:
        """Return the shard that contains a row of a part, and the index of the row in the shard; the row must exist."""
        ends = list(accumulate(shard.rows(table) for shard in note.shards))
        at = bisect_right(ends, number)
        return note.shards[at], number - (ends[at - 1] if at else 0)

    def row(self, table: str, shard: Shard, place: int) -> Row:
        """Return a row of a shard."""
        group, within = divmod(place, ROW_GROUP[table])
        with open_shard(self.folder, table, shard.files[table]) as file:
            result: Row = file.read_row_group(group).slice(within, 1).to_pylist()[0]
        return result

    def rows(self, note: PartManifest, table: str, columns: Sequence[str] | None = None) -> Iterator[Row]:
        """Yield the rows of a part, with all columns or only some."""
        for shard in note.shards:
            yield from self.of_shard(table, shard, columns)

    def of_shard(self, table: str, shard: Shard, columns: Sequence[str] | None = None) -> Iterator[Row]:
        """Yield the rows of a shard."""
        for rows in row_groups(self.folder, table, shard, columns):
            yield from rows.to_pylist()

    def by_rank(self, note: PartManifest, length: int, rank: int, draw: int | None) -> Iterator[Row]:
        """Yield the row of the task with a given rank, if it exists; if the draw is known, only one shard is read.

        Otherwise, the ranks in the part are read once and cached, which takes about a hundred bytes per task.
        """
        selection = (length, str(rank))
        if draw is not None:
            at = bisect_right([shard.end for shard in note.shards], draw)
            for shard in note.shards[at : at + 1]:
                yield from (self.row("tasks", shard, place) for place in _places(self._ranks([shard]), selection))
            return
        if note.name not in self._rank_cache:
            self._rank_cache[note.name] = self._ranks(note.shards)
        for number in _places(self._rank_cache[note.name], selection):
            yield self.row("tasks", *self.place(note, "tasks", number))

    def _ranks(self, shards: Sequence[Shard]) -> list[tuple[int, str]]:
        """Return the length and the rank of each task in the given shards, as Python values.

        Comparisons in Arrow would import pandas.
        """
        ranks: list[tuple[int, str]] = []
        for shard in shards:
            if shard.rows("tasks"):
                with open_shard(self.folder, "tasks", shard.files["tasks"]) as file:
                    keys = file.read(columns=["length", "rank"])
                ranks += zip(keys["length"].to_pylist(), keys["rank"].to_pylist(), strict=True)
        return ranks

    def starts(self, note: PartManifest, table: str, task: Row) -> Iterator[Row]:
        """Yield the rows of the initial states of a task, which are in the same shard."""
        place = bisect_right([shard.end for shard in note.shards], task["draw"])
        if place == len(note.shards):
            raise QueryError(f"{self.folder}: has no shard of the draw {task['draw']} of {note.name}; {MEND}")
        shard = note.shards[place]
        for group, keys in enumerate(row_groups(self.folder, table, shard, ["task"])):
            for place in _places(keys["task"].to_pylist(), task["task"]):
                yield self.row(table, shard, group * ROW_GROUP[table] + place)


def _places(values: Sequence[object], selection: object) -> Iterator[int]:
    """Yield the indices of a value."""
    return (place for place, value in enumerate(values) if value == selection)
