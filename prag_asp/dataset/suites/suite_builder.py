"""Generate a suite: count the tasks of its parts, refuse leaks, and write one dataset per part, and a card."""

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
    SPELLED,
    SUITE,
    SuiteManifest,
    manifest_of,
    record_part,
)
from prag_asp.errors import NotFound, OutputError, QueryError
from prag_asp.missing import require_pyarrow
from prag_asp.output import file_in, make_folder, replace_file
from prag_asp.output.digests import digest
from prag_asp.physics import require_physics
from prag_asp.processes.progress_events import report_progress
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
    progress: Progress = report_progress,
) -> SuiteManifest:
    """Write a dataset for each part of a suite, in a folder with the name of the part, and return the manifest.

    The same call resumes an interrupted run, and more tasks for a part extend its dataset. The bytes depend only on the
    suite, not on the number of `workers`.

    Raises:
        QueryError: parts share tasks without declaring it, or the request for a part is wrong.
        SceneError: the scene lacks the shape of an entity in a task.
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
    SUITE.require_folder(path)
    before = SUITE.read(path)
    if before is not None:
        if before.identity != identity or {part.name for part in before.parts} != {*suite.parts}:
            raise OutputError(f"{path}: is a different suite, or its domain has changed; give a new folder")
        for part in before.parts:
            if part.tasks > suite.parts[part.name].tasks:
                problem = f"has {plural(part.tasks, 'task')} already; request at least as many, or give a new folder"
                raise QueryError(f"{path / part.name}: {problem}")
    figures = count_suite(suite, limits=limits, progress=progress)
    refuse_leaks(suite, figures)
    for each in suite.parts.values():
        suite.dataset_spec(each)  # report contradictions before anything is written
    note = manifest_of(suite, figures, identity, versions())
    make_folder(path)
    SUITE.write(path, note)
    replace_file(file_in(path, SPELLED), suite.text.encode(), follow=False)
    lacking = list[str]()
    for part in note.parts:
        space, spec = space_of(suite, suite.parts[part.name], limits=limits), suite.dataset_spec(suite.parts[part.name])
        try:
            generate(space, path / part.name, spec, workers=workers, progress=progress_of_part(part.name, progress))
        except NotFound as error:
            lacking += [f"{path / part.name}: {line}" for line in error.lines]
        record_part(path, part)
    replace_file(file_in(path, CARD), card_text(note), follow=False)
    note.complete = True
    SUITE.write(path, note)
    if lacking:
        raise NotFound(*lacking)
    return note


def identity_of(suite: Suite) -> str:
    """Return the digest of all inputs to the datasets of a suite, except the numbers of tasks."""
    snapshot, _ = snapshot_of(suite.domain)
    parts = [[part.name, part.of, list(part.unseen), request_of(space_of(suite, part), suite.dataset_spec(part))]
             for part in suite.parts.values()]  # fmt: skip
    return digest([msgspec.to_builtins(snapshot), parts])


def progress_of_part(name: str, progress: Progress) -> Progress:
    """Return a progress callback that puts the name of a part before each message."""
    return lambda words, done, total: progress(f"{name}: {words}", done, total)
