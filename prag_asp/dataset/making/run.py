"""One run that makes a data set, or goes on with it: draws are looked at somewhere, and written here alone."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass
from hashlib import sha256
from itertools import chain, islice, takewhile, tee
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from prag_asp.dataset.dataset_spec import Wanted
from prag_asp.dataset.episode_files import name_of, remove_after
from prag_asp.dataset.making.executors import Place
from prag_asp.dataset.making.preconditions import JOURNAL, difference, require_ours, too_few
from prag_asp.dataset.pages.dataset_card import write_card
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.domain_snapshot import MEND, KeptDomain, write_kept
from prag_asp.dataset.store.draw_results import Looked
from prag_asp.dataset.store.instructions import Told, telling_of
from prag_asp.dataset.store.manifest import (
    FORMAT,
    VERSION,
    Asked,
    Manifest,
    PartNote,
    SpaceNote,
    read_manifest,
    require_parts,
    write_manifest,
)  # fmt: skip
from prag_asp.dataset.validation_jobs import Draw, Found, Look, Telling
from prag_asp.errors import NotFound, OutputError, QueryError
from prag_asp.integers import digits_of, number_of
from prag_asp.output import Lines, file_in, make_folder, replace_file
from prag_asp.output.digests import digest
from prag_asp.processes.workers import uninterrupted
from prag_asp.safe_reading import read_bytes
from prag_asp.space.distinct_sampling import TaskOrder
from prag_asp.space.without_replacement import ordered_parts, with_tasks
from prag_asp.versions import versions
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.making.part_merge import Jobs
    from prag_asp.dataset.store.shard_writer import PartWriter
    from prag_asp.space.distinct_sampling import RankedDraw
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

RECORDINGS = "demonstrations"
"""The folder of recordings, beside that of the table that has one row for each."""

Progress = Callable[[str, int, int], None]
"""Is told how far things are: in words, how many tasks there are, and how many there are to be."""


@dataclass(frozen=True)
class Content:
    """What is known of a draw, as it is written, and what was found just now, None where the journal has had it.

    It is told as a task, in words, or has a row already.
    """

    placed: RankedDraw
    looked: Looked
    told: tuple[Task, Told] | None
    found: Found | None = None


class Run:
    """Makes the data set of a space in a folder; with `jobs`, of what others have looked at, as far as that goes."""

    def __init__(
        self,
        space: TaskSpace,
        folder: Path,
        wanted: Wanted,
        kept: tuple[KeptDomain, dict[str, bytes]],
        place: Place,
        progress: Progress,
        jobs: Jobs | None = None,
    ) -> None:
        self._space, self._folder, self._wanted, self._place = space, folder, wanted, place
        self._told, self._files = kept
        self._progress, self._jobs = progress, jobs

    def done(self) -> Dataset:
        """Make the data set and open it.

        Raises:
            PragError: as `generate` does.
        """
        wanted, shares = self._wanted, self._wanted.division.shares
        asked = wanted.asked(self._space)
        self._telling = telling_of(self._space.domain, wanted.language, wanted.seed, wanted.phrasings)
        identity = digest([msgspec.to_builtins(self._told), msgspec.to_builtins(asked)])
        require_ours(self._folder)
        parts = ordered_parts(
            self._space, wanted.division, seed=wanted.seed,
            weights=self._space.weights(wanted.weights, wanted.temperature), evenly=wanted.evenly, deal=wanted.deal,
        )  # fmt: skip
        make_folder(self._folder)
        self._journal = Lines(self._folder / JOURNAL, identity)
        try:
            self._manifest = self._taken_up(parts, identity, asked)
            if not self._manifest.complete:
                self._make(parts)
            with uninterrupted():
                self._journal.restart()
        finally:
            with uninterrupted():
                self._journal.suspend()
                self._journal.close()
        for note in self._manifest.parts:
            dealt_out = asked.part is not None and note.draws >= number_of(note.size)  # others may have what is missing
            if note.tasks < note.wanted and not dealt_out:
                raise NotFound(too_few(note, parts[note.name], wanted.draws(shares[note.name])))
        return Dataset.open(self._folder)

    def _taken_up(self, parts: Mapping[str, TaskOrder], identity: str, asked: Asked) -> Manifest:
        """Return what dataset.json says, which is complete where nothing is to be done.

        Raises:
            OutputError: it is of another data set.
            QueryError: it is damaged, or has more tasks than are wanted.
        """
        wanted, shares = self._wanted, self._wanted.division.shares
        manifest = read_manifest(self._folder)
        if manifest is None:
            spaces = [SpaceNote(length, digits_of(self._space.at(length).count())) for length in asked.lengths]
            notes = [PartNote(name, digits_of(part.size), 0) for name, part in parts.items()]
            manifest = Manifest(FORMAT, VERSION, False, identity, 0, asked, self._told, spaces, notes)
        elif manifest.identity != identity:
            raise OutputError(f"{self._folder}: {difference(manifest, self._told.name, asked)}; give a new folder")
        else:
            require_parts(manifest, self._folder)
        for note in manifest.parts:
            rows = note.rows("tasks") + (note.tail.rows("tasks") if note.tail else 0)
            if rows > wanted.of(shares[note.name]):
                told = f"has {plural(manifest.rows('tasks'), 'task')} already; ask for at least as many"
                raise QueryError(f"{self._folder}: {told}, or give a new folder")
        for note in manifest.parts:
            note.wanted = wanted.of(shares[note.name])
            more = note.rows("tasks") < note.wanted and note.draws < wanted.draws(shares[note.name])
            if more and note.draws < number_of(note.size):
                manifest.complete = False
                if note.shards and not note.shards[-1].full:
                    note.tail = note.shards.pop()
        manifest.complete = manifest.complete and manifest.wanted == wanted.tasks
        if not manifest.complete:
            manifest.wanted, manifest.versions = wanted.tasks, versions()
            write_manifest(self._folder, manifest)
            write_kept(self._folder, self._files)
        return manifest

    def _make(self, parts: Mapping[str, TaskOrder]) -> None:
        """Write what is missing."""
        from prag_asp.dataset.store.shard_writer import PartWriter

        wanted = self._wanted
        left = list(self._left())
        for note in self._manifest.parts:
            writer = PartWriter(self._folder, note, wanted.shard)
            self._fill(writer, parts[note.name], [looked for looked in left if looked.part == note.name])
            if not writer.empty:
                writer.write()
                write_manifest(self._folder, self._manifest)
            remove_after(self._folder / RECORDINGS / note.name, note.rows("tasks") * wanted.starts)
        write_card(self._folder, self._manifest, self._space.domain)
        self._manifest.complete = True
        write_manifest(self._folder, self._manifest)

    def _left(self) -> Iterator[Looked]:
        """Yield what a run that was broken off has noted of draws since the last shard."""
        with suppress(FileNotFoundError), self._journal.part.open("rb") as lines:
            for line in lines:
                with suppress(msgspec.MsgspecError):
                    yield msgspec.json.decode(line, type=Looked)

    def _fill(self, writer: PartWriter, part: TaskOrder, left: list[Looked]) -> None:
        """Add draws to a part until it has its tasks, or is given up."""
        wanted, note, jobs = self._wanted, writer.note, self._jobs
        limit = min(wanted.draws(wanted.division.shares[note.name]), part.size)
        with closing(self._contents(writer, part, left, limit)) as contents:
            while writer.tasks < note.wanted and writer.next < limit:
                if jobs is not None and jobs.have(note.name, writer.next):
                    given = jobs.draw(note.name, writer.next)
                    rows = [self._copied(writer, row, jobs.folder(writer.next)) for row in given.recordings]
                    writer.take(given._replace(recordings=rows))
                elif (content := next(contents, None)) is not None:
                    looked = self._noted(writer, content)
                    if content.told is not None:
                        writer.add(content.placed, content.told[0], looked, content.told[1])
                    elif content.found is not None and content.found.row is not None:
                        writer.add_row(content.placed, content.found.row, looked)
                else:
                    return
                self._added(writer)

    def _added(self, writer: PartWriter) -> None:
        """Tell of a draw that was added to a part, and write a shard that is full."""
        done = sum(note.rows("tasks") for note in self._manifest.parts if note is not writer.note) + writer.tasks
        words = f"{plural(done, 'task')} of {plural(writer.next, 'draw')}"
        self._progress(words, done, sum(note.wanted for note in self._manifest.parts))
        if writer.full:
            writer.write()
            write_manifest(self._folder, self._manifest)
            self._journal.restart()

    def _contents(
        self, writer: PartWriter, part: TaskOrder, left: list[Looked], limit: int
    ) -> Generator[Content, None, None]:
        """Yield what is known of the draws of a part that nobody else has looked at: some is `left` in the journal."""
        name, jobs = writer.note.name, self._jobs
        lacking = [range(writer.next, limit)] if jobs is None else jobs.lacking(name, writer.next, limit)
        numbers, again = tee(chain.from_iterable(lacking))
        drawn = zip(numbers, part.pick(again), strict=False)
        first = list(islice(drawn, len(left)))
        known = list(takewhile(lambda pair: pair[0][0] == pair[1].draw, zip(first, left, strict=False)))
        for ((_, placed), looked), task in zip(known, self._tasks(placed for (_, placed), _ in known), strict=True):
            yield Content(placed, looked, (task, self._telling(task, looked.colours)))
        yield from self._found(name, chain(first[len(known) :], drawn))

    def _found(self, name: str, drawn: Iterator[tuple[int, RankedDraw]]) -> Generator[Content, None, None]:
        """Yield what is found of numbered draws of a part, where they are looked at."""
        handed: deque[tuple[RankedDraw, Task | None]] = deque()
        whole = self._wanted.deal.whole

        def draws() -> Iterator[Draw]:
            if self._place.tells:
                for number, placed in drawn:
                    handed.append((placed, None))
                    yield Draw(number, whole(number), placed)
                return
            ours, theirs = tee(drawn)
            for (number, placed), task in zip(ours, self._tasks(placed for _, placed in theirs), strict=True):
                handed.append((placed, task))
                yield Draw(number, whole(number), task)

        with closing(self._place.look(draws(), self._look(name))) as found:
            for each in found:
                placed, task = handed.popleft()
                looked = msgspec.json.decode(each.looked, type=Looked)
                told = None if task is None else (task, self._telling(task, looked.colours))
                yield Content(placed, looked, told, each)

    def _tasks(self, placed: Iterable[RankedDraw]) -> Iterator[Task]:
        """Yield draws as tasks, which are told many together."""
        return (task for _, task in with_tasks(self._space, placed))

    def _look(self, part: str) -> Look:
        """Return how the draws of a part are looked at.

        Raises:
            SceneError: the domain has no scene, or a Python file of it is not trusted, or fails.
        """
        from prag_asp.dataset.scenes import scene_of

        wanted, space = self._wanted, self._space
        domain, where = space.domain, tuple(str(clause) for clause in space.condition.clauses)
        scene = None if wanted.budget is None else scene_of(domain)
        telling = None
        if self._place.tells:
            telling = Telling(domain, space.lengths, where, wanted.language, wanted.seed, wanted.phrasings)
        return Look(part, wanted.seed, wanted.budget, scene, wanted.starts, wanted.staging, telling)

    def _noted(self, writer: PartWriter, content: Content) -> Looked:
        """Return what is known of a draw with the files of its recordings, and note it in the journal if it is new."""
        looked, found = content.looked, content.found
        if found is None:
            return looked
        for number, (start, recording) in enumerate(zip(looked.starts, found.recordings, strict=False)):
            if start.recording is not None and recording is not None:
                start.recording.file = self._recorded(writer, number, recording)
        line = msgspec.json.encode(looked) if any(found.recordings) else found.looked
        self._journal.write(line.decode())
        return looked

    def _recorded(self, writer: PartWriter, start: int, content: bytes) -> str:
        """Write the recording from a first state of the next task, and return the path of its file."""
        folder = f"{RECORDINGS}/{writer.note.name}"
        name = name_of(writer.tasks * self._wanted.starts + start + 1)
        replace_file(file_in(make_folder(self._folder / folder), name), content)
        return f"{folder}/{name}"

    def _copied(self, writer: PartWriter, row: Mapping[str, Any], folder: Path) -> Mapping[str, Any]:
        """Copy the recording from a first state of the next task, and return its row.

        Raises:
            QueryError: it cannot be read, or is not what its table says.
        """
        path = folder / str(row["file"])
        try:
            content = read_bytes(path, within=folder)
        except OSError as error:
            raise QueryError(f"{path}: cannot be read: {error.strerror or error}; {MEND}") from None
        if sha256(content).hexdigest() != row["sha256"]:
            raise QueryError(f"{path}: is not the file that was written; {MEND}")
        return {**row, "file": self._recorded(writer, row["start"], content)}
