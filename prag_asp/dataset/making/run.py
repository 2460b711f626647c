"""A run that generates or resumes a dataset: an executor validates draws, and this process writes them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass
from hashlib import sha256
from itertools import chain, islice, takewhile, tee
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from prag_asp.dataset.dataset_spec import DatasetSpec
from prag_asp.dataset.episode_files import name_of, remove_after
from prag_asp.dataset.making.chosen_draws import FollowingOrder, ListedOrder, choice_of, record_figures
from prag_asp.dataset.making.draw_plan import DrawPlan
from prag_asp.dataset.making.executors import Executor
from prag_asp.dataset.making.ordered_tasks import requested_parts
from prag_asp.dataset.pages.dataset_card import write_card
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.domain_snapshot import MEND, DomainSnapshot, write_snapshot
from prag_asp.dataset.store.draw_results import TRIVIAL, DrawResult
from prag_asp.dataset.store.instructions import TaskTexts, captioner_of
from prag_asp.dataset.store.manifest import (
    DATASET,
    Manifest,
    PartManifest,
    SpaceSize,
    identity_of,
    request_of,
    write_manifest,
)
from prag_asp.dataset.validation_jobs import JobResult, ValidationJob, ValidationSetup
from prag_asp.errors import NotFound, OutputError, QueryError
from prag_asp.integers import digits_of, number_of
from prag_asp.output import Journal, file_in, make_folder, replace_file
from prag_asp.processes.workers import uninterrupted
from prag_asp.safe_reading import read_bytes
from prag_asp.space.distinct_sampling import TaskOrder
from prag_asp.space.without_replacement import with_tasks
from prag_asp.versions import versions
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.making.chosen_draws import DrawChoice
    from prag_asp.dataset.making.machine_parts import MachineParts
    from prag_asp.dataset.store.shard_writer import PartWriter
    from prag_asp.space.distinct_sampling import RankedDraw
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

RECORDINGS = "demonstrations"
"""The folder of the recordings in a dataset."""

JOURNAL = "journal.part"
"""The file with the results of the draws since the last shard, used to resume an interrupted run and removed at the
end."""

Progress = Callable[[str, int, int], None]
"""A callback that reports progress: a message, the number of tasks so far, and the number requested."""


@dataclass(frozen=True)
class DrawRecord:
    """A draw to write: its result, with a `job_result` unless it comes from the journal.

    `task` holds the task and its texts; it is None if the job result already contains their row.
    """

    placed: RankedDraw
    result: DrawResult
    task: tuple[Task, TaskTexts] | None
    job_result: JobResult | None = None


class DatasetRun:
    """A run that generates a dataset in a folder; in a merge, machine `parts` have validated most of the draws."""

    def __init__(
        self,
        space: TaskSpace,
        folder: Path,
        spec: DatasetSpec,
        snapshot: tuple[DomainSnapshot, dict[str, bytes]],
        executor: Executor,
        progress: Progress,
        max_draws: int | None = None,
        parts: MachineParts | None = None,
    ) -> None:
        if max_draws is not None and max_draws < 1:
            raise QueryError(f"max_draws {max_draws}: a dataset needs at least 1 draw")
        self._space, self._folder, self._spec, self._executor = space, folder, spec, executor
        self._snapshot, self._files = snapshot
        self._progress, self._max_draws, self._parts = progress, max_draws, parts
        self._shares = spec.division.shares

    def done(self) -> Dataset:
        """Generate the dataset, and open it.

        Raises:
            PragError: as `generate` does.
        """
        spec = self._spec
        self._captioner = captioner_of(self._space.domain, spec.language, spec.seed, spec.phrasings)
        DATASET.require_folder(self._folder, JOURNAL)
        parts = requested_parts(self._space, spec)
        make_folder(self._folder)
        values, spaces = request_of(self._space, spec), {each: self._space.at(each) for each in self._space.lengths}
        request = Manifest(
            complete=False,
            identity=identity_of(self._snapshot, values),
            spec=spec,
            lengths=values["lengths"],
            where=values["where"],
            domain=self._snapshot,
            spaces=[SpaceSize(length, digits_of(space.count())) for length, space in spaces.items()],
            parts=[PartManifest(name, digits_of(part.size), 0) for name, part in parts.items()],
        )
        self._journal = Journal(self._folder / JOURNAL, request.identity)
        try:
            self._manifest = self._resumed(request)
            if not self._manifest.complete:
                self._make(parts)
            with uninterrupted():
                self._journal.clear()
        finally:
            with uninterrupted():
                self._journal.close()
        for note in self._manifest.parts:
            # Other machines may have the rest, or a stratum may have too few feasible tasks.
            exhausted = (spec.part is not None or bool(spec.strata)) and note.draws >= number_of(note.size)
            if note.tasks < note.requested and not exhausted:
                diverse, available = (self._manifest.diverse or {}).get(note.name), parts[note.name]
                all_drawn = diverse is not None and note.draws >= diverse.candidates
                candidates = spec.candidates_of(self._shares[note.name]) if all_drawn else 0
                raise NotFound(too_few(note, available, self._limit(note.name), candidates))
        return Dataset.open(self._folder)

    def _limit(self, name: str) -> int:
        """Return the limit on draws for a part."""
        return self._spec.draws_of(self._shares[name], self._max_draws)

    def _resumed(self, request: Manifest) -> Manifest:
        """Return the manifest from which the run continues; it is complete if there is nothing to do."""
        spec, shares = self._spec, self._shares
        manifest = DATASET.read(self._folder) or request
        if manifest.identity != request.identity:
            raise OutputError(f"{self._folder}: is a dataset {manifest.difference(request)}; give a new folder")
        for note in manifest.parts:
            rows = note.rows("tasks") + (note.tail.rows("tasks") if note.tail else 0)
            enough = spec.cover and spec.tasks >= manifest.spec.tasks
            if rows > spec.tasks_of(shares[note.name]) and not enough:
                has = f"has {plural(manifest.rows('tasks'), 'task')} already; request at least as many"
                raise QueryError(f"{self._folder}: {has}, or give a new folder")
        for note in manifest.parts:
            note.requested = spec.tasks_of(shares[note.name])
            more = note.rows("tasks") < note.requested and note.draws < self._limit(note.name)
            stopped = bool(manifest.cover and manifest.cover.missing)  # perhaps by a limit of draws
            more |= bool(spec.cover) and (not manifest.complete or (stopped and note.draws < (self._max_draws or inf)))
            if more and note.draws < number_of(note.size):
                manifest.complete = False
                if note.shards and not note.shards[-1].full:
                    note.tail = note.shards.pop()
        manifest.complete = manifest.complete and manifest.spec.tasks == spec.tasks
        if not manifest.complete:
            manifest.spec, manifest.versions = spec, versions()
            write_manifest(self._folder, manifest)
            write_snapshot(self._folder, self._files)
        return manifest

    def _make(self, parts: Mapping[str, TaskOrder]) -> None:
        """Write the missing tasks of all parts, and the dataset card."""
        from prag_asp.dataset.store.shard_writer import PartWriter

        spec = self._spec
        results = []  # results of draws that an interrupted run wrote to the journal after the last shard
        for line in self._journal.lines:
            with suppress(msgspec.MsgspecError):
                results.append(msgspec.json.decode(line, type=DrawResult))
        for note in self._manifest.parts:
            writer = PartWriter(self._folder, note, spec.shard)
            choice = self._fill(writer, parts[note.name], [result for result in results if result.part == note.name])
            note.requested = max(note.requested, writer.tasks)  # more tasks may be needed to cover combinations
            if not writer.empty:
                writer.write()
                write_manifest(self._folder, self._manifest)
            if choice is not None:
                from prag_asp.dataset.store.tables import TableReader  # needs pyarrow

                rows = TableReader(self._folder).rows(note, "tasks", ["draw", "plan"])
                record_figures(self._manifest, note.name, choice.figures(rows))
            remove_after(self._folder / RECORDINGS / note.name, note.rows("tasks") * spec.starts)
        write_card(self._folder, self._manifest, self._space.domain)
        self._manifest.complete = True
        write_manifest(self._folder, self._manifest)

    def _fill(self, writer: PartWriter, part: TaskOrder, journaled: list[DrawResult]) -> DrawChoice | None:
        """Add draws to a part until it has the requested tasks, or until the limit on draws is reached.

        Return the choice of draws, or None if all of them are sampled.
        """
        note, spec, limit = writer.note, self._spec, min(self._limit(writer.note.name), part.size)
        choice = choice_of(self._space, spec, part, spec.candidates_of(self._shares[note.name]))
        if choice is None:
            self._add(writer, part, journaled, note.requested, limit)
            return None
        requested, most = note.requested, limit
        if spec.cover:
            requested, most = part.size, min(self._max_draws or part.size, part.size)
        written = [*note.shards, *([note.tail] if note.tail and writer.next > note.tail.first else [])]
        from prag_asp.dataset.store.tables import TableReader  # needs pyarrow

        tables = TableReader(self._folder)
        passed = {row["draw"] for shard in written for row in tables.of_shard("tasks", shard, ["draw"])}
        while writer.tasks < requested and writer.next < most:
            if writer.next >= len(choice.draws) and not choice.extend(passed):
                break
            results = [result for result in journaled if result.draw >= writer.next]
            passed |= self._add(writer, ListedOrder(choice.draws), results, requested, min(most, len(choice.draws)))
        rest = choice.rest
        if rest is not None and writer.tasks < note.requested and writer.next >= len(choice.draws):
            results = [result for result in journaled if result.draw >= writer.next]
            order, first = FollowingOrder(rest, len(choice.draws)), len(choice.draws)
            self._add(writer, order, results, note.requested, min(self._max_draws or limit + first, part.size))
        return choice

    def _add(
        self, writer: PartWriter, part: TaskOrder, journaled: list[DrawResult], requested: int, limit: int
    ) -> set[int]:
        """Add draws to a part until it has the requested tasks or `limit` draws; return the feasible draws."""
        note, parts, passed = writer.note, self._parts, set[int]()
        plan = DrawPlan(self._spec.deal) if parts is None else parts.plan(note.name)
        with closing(self._records(writer, part, plan, journaled, limit)) as records:
            while writer.tasks < requested and writer.next < limit:
                holder = plan.holder(writer.next)
                if holder is not None and parts is not None:
                    rows = parts.draw(note.name, holder)
                    copies = [self._copy_recording(writer, row, parts.folder(holder)) for row in rows.recordings]
                    writer.take(rows._replace(recordings=copies))
                elif (record := next(records, None)) is not None:
                    result, job_result = record.result, record.job_result
                    passed |= {result.draw} if result.passed else set()
                    if job_result is not None:
                        for number, (start, content) in enumerate(
                            zip(result.starts, job_result.recordings, strict=False)
                        ):
                            if start.recording is not None and content is not None:
                                start.recording.file = self._write_recording(writer, number, content)
                        self._journal.write(result.to_json() if any(job_result.recordings) else job_result.result)
                    if record.task is not None:
                        writer.add(record.placed, record.task[0], result, record.task[1])
                    elif job_result is not None and job_result.row is not None:
                        writer.add_row(record.placed, job_result.row, result)
                else:
                    return passed
                done = sum(each.rows("tasks") for each in self._manifest.parts if each is not note) + writer.tasks
                words = f"{plural(done, 'task')} of {plural(writer.next, 'draw')}"
                self._progress(words, done, sum(each.requested for each in self._manifest.parts))
                if writer.full:
                    writer.write()
                    write_manifest(self._folder, self._manifest)
                    self._journal.clear()
        return passed

    def _records(
        self, writer: PartWriter, part: TaskOrder, plan: DrawPlan, journaled: list[DrawResult], limit: int
    ) -> Generator[DrawRecord, None, None]:
        """Yield the draws of a part that this run validates; the results of the first ones may be `journaled`."""
        numbers, again = tee(plan.missing(writer.next, limit))
        drawn = zip(numbers, part.pick(again), strict=False)
        first = list(islice(drawn, len(journaled)))
        done = list(takewhile(lambda pair: pair[0][0] == pair[1].draw, zip(first, journaled, strict=False)))
        for ((_, placed), result), task in zip(done, self._tasks(placed for (_, placed), _ in done), strict=True):
            yield DrawRecord(placed, result, (task, self._captioner(task, result.colours)))
        yield from self._validated(writer.note.name, plan, chain(first[len(done) :], drawn))

    def _validated(
        self, name: str, plan: DrawPlan, drawn: Iterator[tuple[int, RankedDraw]]
    ) -> Generator[DrawRecord, None, None]:
        """Yield numbered draws of a part, validated by the executor."""
        from prag_asp.dataset.scenes import scene_of

        submitted: deque[tuple[RankedDraw, Task | None]] = deque()

        def jobs() -> Iterator[ValidationJob]:
            if self._executor.captions:
                for number, placed in drawn:
                    submitted.append((placed, None))
                    yield ValidationJob(number, plan.search_index(number), placed)
                return
            ours, theirs = tee(drawn)
            for (number, placed), task in zip(ours, self._tasks(placed for _, placed in theirs), strict=True):
                submitted.append((placed, task))
                yield ValidationJob(number, plan.search_index(number), task)

        domain, lengths = self._space.domain, self._space.lengths
        clauses = tuple(str(clause) for clause in self._space.condition.clauses)
        scene = None if self._spec.budget is None else scene_of(domain)
        decoded = (domain, lengths, clauses) if self._executor.captions else None
        setup = ValidationSetup(name, self._spec, scene, decoded)
        with closing(self._executor.run(jobs(), setup)) as results:
            for each in results:
                placed, task = submitted.popleft()
                result = msgspec.json.decode(each.result, type=DrawResult)
                texts = None if task is None else (task, self._captioner(task, result.colours))
                yield DrawRecord(placed, result, texts, each)

    def _tasks(self, placed: Iterable[RankedDraw]) -> Iterator[Task]:
        """Yield the tasks of draws; their states are computed in batches."""
        return (task for _, task in with_tasks(self._space, placed))

    def _write_recording(self, writer: PartWriter, start: int, content: bytes) -> str:
        """Write the recording from an initial state of the next task, and return the path of its file."""
        folder = f"{RECORDINGS}/{writer.note.name}"
        name = name_of(writer.tasks * self._spec.starts + start + 1)
        replace_file(file_in(make_folder(self._folder / folder), name), content)
        return f"{folder}/{name}"

    def _copy_recording(self, writer: PartWriter, row: Mapping[str, Any], folder: Path) -> Mapping[str, Any]:
        """Copy the recording from an initial state of the next task, and return its row."""
        path = folder / str(row["file"])
        try:
            content = read_bytes(path, within=folder)
        except OSError as error:
            raise QueryError(f"{path}: cannot be read: {error.strerror or error}; {MEND}") from None
        if sha256(content).hexdigest() != row["sha256"]:
            raise QueryError(f"{path}: differs from the file that was written; {MEND}")
        return {**row, "file": self._write_recording(writer, row["start"], content)}


def too_few(part: PartManifest, available: TaskOrder, limit: int, candidates: int = 0) -> str:
    """Return the message about a part with fewer tasks than requested, with the reason.

    `candidates` is the number of candidates from which the tasks were chosen, if all candidates have been drawn.
    """
    draws = plural(part.draws, "draw")
    summary = f"only {part.tasks} of {plural(part.requested, 'task')} for {part.name} found in {draws}"
    tallies = [tally for shard in part.shards for tally in shard.tally]
    trivial = sum(tally.trivial for tally in tallies)
    if trivial and part.draws in {trivial, available.size}:
        return f"{summary}, {trivial} of them trivial: {TRIVIAL}; keep these with --trivial"
    if part.draws >= limit:
        proved = sum(tally.infeasible for tally in tallies)
        if proved == part.draws - trivial:
            which = "all proved infeasible" if not trivial else f"all but {trivial} trivial ones proved infeasible"
            return f"{summary}, {which}; change the domain or its scene, or see prag-asp learn"
        if 2 * proved > part.draws:
            return f"{summary}, {proved} of them proved infeasible; see prag-asp learn, which excludes such tasks"
        return f"{summary}; raise --max-draws" if part.tasks else f"{summary}; raise --budget or --max-draws"
    ends = "; the other tasks have almost no weight: give other weights, or --uniform"
    if candidates:
        few = candidates < available.size
        ends = f", all nontrivial {'candidates; raise --candidates' if few else 'tasks of the space'}"
    elif part.draws >= available.size:
        ends = ", the whole space"
    return summary + ends
