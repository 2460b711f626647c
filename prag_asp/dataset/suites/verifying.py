"""Verify a dataset or a suite: each dataset, the exact figures, and the absence of shared tasks and texts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.instructions import PLAIN
from prag_asp.dataset.store.manifest import request_of
from prag_asp.dataset.suites.counting import count_suite, space_of
from prag_asp.dataset.suites.suite_builder import identity_of, progress_of_part
from prag_asp.dataset.suites.suite_card import NAME as CARD
from prag_asp.dataset.suites.suite_card import card_text
from prag_asp.dataset.suites.suite_manifest import NAME, SPELLED, SUITE, SuiteManifest, is_suite, manifest_of
from prag_asp.dataset.suites.suite_reader import read_suite
from prag_asp.dataset.verification.file_checks import UNSEEN, wrong_file
from prag_asp.dataset.verification.finding import Finding, Progress
from prag_asp.dataset.verification.verifier import wrong_dataset
from prag_asp.errors import DomainError, PragError, QueryError
from prag_asp.processes.progress_events import report_progress
from prag_asp.program.sources import Source
from prag_asp.safe_reading import read_bytes
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.suites.suite_spec import Suite, SuitePart

KNOWN = (NAME, SPELLED, CARD)
"""The files of a suite apart from its datasets."""


def verify(
    folder: str | Path,
    *,
    trust: bool = False,
    physics: bool = True,
    workers: int = 1,
    progress: Progress = report_progress,
) -> Iterator[Finding]:
    """Yield findings about a dataset or a suite; there are none if it is correct and unchanged.

    Each file must match its record in dataset.json, and there must be no other files. Each exact size is counted again.
    Each draw is sampled again with its seed, and must be in exactly one row, with a task that no other row has; its
    plan must be accepted by clingo, which is independent of the sampler; and its instructions must parse to this plan.
    With `physics`, each witness is simulated again, and recordings are compared with their tasks; findings and their
    order do not depend on the number of `workers`. With `trust`, physics may run the Python files of the domain.

    For a suite, all figures are counted again from its TOML file, and each dataset has to match the request of its
    part. Parts must not share tasks without declaring it; if their phrasings are disjoint, they must not share texts
    either.

    Raises:
        QueryError: there is no dataset, its files cannot be read, or it is incomplete.
        DatasetsMissingError: pyarrow is not installed.
    """
    findings = _wrong_suite if is_suite(folder) else wrong_dataset
    return findings(Path(folder), trust, physics, workers, progress)


def _wrong_suite(path: Path, trust: bool, physics: bool, workers: int, progress: Progress) -> Iterator[Finding]:
    """Yield findings about a suite, as `verify` does."""
    note = SUITE.read(path)
    if note is None or not note.complete:
        what = f"is not a suite, because it has no {NAME}" if note is None else "the run that writes it has not ended"
        raise QueryError(f"{path}: {what}; prag-asp suite generates or continues it")
    yield from _wrong_files(path, note)
    try:
        first = Dataset.open(path / note.parts[0].name, trust=trust)
        try:
            text = read_bytes(path / SPELLED, within=path).decode()
        except (OSError, UnicodeDecodeError) as error:
            raise DomainError(f"{path / SPELLED}: cannot be read: {error}; copy the suite again") from None
        suite = read_suite(Source(path / SPELLED, text), domain=first.domain, trust=trust)
        yield from _wrong_note(suite, note, progress)
    except PragError as error:
        yield Finding(SPELLED, None, f"cannot be checked: {error}")
        return
    if {part.name for part in note.parts} != {*suite.parts}:
        return  # already reported as a finding
    overlaps = _OverlapChecks(suite)
    for part in note.parts:
        if part.dataset is None:
            yield Finding(NAME, None, f"parts, {part.name}: has no record of its dataset")
        try:
            data, own = Dataset.open(path / part.name, trust=trust), suite.parts[part.name]
            if data.manifest.request != request_of(space_of(suite, own), suite.dataset_spec(own)):
                yield Finding(f"{part.name}/dataset.json", None, f"does not belong to the request in {SPELLED}")
            report = progress_of_part(part.name, progress)
            for finding in wrong_dataset(path / part.name, trust, physics, workers, report):
                yield finding._replace(file=f"{part.name}/{finding.file}")
            yield from overlaps.wrong(part.name, data)
            yield from _too_near(suite, own, data)
        except PragError as error:
            yield Finding(part.name, None, str(error))


def _wrong_files(folder: Path, note: SuiteManifest) -> Iterator[Finding]:
    """Yield findings about the files next to the datasets, and about files that belong to no part."""
    for file in (note.source, *(part.dataset for part in note.parts if part.dataset is not None)):
        yield from wrong_file(folder, file.path, file.sha256, file.bytes)
    expected = {*KNOWN, *UNSEEN, *(part.name for part in note.parts)}
    for path in sorted(folder.iterdir()):
        if path.name not in expected:
            yield Finding(path.name, None, "is not a file of the suite")
    try:
        card = read_bytes(folder / CARD, within=folder)
    except OSError as error:
        yield Finding(CARD, None, f"cannot be read: {error.strerror or error}")
        return
    if card != card_text(note):
        yield Finding(CARD, None, f"does not match {NAME}")


def _wrong_note(suite: Suite, note: SuiteManifest, progress: Progress) -> Iterator[Finding]:
    """Yield findings about figures that differ from those of a new count."""
    figures = count_suite(suite, progress=progress)
    right = manifest_of(suite, figures, identity_of(suite), note.versions)
    right.name = note.name  # the original name of the file, which is a copy named suite.toml here
    for name in ("identity", "title", "description", "domain", "source", "shared", "unseen"):
        if getattr(note, name) != getattr(right, name):
            yield Finding(NAME, None, f"{name} differs from a new count for {SPELLED}")
    if [part.name for part in note.parts] != [part.name for part in right.parts]:
        yield Finding(NAME, None, f"parts are not those of {SPELLED}")
        return
    for part, right_part in zip(note.parts, right.parts, strict=True):
        for field_ in ("about", "of", "unseen", "where", "language", "phrasings", "spaces", "size", "distance"):
            if getattr(part, field_) != getattr(right_part, field_):
                yield Finding(NAME, None, f"parts, {part.name}: {field_} differs from a new count for {SPELLED}")
        if part.requested > right_part.requested:
            yield Finding(NAME, None, f"parts, {part.name}: has a request for more tasks than {SPELLED} says")
    for leak in figures.leaks:
        yield Finding(NAME, None, f"{leak.one} and {leak.other} have {leak.digits} tasks in common")


def _too_near(suite: Suite, part: SuitePart, data: Dataset) -> Iterator[Finding]:
    """Yield findings about tasks that are too close to another part; each distance is the length of a shortest path.

    The automaton from which the tasks were sampled is not used.
    """
    from prag_asp.analysis.neighbours import nearest_task

    for name, distance in part.distance.items():
        other = space_of(suite, suite.parts[name])
        for row, task in enumerate(data.tasks()):
            nearest = nearest_task(other, task).distance
            if nearest < distance:
                yield Finding(part.name, row, f"is {plural(nearest, 'edit')} from a task of {name}, not {distance}")


@dataclass
class _OverlapChecks:
    """The checks for tasks and texts that occur in several parts.

    `tasks` holds the part and the row of each task; `texts` holds, for each part, the row of each text.
    """

    suite: Suite
    tasks: dict[object, tuple[str, int]] = field(default_factory=dict)
    texts: dict[str, dict[str, int]] = field(default_factory=dict)

    def wrong(self, name: str, data: Dataset) -> Iterator[Finding]:
        """Yield findings about tasks and texts of a dataset that occur in an earlier one."""
        part, parts = self.suite.parts[name], self.suite.parts
        for row, entry in enumerate(data.entries()):
            key = (entry.task.actions, entry.task.initial)
            other = self.tasks.setdefault(key, (name, row))
            if other[0] != name and not part.declares(parts[other[0]]):
                yield Finding(name, row, f"has the same task as {other[0]}, row {other[1]}")
            instructions = [text for level, text in entry.instruction.items() if level != PLAIN]
            for text in (*instructions, *(entry.subgoals if instructions else ())):
                for before, place in self.texts.get(text, {}).items():
                    if before != name and part.apart(parts[before]):
                        yield Finding(name, row, f"has the same text as {before}, row {place}: {text}")
                if text:
                    self.texts.setdefault(text, {}).setdefault(name, row)
