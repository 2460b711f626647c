"""Why a dataset is not written into a folder, or has fewer tasks than requested."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.store.manifest import DATASET, Manifest, PartManifest
from prag_asp.errors import OutputError
from prag_asp.tables.report import shown
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.space.distinct_sampling import TaskOrder

JOURNAL = "journal.part"
"""The results of the draws since the last shard, from which an interrupted run is resumed; it is removed at the end."""


def require_dataset_folder(folder: Path) -> None:
    """Check that a folder is new, empty, or a dataset, before anything is written.

    Raises:
        OutputError: it holds something else.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is no folder; give a new one")
    if not folder.is_dir() or (folder / DATASET.name).is_file():
        return
    other = sorted({path.name for path in folder.iterdir()} - {f"{DATASET.name}.part", JOURNAL})
    if other:
        raise OutputError(f"{folder}: holds {other[0]}, and is not a dataset; give a new folder")


def difference(one: Manifest, other: Manifest) -> str:
    """Return how the dataset of one manifest differs from that of another, which has another identity."""
    if one.domain.name != other.domain.name:
        return f"is a dataset of {one.domain.name}, not of {other.domain.name}"
    before = one.request
    for name, value in other.request.items():
        if before[name] != value:
            return f"is a dataset made with other {name.replace('_', ' ')} ({shown(before[name])})"
    return "is a dataset of another state of the domain or of the encodings"


def too_few(part: PartManifest, available: TaskOrder, limit: int) -> str:
    """Return in words that a part has fewer tasks than requested, and why."""
    found = f"only {part.tasks} of {plural(part.requested, 'task')} for {part.name} found in"
    found = f"{found} {plural(part.draws, 'draw')}"
    if part.draws >= limit:
        return f"{found}; raise --max-draws"
    if part.draws >= available.size:
        return f"{found}, which are all that there are"
    return f"{found}; those left weigh next to nothing: give other weights, or --uniform"
