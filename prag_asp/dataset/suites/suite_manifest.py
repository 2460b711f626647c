"""suite.json: the exact figures of a suite that was made, and the data sets that its parts became."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.description import read_description, write_description
from prag_asp.dataset.store.domain_snapshot import KeptFile, digest_of
from prag_asp.dataset.store.manifest import NAME as MANIFEST
from prag_asp.dataset.store.manifest import Decimal, SpaceNote, read_manifest
from prag_asp.errors import QueryError
from prag_asp.integers import digits_of
from prag_asp.tables.json_fields import Whole

if TYPE_CHECKING:
    from prag_asp.dataset.suites.counting import Figures
    from prag_asp.dataset.suites.suite_spec import Suite

NAME, SPELLED, FORMAT, VERSION = "suite.json", "suite.toml", "prag_asp suite", 1


class SuitePart(msgspec.Struct):
    """A part: its exact size, what was drawn of it, and the dataset.json that says the rest."""

    name: str
    about: str
    of: str | None
    unseen: list[str]
    where: list[str]
    language: str
    phrasings: str
    spaces: list[SpaceNote]
    size: Decimal
    wanted: Whole
    tasks: Whole = 0
    dataset: KeptFile | None = None


class SharedNote(msgspec.Struct):
    """How many tasks two parts have in common, and whether one of them says that it may."""

    one: str
    other: str
    tasks: Decimal
    declared: bool


class UnseenNote(msgspec.Struct):
    """How many tasks of a part have something that is held out from it."""

    what: str
    part: str
    tasks: Decimal


class SuiteNote(msgspec.Struct):
    """What suite.json says."""

    format: str
    version: Whole
    complete: bool
    identity: str
    name: str
    title: str
    description: str
    domain: str
    source: KeptFile
    parts: list[SuitePart]
    shared: list[SharedNote]
    unseen: list[UnseenNote]
    versions: str = ""


def note_of(suite: Suite, figures: Figures, identity: str, versions: str) -> SuiteNote:
    """Return what is told of a suite before any of it is made."""
    text = suite.text.encode()
    parts = [
        SuitePart(
            part.name, part.about, part.of, list(part.unseen), list(part.where), part.language, part.phrasings,
            [SpaceNote(length, digits_of(tasks)) for length, tasks in figures.sizes[part.name].items()],
            digits_of(figures.size(part.name)), part.tasks,
        )
        for part in suite.parts.values()
    ]  # fmt: skip
    return SuiteNote(
        FORMAT, VERSION, False, identity, suite.name, suite.title, suite.description, suite.domain.name,
        KeptFile(SPELLED, len(text), sha256(text).hexdigest()), parts,
        [SharedNote(each.one, each.other, digits_of(each.tasks), each.declared) for each in figures.shared],
        [UnseenNote(each.what, each.part, digits_of(each.tasks)) for each in figures.unseen], versions,
    )  # fmt: skip


def take_note(folder: Path, part: SuitePart) -> None:
    """Note what became of a part: how many tasks it has, and its dataset.json.

    Raises:
        QueryError: there is no such data set.
    """
    manifest, path = read_manifest(folder / part.name), folder / part.name / MANIFEST
    if manifest is None:
        raise QueryError(f"{path}: is missing; the same command, once more, makes it")
    part.tasks = manifest.rows("tasks")
    part.dataset = KeptFile(f"{part.name}/{MANIFEST}", path.stat().st_size, digest_of(path))


def write_note(folder: Path, note: SuiteNote) -> None:
    """Write suite.json, whole.

    Raises:
        OutputError: it cannot be written.
    """
    write_description(folder, NAME, note)


def is_suite(folder: str | Path) -> bool:
    """Tell whether a folder is one of a suite."""
    return (Path(folder) / NAME).is_file()


def count_tasks(folder: str | Path) -> int:
    """Return how many tasks a data set has, or all data sets of a suite.

    Raises:
        QueryError: there is none, or it cannot be read.
    """
    note = read_note(Path(folder)) if is_suite(folder) else None
    return Dataset.open(folder).count() if note is None else sum(part.tasks for part in note.parts)


def read_note(folder: Path) -> SuiteNote | None:
    """Return what suite.json says, None where there is none.

    Raises:
        QueryError: it is damaged, of another program, or of another version.
    """
    note = read_description(folder, NAME, SuiteNote, (FORMAT, VERSION), "suite")
    if note is None:
        return None
    try:
        return _checked(note)
    except QueryError as error:
        raise QueryError(f"{folder / NAME}: {error}") from None


def _checked(note: SuiteNote) -> SuiteNote:
    """Return what suite.json says, if each part has a folder of its own in that of the suite.

    Raises:
        QueryError: one has not, or there are no parts.
    """
    names = [part.name for part in note.parts]
    if not names or len({*names}) < len(names):
        raise QueryError("parts: needs some, each once; copy the suite once more")
    for name in names:
        if not name or name.startswith(".") or Path(name).name != name:
            raise QueryError(f"parts: {name!r} is no name of a part; copy the suite once more")
    return note
