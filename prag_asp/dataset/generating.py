"""Make a data set: draw without replacement, look at each task by physics, write it down."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import closing, suppress
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.recordings import Recordings, remove_after
from prag_asp.dataset.store.card import write_card
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.kept import digest_of, kept, write_kept
from prag_asp.dataset.store.looked import Looked, Recorded, Start
from prag_asp.dataset.store.manifest import (
    FORMAT,
    VERSION,
    Asked,
    Manifest,
    PartNote,
    SpaceNote,
    read_manifest,
    write_manifest,
)  # fmt: skip
from prag_asp.dataset.store.refusals import JOURNAL, difference, require_ours, too_few
from prag_asp.dataset.store.told import telling_of
from prag_asp.dataset.wanted import SHARD, Wanted
from prag_asp.domain.identity import digest
from prag_asp.errors import NotFound, OutputError, QueryError
from prag_asp.missing import require_pyarrow
from prag_asp.output import Lines, make_folder
from prag_asp.physics import Budget, require_physics
from prag_asp.processes.children import uninterrupted
from prag_asp.space.ordered import Division, Ordered, at, ordered_parts, tell
from prag_asp.versions import versions
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.looking import Drawn
    from prag_asp.dataset.store.writing import PartWriter
    from prag_asp.physics import Staging, Verdict
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.space.task_spaces import TaskSpaces
    from prag_asp.space.weighing.temperature import Temperature
    from prag_asp.space.weighing.weights import Number

RECORDINGS = "demonstrations"
"""The folder of recordings, beside that of the table that has one row for each."""

Told = Callable[[str, int, int], None]
"""Is told how far things are: in words, how many tasks there are, and how many there are to be."""


def generate(
    space: TaskSpace | TaskSpaces,
    folder: str | Path,
    *,
    tasks: int,
    seed: int = 0,
    split: Mapping[str, Number | float] | None = None,
    skeletons: bool = False,
    hold_out: str | None = None,
    starts: int = 1,
    demonstrate: bool = False,
    evenly: bool = False,
    weights: Mapping[str, Number] | None = None,
    temperature: Temperature = 1,
    physics: bool | None = None,
    budget: Budget | None = None,
    workers: int = 1,
    shard: int = SHARD,
    language: str = "en",
    staging: Staging | None = None,
    max_draws: int | None = None,
    progress: Told = lambda words, done, total: None,
) -> Dataset:
    """Write a data set of so many different feasible tasks into a folder, and open it.

    Tasks are drawn without replacement, by the weights of the domain unless others are given; lengths have their exact
    share or come `evenly`. With `split`, each part gets its share of the tasks, and no two parts have a task (with
    `skeletons`: a skeleton) in common; with `hold_out`, only ``test`` has something. `starts` are the first states
    that a witness is looked for from, for each task. With `demonstrate`, the robot performs each, with what `staging`
    asks for: cameras that film, and what varies. Without `physics`, which is asked where the domain has a scene, all
    tasks are taken as they are drawn. Instructions are in a `language` of the domain.

    What was begun goes on; a larger number of `tasks` adds to what is there. All depends on the seed alone, not on the
    number of `workers`. A `shard` holds so many tasks at most.

    Raises:
        QueryError: there is nothing to draw, or the draw is asked for in a wrong way.
        SceneError: the domain has no scene, or a task speaks of something for which the scene has no shape.
        OutputError: the folder holds something else, or a file cannot be written.
        NotFound: fewer tasks are found in `max_draws` draws a part, or there are no more; those found are written.
        WorkerError: workers died again and again.
        DatasetsMissingError: pyarrow is not installed.
    """
    require_pyarrow()
    if physics is None:
        physics = bool(space.domain.settings.scene)
    if not physics and (demonstrate or starts > 1 or budget is not None):
        raise QueryError("demonstrations, first states and a budget need physics; leave them out")
    if physics:
        require_physics()
    if staging is not None:
        _require_cameras(staging, space, demonstrate)
    chosen = _budget(budget, demonstrate) if physics else None
    division = Division.parse(split, skeletons=skeletons, hold_out=hold_out)
    wanted = Wanted(
        tasks, seed, division, chosen, starts, demonstrate, evenly, weights, temperature, shard, language, staging,
        max_draws,
    )  # fmt: skip
    return _Run(space, Path(folder), wanted, workers, progress).done()


def _budget(given: Budget | None, demonstrate: bool) -> Budget:
    """Return a budget with the tier of demonstrations where these are to be recorded."""
    budget = given or Budget()
    return Budget(budget.restarts, budget.samples, "demonstration") if demonstrate else budget


class _Run:
    """One run that makes a data set, or goes on with it."""

    def __init__(
        self, space: TaskSpace | TaskSpaces, folder: Path, wanted: Wanted, workers: int, progress: Told
    ) -> None:
        self._space, self._folder, self._wanted, self._workers = space, folder, wanted, workers
        self._progress = progress

    def done(self) -> Dataset:
        """Make the data set and open it.

        Raises:
            PragError: as `generate` does.
        """
        asked = self._wanted.asked(self._space)
        self._telling = telling_of(self._space.domain, self._wanted.language, self._wanted.seed)
        self._told, self._files = kept(self._space.domain)
        identity = digest([msgspec.to_builtins(self._told), msgspec.to_builtins(asked)])
        require_ours(self._folder)
        wanted = self._wanted
        parts = ordered_parts(
            self._space, wanted.division, seed=wanted.seed, weights=wanted.weights, temperature=wanted.temperature,
            evenly=wanted.evenly,
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
            if note.tasks < note.wanted:
                raise NotFound(too_few(note, parts[note.name], wanted.draws(wanted.division.shares[note.name])))
        return Dataset.open(self._folder)

    def _taken_up(self, parts: Mapping[str, Ordered], identity: str, asked: Asked) -> Manifest:
        """Return what dataset.json says, which is complete where nothing is to be done.

        Raises:
            OutputError: it is of another data set.
            QueryError: it is damaged, or has more tasks than are wanted.
        """
        wanted, shares = self._wanted, self._wanted.division.shares
        manifest = read_manifest(self._folder)
        if manifest is None:
            spaces = [SpaceNote(length, str(at(self._space, length).count())) for length in asked.lengths]
            notes = [PartNote(name, str(part.size), 0) for name, part in parts.items()]
            manifest = Manifest(FORMAT, VERSION, False, identity, 0, asked, self._told, spaces, notes)
        elif manifest.identity != identity:
            raise OutputError(f"{self._folder}: {difference(manifest, self._told.name, asked)}; give a new folder")
        for note in manifest.parts:
            rows = note.rows("tasks") + (note.tail.rows("tasks") if note.tail else 0)
            if rows > wanted.of(shares[note.name]):
                told = f"has {plural(manifest.rows('tasks'), 'task')} already; ask for at least as many"
                raise QueryError(f"{self._folder}: {told}, or give a new folder")
        for note in manifest.parts:
            note.wanted = wanted.of(shares[note.name])
            more = note.rows("tasks") < note.wanted and note.draws < wanted.draws(shares[note.name])
            if more and note.draws < int(note.size):
                manifest.complete = False
                if note.shards and not note.shards[-1].full:
                    note.tail = note.shards.pop()
        manifest.complete = manifest.complete and manifest.wanted == wanted.tasks
        if not manifest.complete:
            manifest.wanted, manifest.versions = wanted.tasks, versions()
            write_manifest(self._folder, manifest)
            write_kept(self._folder, self._files)
        return manifest

    def _make(self, parts: Mapping[str, Ordered]) -> None:
        """Write what is missing."""
        from prag_asp.dataset.store.writing import PartWriter

        wanted = self._wanted
        left = list(self._left())
        for note in self._manifest.parts:
            writer = PartWriter(self._folder, self._telling, note, wanted.shard)
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

    def _fill(self, writer: PartWriter, part: Ordered, left: list[Looked]) -> None:
        """Add draws to a part until it has its tasks, or is given up."""
        wanted, note = self._wanted, writer.note
        limit = wanted.draws(wanted.division.shares[note.name])
        numbered = (
            (number, placed, task)
            for number, (placed, task) in enumerate(tell(self._space, part.draws(writer.next)), writer.next)
        )
        drawn: Iterator[Drawn] = islice(numbered, limit - writer.next)
        for looked in left:
            if writer.tasks < note.wanted and looked.draw == writer.next and (draw := next(drawn, None)) is not None:
                self._add(writer, draw, looked)
        if writer.tasks >= note.wanted:
            return
        with closing(self._looked(writer, drawn)) as found:
            for draw, looked in found:
                self._journal.write(msgspec.json.encode(looked).decode())
                self._add(writer, draw, looked)
                if writer.tasks >= note.wanted:
                    return

    def _add(self, writer: PartWriter, draw: Drawn, looked: Looked) -> None:
        """Add a draw to a part, and write a shard that is full."""
        _, placed, task = draw
        writer.add(placed, task, looked)
        done = sum(note.rows("tasks") for note in self._manifest.parts if note is not writer.note) + writer.tasks
        words = f"{plural(done, 'task')} of {plural(writer.next, 'draw')}"
        self._progress(words, done, sum(note.wanted for note in self._manifest.parts))
        if writer.full:
            writer.write()
            write_manifest(self._folder, self._manifest)
            self._journal.restart()

    def _looked(self, writer: PartWriter, drawn: Iterator[Drawn]) -> Generator[tuple[Drawn, Looked], None, None]:
        """Yield draws with what physics says of them; without physics, all of them pass."""
        wanted, name = self._wanted, writer.note.name
        if wanted.budget is None:
            for draw in drawn:
                yield draw, Looked(name, draw[0], None, [])
            return
        from prag_asp.dataset.looking import Look, looked_at
        from prag_asp.dataset.scenes import scene_of

        scene = scene_of(self._space.domain)
        look = Look(scene, wanted.seed, wanted.budget, wanted.starts, self._workers, wanted.staging)
        with closing(looked_at(drawn, look)) as found:
            for draw, verdicts in found:
                yield draw, self._noted(writer, draw[0], verdicts)

    def _noted(self, writer: PartWriter, draw: int, verdicts: list[Verdict]) -> Looked:
        """Return what the verdicts on a draw say, their demonstrations recorded."""
        first = verdicts[0].to_json()
        texts = [first.pop("witness")]
        texts += [None if each.witness is None else each.witness.to_json() for each in verdicts[1:]]
        starts = []
        for number, (verdict, text) in enumerate(zip(verdicts, texts, strict=True)):
            witness = msgspec.Raw(msgspec.json.encode(text))
            starts.append(Start(verdict.index, witness, self._recorded(writer, number, verdict)))
        return Looked(writer.note.name, draw, first, starts)

    def _recorded(self, writer: PartWriter, start: int, verdict: Verdict) -> Recorded | None:
        """Write the demonstration from a first state of the next task, and return what is told of it."""
        demonstration = verdict.demonstration
        if demonstration is None:
            return None
        folder = f"{RECORDINGS}/{writer.note.name}"
        number = writer.tasks * self._wanted.starts + start + 1
        file = f"{folder}/{Recordings(self._folder / folder).write(number, demonstration)}"
        ends = [int(frame) for frame in demonstration.ends]
        seconds = float(demonstration.times[-1])
        return Recorded(file, digest_of(self._folder / file), len(demonstration.times), seconds, ends)


def _require_cameras(staging: Staging, space: TaskSpace | TaskSpaces, demonstrate: bool) -> None:
    """Check that what is staged can be, before anything is written.

    Raises:
        QueryError: nothing is demonstrated, the scene has no such camera, or colours vary, of which instructions speak.
        SceneError: the domain has no scene.
    """
    from prag_asp.dataset.filtering import require_demonstrated
    from prag_asp.dataset.scenes import scene_of

    require_demonstrated(staging, "" if demonstrate else None)
    if "colour" in staging.vary:
        raise QueryError("instructions speak of the colours of the scene; leave colour out of what varies")
    staging.cameras_of(scene_of(space.domain))
