"""suite.json: the exact figures of a suite, and the datasets of its parts."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.domain_snapshot import FileRecord, digest_of
from prag_asp.dataset.store.manifest import DATASET, Decimal, SpaceSize
from prag_asp.dataset.store.manifest_file import ManifestFile
from prag_asp.dataset.suites.counting import Figures, HeldOutCount, Overlap
from prag_asp.errors import QueryError
from prag_asp.integers import digits_of
from prag_asp.tables.json_fields import Whole

if TYPE_CHECKING:
    from prag_asp.dataset.suites.suite_spec import Suite

NAME, SPELLED = "suite.json", "suite.toml"


class SuitePartManifest(msgspec.Struct):
    """A part of a suite: its conditions, its exact size, its number of tasks, and the record of its dataset.json.

    `distance` holds the required distances from other parts in edits, if there are any.
    """

    name: str
    about: str
    of: str | None
    unseen: list[str]
    where: list[str]
    language: str
    phrasings: str
    spaces: list[SpaceSize]
    size: Decimal
    requested: Whole
    tasks: Whole = 0
    dataset: FileRecord | None = None
    distance: dict[str, Whole] | msgspec.UnsetType = msgspec.UNSET


class SuiteManifest(msgspec.Struct):
    """The contents of suite.json."""

    complete: bool
    identity: str
    name: str
    title: str
    description: str
    domain: str
    source: FileRecord
    parts: list[SuitePartManifest]
    shared: list[Overlap]
    unseen: list[HeldOutCount]
    versions: str = ""

    def __post_init__(self) -> None:
        names = [part.name for part in self.parts]
        if not names or len({*names}) < len(names):
            raise QueryError("parts: needs some, each once; copy the suite again")
        for name in names:
            if not name or name.startswith(".") or Path(name).name != name:
                raise QueryError(f"parts: {name!r} is not a valid name of a part; copy the suite again")


SUITE = ManifestFile(NAME, SuiteManifest, "prag_asp suite", 1, "suite")
"""The file suite.json."""


def manifest_of(suite: Suite, figures: Figures, identity: str, versions: str) -> SuiteManifest:
    """Return the manifest of a suite before its datasets are generated."""
    text = suite.text.encode()
    parts = [
        SuitePartManifest(
            part.name, part.about, part.of, list(part.unseen), list(part.where), part.language, part.phrasings,
            [SpaceSize(length, digits_of(tasks)) for length, tasks in figures.sizes[part.name].items()],
            digits_of(figures.size(part.name)), part.tasks, distance={**part.distance} or msgspec.UNSET,
        )
        for part in suite.parts.values()
    ]  # fmt: skip
    return SuiteManifest(
        False, identity, suite.name, suite.title, suite.description, suite.domain.name,
        FileRecord(SPELLED, len(text), sha256(text).hexdigest()), parts,
        [*figures.shared],
        [*figures.unseen], versions,
    )  # fmt: skip


def record_part(folder: Path, part: SuitePartManifest) -> None:
    """Record the number of tasks in a part, and its dataset.json.

    Raises:
        QueryError: there is no such dataset.
    """
    manifest, path = DATASET.read(folder / part.name), folder / part.name / DATASET.name
    if manifest is None:
        raise QueryError(f"{path}: is missing; run the same command again")
    part.tasks = manifest.rows("tasks")
    part.dataset = FileRecord(f"{part.name}/{DATASET.name}", path.stat().st_size, digest_of(path))


def is_suite(folder: str | Path) -> bool:
    """Return whether a folder contains a suite."""
    return (Path(folder) / NAME).is_file()


def count_tasks(folder: str | Path) -> int:
    """Return the number of tasks in a dataset, or in all datasets of a suite.

    Raises:
        QueryError: the folder contains neither, or cannot be read.
    """
    note = SUITE.read(Path(folder)) if is_suite(folder) else None
    return Dataset.open(folder).count() if note is None else sum(part.tasks for part in note.parts)
