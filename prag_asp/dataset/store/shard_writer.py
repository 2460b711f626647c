"""Write the draws of a part of a dataset, shard by shard."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import pyarrow as pa

from prag_asp.dataset.store.columns import RowReference, TableBuilder
from prag_asp.dataset.store.domain_snapshot import digest_of
from prag_asp.dataset.store.draw_results import DrawResult
from prag_asp.dataset.store.manifest import LengthTally, PartManifest, Shard, summed, tally_of_draw
from prag_asp.dataset.store.schema import SCHEMAS
from prag_asp.dataset.store.shards import open_shard, write_shard
from prag_asp.errors import PragError
from prag_asp.integers import digits_of
from prag_asp.processes.progress_events import stage
from prag_asp.space.sampling.streams import log_probability
from prag_asp.versions import versions

if TYPE_CHECKING:
    from prag_asp.dataset.store.instructions import TaskTexts
    from prag_asp.dataset.store.shard_reader import DrawRows
    from prag_asp.physics.verdict import Verdict
    from prag_asp.space.distinct_sampling import RankedDraw
    from prag_asp.task import Task

LIMITS: Mapping[str, int] = {"tasks": 1, "rejected": 10, "witnesses": 4}
"""The maximum number of rows in each table of a shard, as a multiple of the maximum number of its tasks."""

TOGETHER = "; "
"""The text that separates the versions of the programs that produced a shard."""

SUMMED_TOGETHER = 256
"""The number of tallies of single draws to collect before summing them."""


class PartWriter:
    """A writer that collects the draws of a part in order, and writes them shard by shard."""

    def __init__(self, folder: Path, note: PartManifest, shard: int) -> None:
        """Continue after the existing shards of a part; a full shard has at most `shard` tasks."""
        self._folder, self._limit, self.note, self._ours = folder, shard, note, versions()
        self._begin()
        if note.tail is not None:
            self._continue(note.tail)

    @property
    def next(self) -> int:
        """The number of the next draw."""
        return self._first + self._draws

    @property
    def tasks(self) -> int:
        """The number of tasks in the part."""
        return self.note.rows("tasks") + self._rows["tasks"].count

    @property
    def full(self) -> bool:
        """Whether the shard has to be written before another draw is added."""
        return any(self._rows[table].count >= times * self._limit for table, times in LIMITS.items())

    @property
    def empty(self) -> bool:
        """Whether there are no draws to write."""
        return not self._draws

    def add(self, placed: RankedDraw, task: Task, result: DrawResult, words: TaskTexts) -> None:
        """Add a draw with its result and texts."""
        row, witnesses = row_of(placed, task, result, words), result.witnesses
        if result.passed:
            self._rows["tasks"].add({**row, "task": self.tasks, "starts": witnesses})
        else:
            self._rows["rejected"].add(row)
        self._add_result(result, len(task))

    def add_row(self, placed: RankedDraw, row: RowReference, result: DrawResult) -> None:
        """Add a draw with its result, and with the row that another process built."""
        if result.passed:
            self._rows["tasks"].take(row, task=self.tasks, starts=result.witnesses)
        else:
            self._rows["rejected"].take(row)
        self._add_result(result, len(placed.word))

    def _add_result(self, result: DrawResult, length: int) -> None:
        """Add the initial states of the draw whose row was added last, and update the tally."""
        for start, each in enumerate(result.starts) if result.passed else ():
            key, text = {"task": self.tasks - 1, "start": start}, each.text
            if text is not None:
                self._rows["witnesses"].add({**key, "index": each.index, "witness": text})
            if each.recording is not None:
                self._rows["recordings"].add({**key, **msgspec.structs.asdict(each.recording)})
        verdict = _verdict_row(result.verdict)
        self._tally(tally_of_draw(length, verdict, result.witnesses, passed=result.passed), self._ours)
        self._draws += 1

    def take(self, source: DrawRows) -> None:
        """Add a draw from another dataset, with a new number."""
        if source.passed:
            number = self.tasks
            self._rows["tasks"].take(RowReference(source.row, 0), task=number, draw=self.next)
            if source.witnesses is not None:
                self._rows["witnesses"].take(RowReference(source.witnesses, 0), source.witnesses.num_rows, task=number)
            for row in source.recordings:
                self._rows["recordings"].add({**row, "task": number})
        else:
            self._rows["rejected"].take(RowReference(source.row, 0), draw=self.next)
        self._tally(source.tally, source.versions)
        self._draws += 1

    def write(self) -> None:
        """Write the shard and add it to the part; the caller then writes dataset.json.

        Raises:
            OutputError: a file cannot be written.
        """
        stage("writing the dataset")
        number = self.note.shards[-1].number + 1 if self.note.shards else 0
        files = {
            table: write_shard(self._folder, table, self.note.name, number, rows.table())
            for table, rows in self._rows.items()
            if rows.count
        }
        tally = summed(self._tallies)
        made_by = TOGETHER.join(sorted(self._versions))
        self.note.shards.append(Shard(number, self._first, self.next, self.full, files, tally, made_by))
        self.note.tail = None
        self._begin()

    def _begin(self) -> None:
        """Begin a shard."""
        self._first = self.note.shards[-1].end if self.note.shards else 0
        self._draws = 0
        self._rows = {table: TableBuilder(table) for table in SCHEMAS}
        self._tallies: list[LengthTally] = []
        self._versions: set[str] = set()

    def _continue(self, tail: Shard) -> None:
        """Continue a shard that was not full, if its files match their records in dataset.json."""
        try:
            if any(digest_of(self._folder / file.path) != file.sha256 for file in tail.files.values()):
                return  # a killed run may have written more rows without updating dataset.json
            before = {}
            for table, file in tail.files.items():
                with open_shard(self._folder, table, file) as opened:
                    before[table] = opened.read()
        except (OSError, PragError, pa.ArrowException):
            return
        self._rows = {table: TableBuilder(table, before.get(table)) for table in SCHEMAS}
        self._draws, self._tallies = tail.end - tail.first, list(tail.tally)
        self._versions = {*tail.versions.split(TOGETHER)}

    def _tally(self, tally: LengthTally, made_by: str) -> None:
        """Count a draw, and note the version that validated it."""
        self._versions.add(made_by)
        self._tallies.append(tally)
        if len(self._tallies) >= SUMMED_TOGETHER:
            self._tallies = summed(self._tallies)


def row_of(placed: RankedDraw, task: Task, result: DrawResult, words: TaskTexts) -> dict[str, Any]:
    """Return the row for a draw in a table of tasks."""
    return {
        "draw": result.draw,
        "domain": task.domain,
        "length": len(task),
        "rank": digits_of(placed.rank),
        "log_probability": log_probability(placed.probability),
        "plan": placed.word,
        "skeleton": task.skeleton,
        "entities": [{"entity": name, "class": kind} for name, kind in task.entities.items()],
        "initial": task.initial,
        "states": task.states,
        "subgoals": task.subgoals,
        "goal": task.goal,
        "instruction": [{"level": level, "text": text} for level, text in words.whole],
        "subgoal_instructions": words.subgoals,
        "named": words.named,
        "verdict": _verdict_row(result.verdict),
    }


def _verdict_row(verdict: Verdict | None) -> dict[str, Any] | None:
    """Return a verdict as the value of its column."""
    if verdict is None:
        return None
    causes = [{"cause": cause, "count": count} for cause, count in verdict.causes.items()]
    return {"details": [], **verdict.to_json(), "causes": causes}
