"""A dataset on disk, read lazily."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.dataset.store.domain_snapshot import load_snapshot
from prag_asp.dataset.store.entry import DatasetEntry, entry_of, task_of
from prag_asp.dataset.store.manifest import DATASET, NAME, Manifest, PartManifest
from prag_asp.errors import PragError, QueryError
from prag_asp.integers import number_of
from prag_asp.missing import require_pyarrow
from prag_asp.safe_reading import is_inside
from prag_asp.tables.json_fields import decoded
from prag_asp.wording import unknown

if TYPE_CHECKING:
    from prag_asp.dataset.scenario import Scenario
    from prag_asp.dataset.scenarios import Scenarios
    from prag_asp.dataset.store.tables import TableReader
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Demonstration, Witness
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task


SHOWN_TASKS, LARGEST_SHOWN = 5, 30_000_000
"""The number of tasks of a dataset in a notebook, and the maximum size in bytes of an episode with images there."""


@dataclass(frozen=True)
class Dataset:
    """The tasks in a folder written by `generate`; tables are read lazily.

    The tasks of all `parts` are numbered in order, from 0. `manifest` holds the contents of dataset.json. Only tasks
    that satisfy the `conditions` are returned.
    """

    folder: Path
    manifest: Manifest = field(repr=False)
    trust: bool = field(default=False, repr=False)
    parts: tuple[str, ...] = ()
    conditions: tuple[str, ...] = ()

    @classmethod
    def open(cls, folder: str | Path, *, trust: bool = False) -> Dataset:
        """Open the dataset in a folder; with `trust`, physics may run the Python files of the domain.

        Raises:
            QueryError: the folder has no dataset, or the dataset is damaged or incomplete.
            DatasetsMissingError: pyarrow is not installed.
        """
        require_pyarrow()
        path = Path(folder)
        manifest = DATASET.read(path)
        if manifest is None:
            raise QueryError(
                f"{path}: is not a dataset, because it has no {NAME}; make one with prag-asp generate -o {path}"
            )
        if not manifest.complete:
            raise QueryError(f"{path}: the run that writes it has not ended; resume it with the same command")
        return cls(path, manifest, trust, tuple(part.name for part in manifest.parts))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.folder, self.manifest, self.trust, self.parts, self.conditions)

    @cached_property
    def domain(self) -> Domain:
        """The domain of the tasks, loaded only from the files in the folder.

        Raises:
            DomainError: the files differ from their record in dataset.json.
        """
        return load_snapshot(self.folder, self.manifest.domain, trust=self.trust)

    def _repr_html_(self) -> str:
        """Return the dataset for a notebook: its parts and first tasks, read from dataset.json and one row group."""
        from prag_asp.html import element, fragment, scroll_table

        about = self.manifest
        rows = [(note.name, f"{note.rows('tasks'):,}", f"{number_of(note.size):,}", f"{note.draws:,}")
                for note in self._notes]  # fmt: skip
        tasks: list[tuple[str, str, str]] = []
        if not self.conditions:
            numbers = range(min(SHOWN_TASKS, self.count()))
            entries = [self.entry(number) for number in numbers]
            tasks = [(each.part, str(each.task), each.instruction["default"]) for each in entries]
        where = "".join(f", where {clause}" for clause in self.conditions)
        url = self._strip_url() if tasks and about.spec.staging is not None and about.spec.staging.cameras else None
        strip = [] if url is None else [element("img", src=url, alt="The first task: the end of each subgoal")]
        return fragment(
            element("p", element("strong", f"{self.folder}"), f": tasks of {about.domain.name}{where}"),
            scroll_table(("part", "tasks", "of", "sampled"), rows, label="Parts"),
            *([scroll_table(("part", "plan", "instruction"), tasks, label="First tasks")] if tasks else []),
            *strip,
        )

    def _strip_url(self) -> str | None:
        """Return camera images of the first episode as a data URL, or None if the file is missing, damaged or large."""
        from prag_asp.physics.demonstration.footage_strip import strip_url

        with suppress(PragError, OSError):
            file = self._start("recordings", 0, 0)["file"]
            if (self.folder / file).stat().st_size <= LARGEST_SHOWN:
                footage = self._recording(file).footage
                return None if footage is None else strip_url(footage)
        return None

    def part(self, name: str) -> Dataset:
        """Return the tasks of one part.

        Raises:
            QueryError: there is no such part.
        """
        if name not in self.parts:
            raise QueryError(unknown(name, self.parts, "part"))
        return replace(self, parts=(name,))

    def where(self, *conditions: str) -> Dataset:
        """Return the tasks that satisfy all given conditions, such as ``uses apple``.

        Raises:
            QueryError: a condition cannot be parsed, or names something that the domain does not have.
        """
        chosen = replace(self, conditions=(*self.conditions, *conditions))
        assert chosen._space  # reports an invalid condition immediately
        return chosen

    def count(self) -> int:
        """Return the number of tasks."""
        if self.conditions:
            return len(self._chosen)
        return sum(note.rows("tasks") for note in self._notes)

    def task(self, number: int) -> Task:
        """Return a task by its number.

        Raises:
            IndexError: there is no such task.
        """
        _, row = self._row(number)
        return task_of(row, self.manifest.domain.constants)

    def entry(self, number: int) -> DatasetEntry:
        """Return the entry of a task by its number.

        Raises:
            IndexError: there is no such task.
        """
        note, row = self._row(number)
        return self._entry(note, row)

    def tasks(self) -> Iterator[Task]:
        """Yield the tasks in order."""
        return (entry.task for entry in self.entries())

    def entries(self) -> Iterator[DatasetEntry]:
        """Yield the entry of each task, in order."""
        return (self._entry(note, row) for note, row in self._rows("tasks"))

    def rejected(self) -> Iterator[DatasetEntry]:
        """Yield the entry of each task that was rejected, in the order of the draws."""
        return (self._entry(note, row) for note, row in self._rows("rejected"))

    def by_rank(self, length: int, rank: int) -> DatasetEntry:
        """Return the entry of the task with a given rank among all tasks of a length.

        Raises:
            QueryError: the dataset does not contain such a task.
        """
        for note, row in self._ranked(length, rank):
            entry = self._entry(note, row)
            if self._fits(row["plan"]):
                return entry
        raise QueryError(f"{self.folder}: no task of length {length} with the rank {rank} in it")

    def witness(self, number: int, start: int = 0) -> Witness:
        """Return the witness of a task from one of its initial states.

        Raises:
            IndexError: there is no such task.
            QueryError: there is no such witness.
        """
        row = self._start("witnesses", number, start)
        return _witness(row["witness"])

    def witnesses(self) -> Iterator[tuple[DatasetEntry, int, Witness]]:
        """Yield each task, the number of an initial state, and the witness from it, in order."""
        for entry, row in self._starts("witnesses"):
            yield entry, row["start"], _witness(row["witness"])

    def task_scenario(self, number: int) -> Scenario:
        """Return the scenario of a task, without an initial state.

        Raises:
            IndexError: there is no such task.
        """
        _, row = self._row(number)
        return self._scenarios.ranked(self.manifest.where, row["length"], number_of(row["rank"]))

    def scenario(self, number: int, start: int = 0) -> Scenario:
        """Return the scenario of a task and an initial state; without physics, there is no initial state.

        Raises:
            IndexError: there is no such task.
            QueryError: there is no such initial state.
        """
        from prag_asp.dataset.scenario import SearchStart

        spec, (_, row) = self.manifest.spec, self._row(number)
        search = None
        if spec.budget is not None:
            index = self._start("witnesses", number, start)["index"]
            search = SearchStart.of(spec.seed, index, spec.budget, spec.staging)
        return self._scenarios.ranked(self.manifest.where, row["length"], number_of(row["rank"]), search)

    def demonstration(self, number: int, start: int = 0) -> Demonstration:
        """Return the recording of a task from one of its initial states.

        Raises:
            IndexError: there is no such task.
            QueryError: there is no such recording, or its file is damaged.
        """
        return self._recording(self._start("recordings", number, start)["file"])

    def demonstrations(self) -> Iterator[tuple[DatasetEntry, int, Demonstration]]:
        """Yield each task, the number of an initial state, and the recording from it, in order."""
        for entry, row in self._starts("recordings"):
            yield entry, row["start"], self._recording(row["file"])

    def recorded_seconds(self) -> Iterator[tuple[DatasetEntry, int, float]]:
        """Yield each recorded task, the number of an initial state, and the episode's duration in seconds, in order."""
        for entry, row in self._starts("recordings"):
            yield entry, row["start"], row["seconds"]

    @cached_property
    def _scenarios(self) -> Scenarios:
        from prag_asp.dataset.scenarios import Scenarios

        return Scenarios(self.domain)

    @cached_property
    def _notes(self) -> list[PartManifest]:
        return [note for note in self.manifest.parts if note.name in self.parts]

    def _entry(self, note: PartManifest, row: Mapping[str, Any]) -> DatasetEntry:
        return entry_of(row, note.name, self.manifest.domain.constants)

    def _row(self, number: int) -> tuple[PartManifest, Mapping[str, Any]]:
        """Return the part and the row of a task by its number."""
        if self.conditions:
            number = self._chosen[number]
        size = sum(note.rows("tasks") for note in self._notes)
        if not -size <= number < size:
            raise IndexError(f"task {number} of {size}")
        number %= size
        for note in self._notes:
            if number < note.rows("tasks"):
                break
            number -= note.rows("tasks")
        shard, place = self._tables.place(note, "tasks", number)
        return note, self._tables.row("tasks", shard, place)

    def _rows(self, table: str) -> Iterator[tuple[PartManifest, Mapping[str, Any]]]:
        """Yield the rows of a table of tasks that satisfy the conditions."""
        for note in self._notes:
            for row in self._tables.rows(note, table):
                if self._fits(row["plan"]):
                    yield note, row

    def _fits(self, plan: Sequence[str]) -> bool:
        return not self.conditions or plan in self._space.at(len(plan))

    @cached_property
    def _space(self) -> TaskSpace:
        """The tasks that satisfy the conditions."""
        from prag_asp.space.task_space import TaskSpace

        return TaskSpace(self.domain, 0).where(*self.conditions)

    @cached_property
    def _chosen(self) -> list[int]:
        """The indices of the tasks that satisfy the conditions, among all tasks of the parts."""
        plans = chain.from_iterable(self._tables.rows(note, "tasks", ["plan"]) for note in self._notes)
        return [number for number, row in enumerate(plans) if self._fits(row["plan"])]

    def _ranked(self, length: int, rank: int) -> Iterator[tuple[PartManifest, Mapping[str, Any]]]:
        """Yield the row of the task with a given rank, if the dataset has such a task.

        If all tasks are sampled uniformly and only tasks are split, the number of the draw follows from the rank.
        """
        from prag_asp.space.without_replacement import order_of

        spec, lengths = self.manifest.spec, [space.length for space in self.manifest.spaces if space.tasks != "0"]
        divided = spec.skeletons or spec.hold_out is not None or spec.strata
        selected = spec.excluded or spec.apart or spec.cover or spec.candidates
        uniform = not (spec.weights or spec.over or divided or selected)
        if uniform and (length not in lengths or not 0 <= rank < int(self._sizes[length])):
            return
        for note in self._notes:
            draw = None
            if uniform:
                sizes = [self._sizes[each] for each in lengths]
                order = order_of(sizes, spec.division, note.name, spec.seed, evenly=spec.evenly)
                whole = order.number(lengths.index(length), rank)
                draw = None if whole is None else spec.deal.own(whole)
                if draw is None:
                    continue
            yield from ((note, row) for row in self._tables.by_rank(note, length, rank, draw))

    @cached_property
    def _sizes(self) -> dict[int, int]:
        """The number of tasks of each length."""
        return {space.length: number_of(space.tasks) for space in self.manifest.spaces}

    def _start(self, table: str, number: int, start: int) -> Mapping[str, Any]:
        """Return the row of an initial state of a task."""
        note, task = self._row(number)
        for row in self._tables.starts(note, table, task):
            if row["start"] == start:
                return row
        raise QueryError(f"{self.folder}: task {number} has no row for the initial state {start} in {table}")

    def _starts(self, table: str) -> Iterator[tuple[DatasetEntry, Mapping[str, Any]]]:
        """Yield each task with each of its rows in a table of initial states."""
        for note in self._notes:
            rows = self._tables.rows(note, table)
            start = next(rows, None)
            for row in self._tables.rows(note, "tasks"):
                fits = self._fits(row["plan"])
                entry = self._entry(note, row) if fits else None
                while start is not None and start["task"] == row["task"]:
                    if entry is not None:
                        yield entry, start
                    start = next(rows, None)

    def _recording(self, name: str) -> Demonstration:
        from prag_asp.physics import Demonstration

        path = self.folder / name
        if not is_inside(path, self.folder):
            raise QueryError(f"{path}: leads out of the dataset; copy it again")
        return Demonstration.load(path)

    @cached_property
    def _tables(self) -> TableReader:
        from prag_asp.dataset.store.tables import TableReader

        return TableReader(self.folder)


def _witness(text: str) -> Witness:
    from prag_asp.physics import Witness

    return Witness.from_json(decoded(text))
