"""Splits with a guarantee (a distance between parts, or combinations only in the test part), and their manifests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from prag_asp.analysis.covering import Combination, combination_text, combinations_of, reachable_combinations
from prag_asp.analysis.covering.held_out import held_out
from prag_asp.analysis.distant_tasks import tasks_apart
from prag_asp.analysis.neighbours import nearest_task
from prag_asp.atom import parse_atom, split_actions
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
"""The formats of tasks from which plans can be read again, with the extensions of their files."""


@dataclass(frozen=True)
class DistantSplit:
    """A request for parts: what to hold out from the first part, or the shares of skeletons, and the minimum distance.

    If there are `combinations`, they are held out from the first part, which covers all combinations with one factor
    fewer.
    """

    distance: int = 1
    held: str | None = None
    shares: Mapping[str, str] = field(default_factory=dict)
    seed: int = 0
    combinations: tuple[Combination, ...] = ()

    @property
    def strength(self) -> int:
        """The number of factors of the combinations that the first part covers, or 0."""
        return max(map(len, self.combinations), default=1) - 1

    def parts(self, space: TaskSpace) -> dict[str, TaskSpace | RankedTasks]:
        """Return the first part, and the tasks of each later part that are at least `distance` from the first part.

        Raises:
            QueryError: the space cannot be split in this way, or the distance is wrong.
            LimitReached: a limit was reached, or the automaton of the tasks that remain is too large.
        """
        if self.combinations:
            whole = dict(
                zip(("train", "test"), held_out(space, self.strength, self.combinations).parts(space), strict=True)
            )
        elif self.held is not None:
            whole = dict(zip(("train", "test"), space.hold_out(self.held), strict=True))
        else:
            whole = space.split_skeletons(self.shares, seed=self.seed)
        (name, first), *others = whole.items()
        if self.distance == 1:  # different tasks are at least one edit apart
            return dict(whole)
        return {name: first, **{name: tasks_apart(part, first, self.distance) for name, part in others}}


class SplitFile(msgspec.Struct):
    """A part of a split: its exact size, and a file with some of its tasks, with their ranks in the space."""

    name: str
    size: Decimal
    tasks: Whole
    file: FileRecord
    ranks: list[Decimal] = []


class SplitManifest(msgspec.Struct):
    """The contents of split.json.

    Each of the `combinations` maps the numbers of factors to their values; `reachable` is the number of combinations
    with one factor fewer, all of which are covered by the first part and by its file.
    """

    domain: DomainSnapshot
    length: Whole
    where: list[str]
    distance: Whole
    held: str | None
    shares: dict[str, str]
    seed: Whole
    parts: list[SplitFile]
    combinations: list[dict[str, str]] = []
    reachable: Whole = 0


NAME = "split.json"
SPLIT = ManifestFile(NAME, SplitManifest, "prag_asp split", 1, "split")
"""The file split.json."""


def record_split(
    folder: Path, space: TaskSpace, request: DistantSplit, sizes: Mapping[str, int], files: Mapping[str, Path]
) -> None:
    """Write split.json and the files of the domain; `sizes` and `files` hold each part's size and file.

    Raises:
        OutputError: a file cannot be written.
    """
    snapshot, contents = snapshot_of(space.domain)
    write_snapshot(folder, contents)
    parts = []
    for name, path in files.items():
        record = FileRecord(path.name, path.stat().st_size, digest_of(path))
        ranks = [digits_of(space.index(plan)) for plan in plans_of(path)]
        parts.append(SplitFile(name, digits_of(sizes[name]), len(ranks), record, ranks))
    combinations = [{str(place): value for place, value in each} for each in request.combinations]
    reachable = len(reachable_combinations(space, request.strength)) if combinations else 0
    conditions = list(map(str, space.condition.clauses))
    SPLIT.write(folder, SplitManifest(
        snapshot, space.length, conditions, request.distance, request.held, dict(request.shares), request.seed, parts,
        combinations, reachable,
    ))  # fmt: skip


def plans_of(path: Path) -> Iterator[tuple[str, ...]]:
    """Yield the plans in a file of tasks, which are text or JSON lines.

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
    """Yield findings about a split: files, exact sizes, and tasks outside their part or too close to the first part.

    The sizes are computed again. The distance of each task from the whole first part is a shortest path, found without
    the automaton that selected the task. Held-out combinations are determined from the actions of each task, and the
    combinations that the first part covers from the automaton of its conditions.

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
        combinations = tuple(tuple(sorted((int(place), each[place]) for place in each)) for each in note.combinations)
        request = DistantSplit(note.distance, note.held, note.shares, note.seed, combinations)
        parts = request.parts(space)
    except (PragError, ValueError) as error:
        yield Finding(NAME, None, f"cannot be checked: {error}")
        return
    if [*parts] != [part.name for part in note.parts]:
        yield Finding(NAME, None, f"parts: has {', '.join(part.name for part in note.parts)}, not {', '.join(parts)}")
        return
    first = next(iter(parts.values()))
    assert isinstance(first, TaskSpace)
    if combinations:
        yield from _wrong_coverage(folder, note, request, space, first)
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
    if len(plans) != part.tasks or len(plans) != len(part.ranks):
        yield Finding(file, None, f"has {plural(len(plans), 'task')}; {NAME} says {part.tasks}")
    seen: set[int] = set()
    for row, plan in enumerate(plans):
        try:
            rank = space.index(plan)
        except PragError as error:
            yield Finding(file, row, f"is not a task: {error}")
            continue
        if row < len(part.ranks) and digits_of(rank) != part.ranks[row]:
            yield Finding(file, row, f"has rank {digits_of(rank)}; {NAME} says {part.ranks[row]}")
        if rank in seen:
            yield Finding(file, row, "is the same task as an earlier one")
        seen.add(rank)
        if later is None and plan not in first:
            yield Finding(file, row, f"is not a task of {part.name}")
        elif later is not None and distance > 1 and (near := nearest_task(first, plan).distance) < distance:
            yield Finding(file, row, f"is {plural(near, 'edit')} from the first part, not {distance}")
        elif later is not None and next(space.tasks_of_plans([plan])) not in later:
            yield Finding(file, row, f"is not a task of {part.name}")


def _wrong_coverage(
    folder: Path, note: SplitManifest, request: DistantSplit, space: TaskSpace, first: TaskSpace
) -> Iterator[Finding]:
    """Yield findings about the combinations in the parts and in their files."""
    classes, strength = space.domain.facts.entity_names, request.strength
    held, reachable = set(request.combinations), reachable_combinations(space, strength)
    if len(reachable) != note.reachable:
        yield Finding(NAME, None, f"reachable: is {note.reachable}, but there are {len(reachable)} combinations")
    lacking = reachable - reachable_combinations(first, strength)
    if lacking:
        yield Finding(NAME, None, f"combinations: no task of the first part has {combination_text(min(lacking))}")
    for number, part in enumerate(note.parts):
        path = folder / part.file.path
        try:
            plans = [tuple(map(parse_atom, plan)) for plan in plans_of(path)]
        except (OSError, PragError):
            continue  # `_wrong_tasks` reports it
        for row, plan in enumerate(plans):
            own = frozenset().union(*(combinations_of(action, classes, strength + 1) for action in plan))
            if own.isdisjoint(held) != (number == 0):
                what = "has none" if number else "has one"
                yield Finding(path.name, row, f"{what} of the combinations that are held out")
        if number == 0:
            covered = frozenset().union(
                *(combinations_of(action, classes, strength) for plan in plans for action in plan)
            )
            for each in sorted(reachable - covered)[:1]:
                yield Finding(path.name, None, f"has no task with {combination_text(each)}")
