"""Splits whose later parts are at least a given distance from the first part; their manifests and verification."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from prag_asp.analysis.distant_tasks import tasks_apart
from prag_asp.analysis.neighbours import nearest_task
from prag_asp.atom import split_actions
from prag_asp.dataset.jsonl import read_tasks
from prag_asp.dataset.store.domain_snapshot import (
    DomainSnapshot,
    FileRecord,
    digest_of,
    load_snapshot,
    snapshot_of,
    write_snapshot,
)
from prag_asp.dataset.store.manifest import Decimal
from prag_asp.dataset.store.manifest_file import ManifestFile
from prag_asp.dataset.verification.file_checks import wrong_file
from prag_asp.dataset.verification.finding import Finding
from prag_asp.errors import PragError, QueryError
from prag_asp.integers import digits_of
from prag_asp.safe_reading import lines_of, open_text
from prag_asp.space.parts.ranked_tasks import RankedTasks
from prag_asp.space.task_space import TaskSpace
from prag_asp.tables.json_fields import Whole
from prag_asp.wording import plural

FORMS = {"text": "txt", "jsonl": "jsonl"}
"""The formats of tasks from which plans can be read again, with the endings of their files."""


@dataclass(frozen=True)
class DistantSplit:
    """A request for parts: what is held out from the first part, or the shares of whole skeletons, and the distance."""

    distance: int
    held: str | None = None
    shares: Mapping[str, str] = field(default_factory=dict)
    seed: int = 0

    def parts(self, space: TaskSpace) -> dict[str, TaskSpace | RankedTasks]:
        """Return the first part, and the tasks of each later part that are at least the distance from all of its tasks.

        Raises:
            QueryError: the space cannot be split like this, or the distance is wrong.
            LimitReached: a limit was reached, or the automaton of the tasks that remain is too large.
        """
        if self.held is not None:
            whole = dict(zip(("train", "test"), space.hold_out(self.held), strict=True))
        else:
            whole = space.split_skeletons(self.shares, seed=self.seed)
        (name, first), *others = whole.items()
        return {name: first, **{name: tasks_apart(part, first, self.distance) for name, part in others}}


class SplitFile(msgspec.Struct):
    """A part of a split: the exact number of its tasks, and the file with some of them."""

    name: str
    size: Decimal
    tasks: Whole
    file: FileRecord


class SplitManifest(msgspec.Struct):
    """The contents of split.json."""

    domain: DomainSnapshot
    length: Whole
    where: list[str]
    distance: Whole
    held: str | None
    shares: dict[str, str]
    seed: Whole
    parts: list[SplitFile]


NAME = "split.json"
SPLIT = ManifestFile(NAME, SplitManifest, "prag_asp split", 1, "split")
"""The file split.json."""


def record_split(
    folder: Path, space: TaskSpace, request: DistantSplit, sizes: Mapping[str, int], files: Mapping[str, Path]
) -> None:
    """Write split.json and the files of the domain; `sizes` and `files` hold the size and the file of each part.

    Raises:
        OutputError: a file cannot be written.
    """
    snapshot, contents = snapshot_of(space.domain)
    write_snapshot(folder, contents)
    parts = []
    for name, path in files.items():
        record = FileRecord(path.name, path.stat().st_size, digest_of(path))
        tasks = sum(1 for _ in plans_of(path))
        parts.append(SplitFile(name, digits_of(sizes[name]), tasks, record))
    conditions = list(map(str, space.condition.clauses))
    SPLIT.write(folder, SplitManifest(
        snapshot, space.length, conditions, request.distance, request.held, dict(request.shares), request.seed, parts,
    ))  # fmt: skip


def plans_of(path: Path) -> Iterator[tuple[str, ...]]:
    """Yield the plans of a file of tasks, as text or JSON lines.

    Raises:
        OSError: the file cannot be read.
        QueryError: a line is not a task.
    """
    if path.suffix == ".jsonl":
        yield from (tuple(map(str, record.task.actions)) for record in read_tasks(path))
        return
    with open_text(path) as stream:
        yield from (tuple(split_actions(line)) for line in lines_of(stream))


def wrong_split(folder: Path, *, trust: bool = False) -> Iterator[Finding]:
    """Yield findings about a split: files, exact sizes, and tasks that are not in their part or too near to the first.

    The sizes are computed again. The distance of each task from the whole first part is a shortest path, found without
    the automaton that selected the task.

    Raises:
        QueryError: the folder is not a split.
    """
    note = SPLIT.read(folder)
    if note is None:
        raise QueryError(f"{folder}: is not a split, because it has no {NAME}; prag-asp split --distance makes one")
    for part in note.parts:
        yield from wrong_file(folder, part.file.path, part.file.sha256, part.file.bytes, NAME)
    try:
        domain = load_snapshot(folder, note.domain, trust=trust, note=NAME)
        space = TaskSpace(domain, note.length).where(*note.where)
        parts = DistantSplit(note.distance, note.held, note.shares, note.seed).parts(space)
    except PragError as error:
        yield Finding(NAME, None, f"cannot be checked: {error}")
        return
    if [*parts] != [part.name for part in note.parts]:
        yield Finding(NAME, None, f"parts: has {', '.join(part.name for part in note.parts)}, not {', '.join(parts)}")
        return
    first = next(iter(parts.values()))
    assert isinstance(first, TaskSpace)
    for part in note.parts:
        size = digits_of(parts[part.name].count())
        if size != part.size:
            yield Finding(NAME, None, f"parts, {part.name}: size is {part.size}, but there are {size} tasks")
        own = parts[part.name]
        yield from _wrong_tasks(folder, part, first, own if own is not first else None, space, note.distance)


def _wrong_tasks(
    folder: Path, part: SplitFile, first: TaskSpace, later: TaskSpace | RankedTasks | None, space: TaskSpace,
    distance: int,
) -> Iterator[Finding]:  # fmt: skip
    """Yield findings about the tasks of a part; `later` is None for the first part."""
    file = part.file.path
    try:
        plans = list(plans_of(folder / file))
    except (OSError, PragError) as error:
        yield Finding(file, None, f"cannot be read: {error}")
        return
    if len(plans) != part.tasks:
        yield Finding(file, None, f"has {plural(len(plans), 'task')}; {NAME} says {part.tasks}")
    seen: set[int] = set()
    for row, plan in enumerate(plans):
        try:
            rank = space.index(plan)
        except PragError as error:
            yield Finding(file, row, f"is not a task: {error}")
            continue
        if rank in seen:
            yield Finding(file, row, "is a task that was there before")
        seen.add(rank)
        if later is None and plan not in first:
            yield Finding(file, row, f"is not a task of {part.name}")
        elif later is not None and (near := nearest_task(first, plan).distance) < distance:
            yield Finding(file, row, f"is {plural(near, 'edit')} from the first part, not {distance}")
        elif isinstance(later, RankedTasks) and next(space.tasks_of_plans([plan])) not in later:
            yield Finding(file, row, f"is not a task of {part.name}")
