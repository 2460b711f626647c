"""Generate a suite: count it, refuse leaks, and write one dataset per part, with a card for the suite."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.generation import generate
from prag_asp.dataset.making.run import Progress
from prag_asp.dataset.store.domain_snapshot import snapshot_of
from prag_asp.dataset.store.manifest import request_of
from prag_asp.dataset.suites.counting import count_suite, refuse_leaks, space_of
from prag_asp.dataset.suites.suite_card import NAME as CARD
from prag_asp.dataset.suites.suite_card import card_text
from prag_asp.dataset.suites.suite_manifest import (
    NAME,
    SPELLED,
    SUITE,
    SuiteManifest,
    SuitePartManifest,
    manifest_of,
    record_part,
)
from prag_asp.errors import NotFound, OutputError, QueryError
from prag_asp.missing import require_pyarrow
from prag_asp.output import file_in, make_folder, replace_file
from prag_asp.output.digests import digest
from prag_asp.physics import require_physics
from prag_asp.space.limits import UNLIMITED
from prag_asp.versions import versions
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.suites.suite_spec import Suite
    from prag_asp.space.limits import Limits


def generate_suite(
    suite: Suite,
    folder: str | Path,
    *,
    workers: int = 1,
    limits: Limits = UNLIMITED,
    progress: Progress = lambda words, done, total: None,
) -> SuiteManifest:
    """Write a dataset for each part of a suite, in a folder of its name, and return the manifest of the suite.

    The same call resumes an interrupted run, and more tasks for a part extend its dataset. The bytes depend
    on the suite alone, not on the number of `workers`.

    Raises:
        QueryError: parts share tasks without declaring it, or the request of a part is wrong.
        SceneError: the scene lacks the shape of an entity of a task.
        OutputError: the folder contains something else, or a file cannot be written.
        NotFound: too few feasible tasks were found for some parts; all others are written.
        WorkerError: workers died repeatedly.
        DatasetsMissingError: pyarrow is not installed.
    """
    require_pyarrow()
    if suite.budget is not None:
        require_physics()
    path = Path(folder)
    identity = identity_of(suite)
    _require_suite_folder(path, suite, identity)
    figures = count_suite(suite, limits=limits, progress=progress)
    refuse_leaks(suite, figures)
    for part in suite.parts.values():
        suite.dataset_spec(part)  # report contradictions before anything is written
    note = manifest_of(suite, figures, identity, versions())
    make_folder(path)
    SUITE.write(path, note)
    replace_file(file_in(path, SPELLED), suite.text.encode(), follow=False)
    lacking = [line for part in note.parts for line in _generate_part(suite, part, path, workers, limits, progress)]
    replace_file(file_in(path, CARD), card_text(note), follow=False)
    note.complete = True
    SUITE.write(path, note)
    if lacking:
        raise NotFound(*lacking)
    return note


def _generate_part(
    suite: Suite, note: SuitePartManifest, folder: Path, workers: int, limits: Limits, progress: Progress
) -> tuple[str, ...]:
    """Write the dataset of a part, record it, and return the messages about missing tasks."""
    part, lacking = suite.parts[note.name], tuple[str, ...]()

    def report(words: str, done: int, total: int) -> None:
        progress(f"{note.name}: {words}", done, total)

    space = space_of(suite, part, limits=limits)
    try:
        generate(space, folder / note.name, suite.dataset_spec(part), workers=workers, progress=report)
    except NotFound as error:
        lacking = tuple(f"{folder / note.name}: {line}" for line in error.lines)
    record_part(folder, note)
    return lacking


def identity_of(suite: Suite) -> str:
    """Return the digest of all inputs of the datasets of a suite, except the numbers of tasks."""
    snapshot, _ = snapshot_of(suite.domain)
    parts = [[part.name, part.of, list(part.unseen), request_of(space_of(suite, part), suite.dataset_spec(part))]
             for part in suite.parts.values()]  # fmt: skip
    return digest([msgspec.to_builtins(snapshot), parts])


def _require_suite_folder(folder: Path, suite: Suite, identity: str) -> None:
    """Check that a folder is new, empty, or contains this suite with no more tasks, before anything is written.

    Raises:
        OutputError: it contains something else.
        QueryError: the suite in it has more tasks.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is no folder; give a new one")
    before = SUITE.read(folder) if folder.is_dir() else None
    if before is None:
        other = sorted(path.name for path in folder.iterdir() if path.name != f"{NAME}.part") if folder.is_dir() else []
        if other:
            raise OutputError(f"{folder}: holds {other[0]}, and is not a suite; give a new folder")
    elif before.identity != identity or {part.name for part in before.parts} != {*suite.parts}:
        raise OutputError(f"{folder}: is another suite, or one of another state of its domain; give a new folder")
    else:
        for part in before.parts:
            if part.tasks > suite.parts[part.name].tasks:
                problem = f"has {plural(part.tasks, 'task')} already; ask for at least as many, or give a new folder"
                raise QueryError(f"{folder / part.name}: {problem}")
