"""Reasons not to write a dataset into a folder, or to end with fewer tasks than requested."""

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
"""The file with the results of the draws since the last shard, to resume an interrupted run; removed at the end."""


def require_dataset_folder(folder: Path) -> None:
    """Check that a folder is new, empty, or a dataset, before anything is written.

    Raises:
        OutputError: it contains something else.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is no folder; give a new one")
    if not folder.is_dir() or (folder / DATASET.name).is_file():
        return
    other = sorted({path.name for path in folder.iterdir()} - {f"{DATASET.name}.part", JOURNAL})
    if other:
        raise OutputError(f"{folder}: holds {other[0]}, and is not a dataset; give a new folder")


def difference(one: Manifest, other: Manifest) -> str:
    """Return the first difference between two manifests with different identities, as a message."""
    if one.domain.name != other.domain.name:
        return f"is a dataset of {one.domain.name}, not of {other.domain.name}"
    before = one.request
    for name, value in other.request.items():
        if before[name] != value:
            return f"is a dataset made with other {name.replace('_', ' ')} ({shown(before[name])})"
    return "is a dataset of another state of the domain or of the encodings"


def too_few(part: PartManifest, available: TaskOrder, limit: int) -> str:
    """Return the message for a part with fewer tasks than requested, with the reason."""
    draws = plural(part.draws, "draw")
    summary = f"only {part.tasks} of {plural(part.requested, 'task')} for {part.name} found in {draws}"
    if part.draws >= limit:
        return f"{summary}; raise --max-draws"
    if part.draws >= available.size:
        return f"{summary}, which are all that there are"
    return f"{summary}; those left weigh next to nothing: give other weights, or --uniform"
