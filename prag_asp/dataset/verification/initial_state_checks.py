"""Check the witnesses of tasks, each in a fresh simulator, and the recordings."""

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
from prag_asp.dataset.validation_jobs import START, TRIES, initial_state_key
from prag_asp.dataset.verification.file_checks import wrong_file
from prag_asp.dataset.verification.finding import Finding, Progress
from prag_asp.dataset.verification.untrusted_rows import Row, whole_rows
from prag_asp.errors import PragError
from prag_asp.physics import TIERS, Budget, Demonstration, check_demonstration, check_footage
from prag_asp.safe_reading import is_inside
from prag_asp.tables.json_fields import decoded

if TYPE_CHECKING:
    from prag_asp.dataset.store.manifest import Manifest, PartManifest, Shard
    from prag_asp.dataset.store.tables import TableReader
    from prag_asp.domain.load import Domain
    from prag_asp.scene.scene import Scene
    from prag_asp.task import Task


TRANSIT = TIERS[-2]
"""The most expensive tier at which witnesses are checked; demonstrations are checked through their recordings."""


class InitialStateChecks:
    """The checks of the witnesses and recordings of a dataset, shard by shard."""

    def __init__(
        self,
        folder: Path,
        manifest: Manifest,
        domain: Domain,
        tables: TableReader,
        workers: int,
        progress: Progress,
    ) -> None:
        self._folder, self._manifest, self._domain, self._tables = folder, manifest, domain, tables
        self._workers, self._progress, self._done = workers, progress, 0
        self._scene: Scene = scene_of(domain)
        self._where = manifest.where
        requested = manifest.spec.budget
        assert requested is not None
        tier = min(requested.tier, TRANSIT, key=TIERS.index)
        self._budget = Budget(requested.restarts, requested.samples, tier)

    def wrong(self, note: PartManifest) -> Iterator[Finding]:
        """Yield findings about the initial states of a part's tasks."""
        for shard in note.shards:
            try:
                rows, witnesses, recordings = (
                    whole_rows("", self._tables.of_shard(name, shard))[0]
                    for name in ("tasks", "witnesses", "recordings")
                )
                tasks = {row["task"]: entry_of(row, "", self._manifest.domain.constants).task for _, row in rows}
            except (PragError, ValueError, TypeError, KeyError):
                continue  # the checks of rows report it
            yield from self._wrong_numbers(shard, rows, witnesses)
            yield from self._wrong_witnesses(shard, tasks, witnesses)
            yield from self._wrong_recordings(shard, tasks, recordings)
            self._done += len(rows)
            self._progress("witnesses", self._done, self._manifest.rows("tasks"))

    def _wrong_numbers(self, shard: Shard, rows: list[Row], witnesses: list[Row]) -> Iterator[Finding]:
        """Yield findings about tasks with a wrong number of witnesses, and about witnesses from wrong searches."""
        count = Counter(row["task"] for _, row in witnesses)
        for place, row in rows:
            if row["starts"] != count.pop(row["task"], 0):
                yield Finding(
                    shard.files["tasks"].path, place, f"says that {row['starts']} initial states have a witness"
                )
        whole = self._manifest.spec.deal.whole
        draws = {row["task"]: whole(row["draw"]) for _, row in rows}
        before: dict[int, tuple[int, int]] = {}  # for each task: the next initial state, and the last search
        for place, row in witnesses:
            file = shard.files["witnesses"].path
            if row["task"] in count:
                yield Finding(file, place, f"belongs to task {row['task']}, which the shard does not have")
                continue
            due, last = before.get(row["task"], (0, -1))
            search, remainder = divmod(row["index"] - draws[row["task"]], START)
            if row["start"] != due:
                yield Finding(file, place, f"belongs to initial state {row['start']}, but the next one is {due}")
            if remainder or not last < search < TRIES * self._manifest.spec.starts or (search > 0) != (due > 0):
                yield Finding(
                    file, place, f"has the index {row['index']}, which is not that of its draw and initial state"
                )
            before[row["task"]] = due + 1, search

    def _wrong_witnesses(self, shard: Shard, tasks: Mapping[int, Task], witnesses: list[Row]) -> Iterator[Finding]:
        """Yield findings about witnesses that a fresh simulator rejects."""
        file, records, places = shard.files["witnesses"].path if witnesses else "", [], []
        seen = set[tuple[int, str]]()
        for place, row in witnesses:
            if row["task"] not in tasks:
                continue
            try:
                record = Record(tasks[row["task"]], None, decoded(row["witness"]))
                initial_state = row["task"], initial_state_key(read_witness(record, self._scene))
            except PragError as error:
                yield Finding(file, place, f"is not a witness: {error}")
                continue
            if initial_state in seen:
                yield Finding(file, place, "has the same initial state as another witness of its task")
            seen.add(initial_state)
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
        """Yield findings about recordings that have changed or do not show their tasks."""
        for place, row in rows:
            table, task = shard.files["recordings"].path, tasks.get(row["task"])
            path = self._folder / row["file"]
            if task is None:
                yield Finding(table, place, f"belongs to task {row['task']}, which the shard does not have")
                continue
            if not is_inside(path, self._folder):
                yield Finding(table, place, f"{row['file']} leads out of the dataset")
                continue
            yield from wrong_file(self._folder, row["file"], row["sha256"])
            try:
                recording = Demonstration.load(path)
                faults = check_demonstration(task, recording, self._scene) + check_footage(recording, self._scene)
            except PragError as error:
                yield Finding(row["file"], None, f"is not a recording: {error}")
                continue
            durations = (row["frames"], row["seconds"], row["ends"])
            if durations != (len(recording.times), float(recording.times[-1]), recording.ends.tolist()):
                yield Finding(table, place, f"gives a different length of {row['file']}")
            yield from (Finding(row["file"], None, fault) for fault in faults)
