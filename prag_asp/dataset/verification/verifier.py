"""Verify one dataset with checks in order of increasing cost."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from copy import deepcopy
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.making.chosen_draws import choice_of, chosen_order, record_figures
from prag_asp.dataset.making.ordered_tasks import requested_parts
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.manifest import NAME, Manifest
from prag_asp.dataset.store.tables import TableReader
from prag_asp.dataset.verification.figure_checks import wrong_figures, wrong_sizes
from prag_asp.dataset.verification.file_checks import wrong_card, wrong_files
from prag_asp.dataset.verification.finding import Finding, Progress
from prag_asp.dataset.verification.row_checks import RowChecks
from prag_asp.errors import PragError
from prag_asp.physics import require_physics
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.without_replacement import with_tasks

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain


def wrong_dataset(folder: Path, trust: bool, physics: bool, workers: int, progress: Progress) -> Iterator[Finding]:
    """Yield findings about one dataset, as `verify` does."""
    data = Dataset.open(folder, trust=trust)
    manifest, tables = data.manifest, TableReader(data.folder)
    progress("files", 0, 1)
    recordings = set[str]()
    for shard in (shard for part in manifest.parts for shard in part.shards):
        with suppress(PragError):  # raised for a table that cannot be read
            recordings |= {row["file"] for row in tables.of_shard("recordings", shard, ["file"])}
    yield from wrong_files(data.folder, manifest, recordings)
    yield from wrong_figures(manifest)
    try:
        domain = data.domain
    except PragError as error:
        yield Finding(NAME, None, f"the domain cannot be read, so nothing else was checked: {error}")
        return
    yield from wrong_card(data.folder, manifest, domain)
    yield from _wrong_tasks(manifest, domain, tables, progress)
    if physics and manifest.spec.budget is not None:
        require_physics()
        from prag_asp.dataset.verification.initial_state_checks import InitialStateChecks

        starts = InitialStateChecks(data.folder, manifest, domain, tables, workers, progress)
        for note in manifest.parts:
            yield from starts.wrong(note)


def _wrong_tasks(manifest: Manifest, domain: Domain, tables: TableReader, progress: Progress) -> Iterator[Finding]:
    """Yield findings about sizes and rows; sizes are counted again, and rows are sampled again."""
    spec, lengths = manifest.spec, manifest.lengths
    if [space.length for space in manifest.spaces] != lengths:  # counting other lengths might never end
        yield Finding(NAME, None, "spaces do not have the requested lengths, so no task was checked")
        return
    try:
        space = TaskSpace(domain, lengths).where(*manifest.where)
        parts = requested_parts(space, spec)
    except PragError as error:
        yield Finding(NAME, None, f"the request cannot be sampled: {error}")
        return
    yield from wrong_sizes(manifest, {length: space.at(length) for length in lengths}, parts)
    rows, figures = RowChecks(manifest, domain, tables, progress), deepcopy(manifest)
    figures.cover = figures.diverse = msgspec.UNSET
    for note in manifest.parts:
        draws = parts[note.name].pick(count())
        try:
            choice = choice_of(space, spec, parts[note.name], spec.candidates_of(spec.division.shares[note.name]))
            if choice is not None:
                passed = list(tables.rows(note, "tasks", ["draw", "plan"]))
                draws = chosen_order(choice, {row["draw"] for row in passed})
        except PragError as error:
            yield Finding(NAME, None, f"parts, {note.name}: its tasks cannot be chosen again: {error}")
            continue
        yield from rows.wrong(note, with_tasks(space, draws))
        if choice is not None:
            record_figures(figures, note.name, choice.figures(passed))
    if (manifest.cover, manifest.diverse) != (figures.cover, figures.diverse):
        yield Finding(NAME, None, f"{'cover' if spec.cover else 'diverse'} does not match the tasks")
