"""Merge the parts that several machines have made into the dataset that one machine would have made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.making.executors import executor_of
from prag_asp.dataset.making.run import DatasetRun, Progress
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.errors import QueryError
from prag_asp.missing import require_pyarrow
from prag_asp.safe_reading import is_inside, read_bytes
from prag_asp.space.sampling.sharding import ALL, Deal
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.task_spaces import TaskSpaces
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.store.manifest import Manifest

SHOWN = 5
"""The most parts that a message names."""


def merge(
    parts: Sequence[str | Path],
    folder: str | Path,
    *,
    workers: int = 1,
    on: str | None = None,
    max_draws: int | None = None,
    trust: bool = False,
    progress: Progress = lambda words, done, total: None,
) -> Dataset:
    """Write the dataset of which these are all machine parts, made with ``part="1/N"`` to ``"N/N"``; open it.

    Its bytes are those that one machine writes without `part`. The parts are in any order, and are not changed. Parts
    end at different draws; the few draws that no part has validated are validated here, by `workers` or `on` a cluster.
    An interrupted merge is resumed by the same call. With `trust`, physics may run Python files of the domain.

    Raises:
        QueryError: some are no parts, or not of one dataset, or not all of its parts; or a file of them is damaged.
        OutputError: the folder holds something else, or a file cannot be written.
        NotFound: fewer tasks are found in `max_draws` draws a part of the split, or there are no more.
        PragError: as `generate` does, for the draws that are validated here.
    """
    require_pyarrow()
    from prag_asp.dataset.making.machine_parts import MachineParts

    executor = executor_of(workers, on)
    found = _in_order([Dataset.open(part, trust=trust) for part in parts])
    target = Path(folder)
    for part in found:
        if is_inside(target, part.folder):
            where = "is" if target.resolve() == part.folder.resolve() else "lies in"
            raise QueryError(f"{folder}: {where} one of the parts; give a new folder")
    manifest = found[0].manifest
    domain, lengths = found[0].domain, manifest.lengths
    space = TaskSpace(domain, lengths[0]) if len(lengths) == 1 else TaskSpaces(domain, lengths)
    files = {
        file.path: read_bytes(found[0].folder / file.path, within=found[0].folder)
        for file in (*manifest.domain.files, *manifest.domain.encodings)
    }
    return DatasetRun(
        space.where(*manifest.where), target, msgspec.structs.replace(manifest.spec, part=None),
        (manifest.domain, files), executor, progress, max_draws, MachineParts(found),
    ).done()  # fmt: skip


def _in_order(parts: Sequence[Dataset]) -> list[Dataset]:
    """Return parts by their numbers.

    Raises:
        QueryError: one is none, is of another dataset, or is there twice; or some are missing.
    """
    if not parts:
        raise QueryError("no parts to merge; name the folders of all of them")
    by_number: dict[int, Dataset] = {}
    first = parts[0]
    for part in parts:
        deal = part.manifest.spec.deal
        if deal == ALL:
            raise QueryError(f"{part.folder}: is no part of a dataset, but a whole one; leave it out")
        what = _difference(first.manifest, part.manifest)
        if what:
            raise QueryError(f"{part.folder}: is a part of another dataset than {first.folder}: {what}")
        if deal.number in by_number:
            raise QueryError(f"{part.folder}: is part {deal}, as {by_number[deal.number].folder}; name each part once")
        by_number[deal.number] = part
    of = first.manifest.spec.deal.of
    missing = [number for number in range(1, of + 1) if number not in by_number]
    if missing:
        some = ", ".join(str(Deal(number, of)) for number in missing[:SHOWN])
        rest = len(missing) - SHOWN
        more = f" and {rest} more" if rest > 0 else ""
        raise QueryError(f"{plural(len(missing), 'part')} missing: {some}{more}; name the folders of all {of}")
    return [by_number[number] for number in range(1, of + 1)]


def _difference(one: Manifest, other: Manifest) -> str:
    """Return how another dataset differs from one, except by the number of the part; nothing where it does not."""
    if one.spec.deal.of != other.spec.deal.of:
        return f"one of {other.spec.deal.of} parts, not of {one.spec.deal.of}"
    if one.domain.name != other.domain.name:
        return f"it is of {other.domain.name}, not of {one.domain.name}"
    theirs = other.request
    for key, value in one.request.items():
        if key != "part" and theirs[key] != value:
            return f"it was made with other {key.replace('_', ' ')}"
    if one.domain != other.domain:
        return "it is of another state of the domain or of the encodings"
    if one.spec.tasks != other.spec.tasks:
        return f"it was made for {plural(other.spec.tasks, 'task')}, not {one.spec.tasks}; run the same --tasks for all"
    return ""
