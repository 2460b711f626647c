"""Verify a suite: each dataset, the exact figures, and that what is written keeps apart what was to be apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.instructions import PLAIN
from prag_asp.dataset.store.manifest import request_of
from prag_asp.dataset.suites.counting import count_suite, space_of
from prag_asp.dataset.suites.suite_builder import identity_of
from prag_asp.dataset.suites.suite_card import NAME as CARD
from prag_asp.dataset.suites.suite_card import card_text
from prag_asp.dataset.suites.suite_manifest import NAME, SPELLED, SUITE, SuiteManifest, is_suite, manifest_of
from prag_asp.dataset.suites.suite_reader import read_suite
from prag_asp.dataset.verification.file_checks import UNSEEN, wrong_file
from prag_asp.dataset.verification.finding import Finding, Progress
from prag_asp.dataset.verification.verifier import wrong_dataset
from prag_asp.errors import DomainError, PragError, QueryError
from prag_asp.program.sources import Source
from prag_asp.safe_reading import read_bytes

if TYPE_CHECKING:
    from prag_asp.dataset.suites.suite_spec import Suite

KNOWN = (NAME, SPELLED, CARD)
"""The files of a suite beside its datasets."""


def verify(
    folder: str | Path,
    *,
    trust: bool = False,
    physics: bool = True,
    workers: int = 1,
    progress: Progress = lambda words, done, total: None,
) -> Iterator[Finding]:
    """Yield what is wrong with a dataset, or a suite of them; nothing where it is as it was written.

    Each file is as dataset.json says, and there are no others. Each exact size is counted again. Each draw is made
    again by its seed, and stands in one row, once in all parts; clingo, which drew nothing, takes its plan; its words
    are read back from their text. With `physics`, each witness is simulated again, and
    recordings are compared with their tasks; several `workers` find the same, in the same order. With `trust`, physics
    may run the Python files of the domain.

    Of a suite, all figures are counted again from its own text, and each dataset is of the space that this says. No
    task stands in two parts that do not say so, and no words in two whose phrasings are to differ.

    Raises:
        QueryError: there is not a dataset, its files cannot be read, or the run that makes it has not ended.
        DatasetsMissingError: pyarrow is not installed.
    """
    look = _wrong_suite if is_suite(folder) else wrong_dataset
    return look(Path(folder), trust, physics, workers, progress)


def _wrong_suite(path: Path, trust: bool, physics: bool, workers: int, progress: Progress) -> Iterator[Finding]:
    """Yield what is wrong with a suite, as `verify` does."""
    note = SUITE.read(path)
    if note is None or not note.complete:
        what = f"is not a suite, because it has no {NAME}" if note is None else "the run that makes it has not ended"
        raise QueryError(f"{path}: {what}; prag-asp suite makes one, and goes on with it")
    yield from _wrong_files(path, note)
    try:
        first = Dataset.open(path / note.parts[0].name, trust=trust)
        suite = read_suite(Source(path / SPELLED, _text(path)), domain=first.domain, trust=trust)
        yield from _wrong_note(suite, note, progress)
    except PragError as error:
        yield Finding(SPELLED, None, f"cannot be looked at: {error}")
        return
    if {part.name for part in note.parts} != {*suite.parts}:
        return  # which is a finding already
    apart = _Apart(suite)
    for part in note.parts:
        if part.dataset is None:
            yield Finding(NAME, None, f"parts, {part.name}: does not say which dataset it is")
        try:
            data = Dataset.open(path / part.name, trust=trust)
            yield from _wrong_part(suite, part.name, data)
            report = _of_part(part.name, progress)
            for finding in wrong_dataset(path / part.name, trust, physics, workers, report):
                yield finding._replace(file=f"{part.name}/{finding.file}")
            yield from apart.wrong(part.name, data)
        except PragError as error:
            yield Finding(part.name, None, str(error))


def _text(folder: Path) -> str:
    """Return the text of the suite that a folder has.

    Raises:
        DomainError: it cannot be read.
    """
    try:
        return read_bytes(folder / SPELLED, within=folder).decode()
    except (OSError, UnicodeDecodeError) as error:
        raise DomainError(f"{folder / SPELLED}: cannot be read: {error}; copy the suite once more") from None


def _of_part(name: str, progress: Progress) -> Progress:
    """Return the progress of a part."""
    return lambda words, done, total: progress(f"{name}: {words}", done, total)


def _wrong_files(folder: Path, note: SuiteManifest) -> Iterator[Finding]:
    """Yield what is wrong with the files beside the datasets, and with what is no part."""
    for file in (note.source, *(part.dataset for part in note.parts if part.dataset is not None)):
        yield from wrong_file(folder, file.path, file.sha256, file.bytes)
    known = {*KNOWN, *UNSEEN, *(part.name for part in note.parts)}
    for path in sorted(folder.iterdir()):
        if path.name not in known:
            yield Finding(path.name, None, "is no file of the suite")
    try:
        card = read_bytes(folder / CARD, within=folder)
    except OSError as error:
        yield Finding(CARD, None, f"cannot be read: {error.strerror or error}")
        return
    if card != card_text(note):
        yield Finding(CARD, None, f"does not say what {NAME} says")


def _wrong_note(suite: Suite, note: SuiteManifest, progress: Progress) -> Iterator[Finding]:
    """Yield which figures are not those that are counted now."""
    figures = count_suite(suite, progress=progress)
    right = manifest_of(suite, figures, identity_of(suite), note.versions)
    right.name = note.name  # that of the file, which is called suite.toml now
    for name in ("identity", "title", "description", "domain", "source", "shared", "unseen"):
        if getattr(note, name) != getattr(right, name):
            yield Finding(NAME, None, f"{name} is not what {SPELLED} says, counted again")
    if [part.name for part in note.parts] != [part.name for part in right.parts]:
        yield Finding(NAME, None, f"parts are not those of {SPELLED}")
        return
    for found, right_part in zip(note.parts, right.parts, strict=True):
        for field_ in ("about", "of", "unseen", "where", "language", "phrasings", "spaces", "size"):
            if getattr(found, field_) != getattr(right_part, field_):
                yield Finding(NAME, None, f"parts, {found.name}: {field_} is not what {SPELLED} says, counted again")
        if found.requested > right_part.requested:
            yield Finding(NAME, None, f"parts, {found.name}: wants more tasks than {SPELLED} says")
    for leak in figures.leaks:
        yield Finding(NAME, None, f"{leak.one} and {leak.other} have {leak.digits} tasks in common")


def _wrong_part(suite: Suite, name: str, data: Dataset) -> Iterator[Finding]:
    """Yield whether a dataset is of another space or in other words than its part says."""
    part = suite.parts[name]
    if data.manifest.request != request_of(space_of(suite, part), suite.dataset_spec(part)):
        yield Finding(f"{name}/dataset.json", None, f"was made by another request than {SPELLED} says")


@dataclass
class _Apart:
    """Looks for tasks and words that stand in several parts."""

    suite: Suite
    tasks: dict[object, tuple[str, int]] = field(default_factory=dict)
    words: dict[str, dict[str, int]] = field(default_factory=dict)

    def wrong(self, name: str, data: Dataset) -> Iterator[Finding]:
        """Yield what a dataset has in common with those before it."""
        part, parts = self.suite.parts[name], self.suite.parts
        for row, entry in enumerate(data.entries()):
            key = (entry.task.actions, entry.task.initial)
            other = self.tasks.setdefault(key, (name, row))
            if other[0] != name and not part.declares(parts[other[0]]):
                yield Finding(name, row, f"has the task of {other[0]}, row {other[1]}")
            said = [text for level, text in entry.instruction.items() if level != PLAIN]
            for text in (*said, *(entry.subgoals if said else ())):
                for before, place in self.words.get(text, {}).items():
                    if before != name and part.apart(parts[before]):
                        yield Finding(name, row, f"has words of {before}, row {place}: {text}")
                if text:
                    self.words.setdefault(text, {}).setdefault(name, row)
