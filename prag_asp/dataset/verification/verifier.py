"""All that is wrong with a data set, from what is cheap to look at to what is dear."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.manifest import NAME, Manifest
from prag_asp.dataset.store.tables import Tables
from prag_asp.dataset.verification.figure_checks import wrong_figures, wrong_sizes
from prag_asp.dataset.verification.file_checks import wrong_card, wrong_files
from prag_asp.dataset.verification.finding import Finding, Looked
from prag_asp.dataset.verification.row_checks import Rows
from prag_asp.errors import PragError
from prag_asp.physics import require_physics
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.without_replacement import Division, ordered_parts, with_tasks

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain


def wrong_dataset(folder: Path, trust: bool, physics: bool, workers: int, progress: Looked) -> Iterator[Finding]:
    """Yield what is wrong with one data set, as `verify` of any of them does."""
    data = Dataset.open(folder, trust=trust)
    manifest, tables = data.manifest, Tables(data.folder)
    progress("files", 0, 1)
    yield from wrong_files(data.folder, manifest, _recordings(manifest, tables))
    yield from wrong_figures(manifest)
    try:
        domain = data.domain
    except PragError as error:
        yield Finding(NAME, None, f"the domain cannot be read, so nothing else was looked at: {error}")
        return
    yield from wrong_card(data.folder, manifest, domain)
    yield from _wrong_tasks(manifest, domain, tables, progress)
    if physics and manifest.asked.budget is not None:
        yield from _wrong_starts(data.folder, manifest, domain, tables, workers, progress)


def _recordings(manifest: Manifest, tables: Tables) -> frozenset[str]:
    """Return the files that the tables of recordings name, as far as they can be read."""
    found = set[str]()
    for part in manifest.parts:
        for shard in part.shards:
            try:
                found |= {row["file"] for row in tables.of_shard("recordings", shard, ["file"])}
            except PragError:
                continue
    return frozenset(found)


def _wrong_tasks(manifest: Manifest, domain: Domain, tables: Tables, progress: Looked) -> Iterator[Finding]:
    """Yield what is wrong with sizes and rows, beside what is counted and drawn now."""
    asked = manifest.asked
    if [space.length for space in manifest.spaces] != list(asked.lengths):  # Of others, nothing may ever be counted.
        yield Finding(NAME, None, "spaces are not of the lengths that were asked for, so no task was looked at")
        return
    try:
        space = TaskSpace(domain, asked.lengths).where(*asked.where)
        division = Division.parse(asked.split, skeletons=asked.skeletons, hold_out=asked.hold_out)
        parts = ordered_parts(
            space, division, seed=asked.seed, weights=space.weights(asked.weights, asked.temperature),
            evenly=asked.evenly, deal=asked.deal,
        )  # fmt: skip
    except PragError as error:
        yield Finding(NAME, None, f"what was asked for cannot be drawn: {error}")
        return
    yield from wrong_sizes(manifest, {length: space.at(length) for length in asked.lengths}, parts)
    rows = Rows(manifest, domain, tables, progress)
    for note in manifest.parts:
        yield from rows.wrong(note, with_tasks(space, parts[note.name].draws()))


def _wrong_starts(
    folder: Path, manifest: Manifest, domain: Domain, tables: Tables, workers: int, progress: Looked
) -> Iterator[Finding]:
    """Yield what is wrong with witnesses and recordings."""
    require_physics()
    from prag_asp.dataset.verification.initial_state_checks import Starts

    starts = Starts(folder, manifest, domain, tables, workers, progress)
    for note in manifest.parts:
        yield from starts.wrong(note)
