"""Merge the parts that several machines have made into the data set that one machine would have made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.dataset_spec import Wanted
from prag_asp.dataset.making.executors import place_of
from prag_asp.dataset.making.run import Progress, Run
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.errors import QueryError
from prag_asp.missing import require_pyarrow
from prag_asp.physics import Budget, Staging
from prag_asp.safe_reading import is_inside, read_bytes
from prag_asp.space.sampling.sharding import ALL, Deal
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.without_replacement import Division
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.store.manifest import Asked, Manifest

SHOWN = 5
"""Numbers of parts that a message names at most."""


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
    """Write the data set of which these are all parts, made by `generate` with ``part="1/N"`` to ``"N/N"``; open it.

    Its bytes are those that one machine writes without `part`. The parts are in any order, and stay as they are. Parts
    end at different draws, since some have better luck; the few draws that none has looked at are looked at here, by
    `workers` or `on` what is named. What was begun goes on. With `trust`, physics may run Python files of the domain.

    Raises:
        QueryError: some are no parts, or not of one data set, or not all of its parts; or a file of them is damaged.
        OutputError: the folder holds something else, or a file cannot be written.
        NotFound: fewer tasks are found in `max_draws` draws a part of the split, or there are no more.
        PragError: as `generate` does, for the draws that are looked at here.
    """
    require_pyarrow()
    from prag_asp.dataset.making.part_merge import Jobs

    place = place_of(workers, on)
    found = _in_order([Dataset.open(part, trust=trust) for part in parts])
    target = Path(folder)
    for part in found:
        if is_inside(target, part.folder):
            where = "is" if target.resolve() == part.folder.resolve() else "lies in"
            raise QueryError(f"{folder}: {where} one of the parts; give a new folder")
    manifest = found[0].manifest
    domain, asked = found[0].domain, manifest.asked
    space = TaskSpace(domain, asked.lengths)
    wanted = _wanted(manifest, max_draws)
    kept = {
        file.path: read_bytes(found[0].folder / file.path, within=found[0].folder)
        for file in (*manifest.domain.files, *manifest.domain.encodings)
    }
    run = Run(space.where(*asked.where), target, wanted, (manifest.domain, kept), place, progress, Jobs(found))
    return run.done()


def _in_order(parts: Sequence[Dataset]) -> list[Dataset]:
    """Return parts by their numbers.

    Raises:
        QueryError: one is none, is of another data set, or is there twice; or some are missing.
    """
    if not parts:
        raise QueryError("no parts to merge; name the folders of all of them")
    by_number: dict[int, Dataset] = {}
    first = parts[0]
    for part in parts:
        deal = part.manifest.asked.deal
        if deal == ALL:
            raise QueryError(f"{part.folder}: is no part of a data set, but a whole one; leave it out")
        told = _difference(first.manifest, part.manifest)
        if told:
            raise QueryError(f"{part.folder}: is a part of another data set than {first.folder}: {told}")
        if deal.number in by_number:
            raise QueryError(f"{part.folder}: is part {deal}, as {by_number[deal.number].folder}; name each part once")
        by_number[deal.number] = part
    of = first.manifest.asked.deal.of
    missing = [number for number in range(1, of + 1) if number not in by_number]
    if missing:
        some = ", ".join(str(Deal(number, of)) for number in missing[:SHOWN])
        rest = len(missing) - SHOWN
        more = f" and {rest} more" if rest > 0 else ""
        raise QueryError(f"{plural(len(missing), 'part')} missing: {some}{more}; name the folders of all {of}")
    return [by_number[number] for number in range(1, of + 1)]


def _difference(one: Manifest, other: Manifest) -> str:
    """Return in what another data set differs from one, but for the number of the part; nothing where it does not."""
    if one.asked.deal.of != other.asked.deal.of:
        return f"one of {other.asked.deal.of} parts, not of {one.asked.deal.of}"
    if one.domain.name != other.domain.name:
        return f"it is of {other.domain.name}, not of {one.domain.name}"
    theirs = msgspec.structs.asdict(other.asked)
    for key, value in msgspec.structs.asdict(one.asked).items():
        if key != "part" and theirs[key] != value:
            return f"it was made with other {key.replace('_', ' ')}"
    if one.domain != other.domain:
        return "it is of another state of the domain or of the encodings"
    if one.wanted != other.wanted:
        return f"it was made for {plural(other.wanted, 'task')}, not {one.wanted}; run the same --tasks for all"
    return ""


def _wanted(manifest: Manifest, max_draws: int | None) -> Wanted:
    """Return what the whole data set is to hold."""
    asked = manifest.asked
    division = Division.parse(asked.split, skeletons=asked.skeletons, hold_out=asked.hold_out)
    return Wanted(
        manifest.wanted, asked.seed, division, _budget(asked), asked.starts, asked.demonstrate, asked.evenly,
        asked.weights, asked.temperature, asked.shard, asked.language, _staging(asked), max_draws,
        phrasings=asked.phrasings,
    )  # fmt: skip


def _budget(asked: Asked) -> Budget | None:
    if asked.budget is None:
        return None
    return Budget(**msgspec.to_builtins(asked.budget))


def _staging(asked: Asked) -> Staging | None:
    told = asked.staging
    if told is None:
        return None
    size = None if told.size is None else (told.size[0], told.size[1])
    return Staging(tuple(told.cameras), size, told.rate, tuple(told.vary))
