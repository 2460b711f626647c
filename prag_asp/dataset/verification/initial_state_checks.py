"""The first states of tasks: their witnesses, each in a fresh simulator, and the recordings of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.jsonl import Record
from prag_asp.dataset.revalidation import recheck
from prag_asp.dataset.scenes import scene_of
from prag_asp.dataset.store.entry import entry_of
from prag_asp.dataset.task_origin import read_witness
from prag_asp.dataset.validation_jobs import START, TRIES, first_state
from prag_asp.dataset.verification.file_checks import wrong_file
from prag_asp.dataset.verification.finding import Finding, Looked
from prag_asp.dataset.verification.untrusted_rows import Row, whole_rows
from prag_asp.errors import PragError
from prag_asp.physics import TIERS, Budget, Demonstration, check_demonstration, check_footage
from prag_asp.safe_reading import is_inside
from prag_asp.tables.json_fields import decoded

if TYPE_CHECKING:
    from prag_asp.dataset.store.manifest import Manifest, PartNote, Shard
    from prag_asp.dataset.store.tables import Tables
    from prag_asp.domain.load import Domain
    from prag_asp.scene.scene import Scene
    from prag_asp.task import Task


TRANSIT = TIERS[-2]
"""The tier up to which witnesses are checked: what comes after it is in recordings."""


class Starts:
    """Looks at the witnesses and recordings of a data set, shard by shard."""

    def __init__(
        self,
        folder: Path,
        manifest: Manifest,
        domain: Domain,
        tables: Tables,
        workers: int,
        progress: Looked,
    ) -> None:
        self._folder, self._manifest, self._domain, self._tables = folder, manifest, domain, tables
        self._workers, self._progress, self._done = workers, progress, 0
        self._scene: Scene = scene_of(domain)
        self._where = manifest.asked.where
        asked = manifest.asked.budget
        assert asked is not None
        tier = min(TIERS.index(asked.tier), TIERS.index(TRANSIT)) if asked.tier in TIERS else 0
        self._budget = Budget(asked.restarts, asked.samples, TIERS[tier])

    def wrong(self, note: PartNote) -> Iterator[Finding]:
        """Yield what is wrong with the first states of a part's tasks."""
        for shard in note.shards:
            try:
                rows, found, recorded = (self._whole(name, shard) for name in ("tasks", "witnesses", "recordings"))
                tasks = {row["task"]: entry_of(row, "", self._manifest.domain.constants).task for _, row in rows}
            except (PragError, ValueError, TypeError, KeyError):
                continue  # what is wrong with the rows is told of them
            yield from self._wrong_numbers(shard, rows, found)
            yield from self._wrong_witnesses(shard, tasks, found)
            yield from self._wrong_recordings(shard, tasks, recorded)
            self._done += len(rows)
            self._progress("witnesses", self._done, self._manifest.rows("tasks"))

    def _whole(self, table: str, shard: Shard) -> list[Row]:
        return whole_rows("", self._tables.of_shard(table, shard))[0]

    def _wrong_numbers(self, shard: Shard, rows: list[Row], found: list[Row]) -> Iterator[Finding]:
        """Yield which tasks have not as many witnesses as their rows say, or witnesses of other searches."""
        count = Counter(row["task"] for _, row in found)
        for place, row in rows:
            if row["starts"] != count.pop(row["task"], 0):
                yield Finding(
                    shard.files["tasks"].path, place, f"says that {row['starts']} first states have a witness"
                )
        whole = self._manifest.asked.deal.whole
        draws = {row["task"]: whole(row["draw"]) for _, row in rows}
        before: dict[int, tuple[int, int]] = {}  # of each task: the first state that is due, and the last search
        for place, row in found:
            file = shard.files["witnesses"].path
            if row["task"] in count:
                yield Finding(file, place, f"is of a task {row['task']}, which the shard does not have")
                continue
            due, last = before.get(row["task"], (0, -1))
            search, lacks = divmod(row["index"] - draws[row["task"]], START)
            if row["start"] != due:
                yield Finding(file, place, f"is of the first state {row['start']}; the next one is {due}")
            if lacks or not last < search < TRIES * self._manifest.asked.starts or (search > 0) != (due > 0):
                yield Finding(file, place, f"is of the index {row['index']}, not of its draw and first state")
            before[row["task"]] = due + 1, search

    def _wrong_witnesses(self, shard: Shard, tasks: Mapping[int, Task], found: list[Row]) -> Iterator[Finding]:
        """Yield which witnesses a fresh simulator does not take."""
        file, records, places = shard.files["witnesses"].path if found else "", [], []
        seen = set[tuple[int, str]]()
        for place, row in found:
            if row["task"] not in tasks:
                continue
            try:
                record = Record(tasks[row["task"]], None, decoded(row["witness"]))
                begins = row["task"], first_state(read_witness(record, self._scene))
            except PragError as error:
                yield Finding(file, place, f"is no witness: {error}")
                continue
            if begins in seen:
                yield Finding(file, place, "begins in a first state that another witness of its task has")
            seen.add(begins)
            records.append(record)
            places.append(place)
        checked = recheck(
            records, self._domain, where=self._where, workers=self._workers, budget=self._budget, witness_only=True
        )
        with closing(checked) as outcomes:
            for place, outcome in zip(places, outcomes, strict=True):
                if outcome.status != "feasible":
                    yield Finding(file, place, f"the witness fails: {outcome.reason}")

    def _wrong_recordings(self, shard: Shard, tasks: Mapping[int, Task], rows: list[Row]) -> Iterator[Finding]:
        """Yield which recordings are not the files that were written, or do not show their tasks."""
        for place, row in rows:
            table, task = shard.files["recordings"].path, tasks.get(row["task"])
            path = self._folder / row["file"]
            if task is None:
                yield Finding(table, place, f"is of a task {row['task']}, which the shard does not have")
                continue
            if not is_inside(path, self._folder):
                yield Finding(table, place, f"{row['file']} leads out of the data set")
                continue
            yield from wrong_file(self._folder, row["file"], row["sha256"])
            try:
                shown = Demonstration.load(path)
                wrong = check_demonstration(task, shown, self._scene) + check_footage(shown, self._scene)
            except PragError as error:
                yield Finding(row["file"], None, f"is no recording: {error}")
                continue
            said = (row["frames"], row["seconds"], row["ends"])
            if said != (len(shown.times), float(shown.times[-1]), shown.ends.tolist()):
                yield Finding(table, place, f"says otherwise how long {row['file']} is")
            yield from (Finding(row["file"], None, what) for what in wrong)
