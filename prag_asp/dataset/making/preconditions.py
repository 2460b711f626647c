"""Why a data set is not written into a folder, or has fewer tasks than were wanted."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.store.manifest import NAME, Asked, Manifest, PartNote
from prag_asp.errors import OutputError
from prag_asp.tables.report import shown
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.space.distinct_sampling import TaskOrder

JOURNAL = "journal.jsonl"
"""What physics has said since the last shard, so that a run that was broken off goes on there. It goes at the end."""


def require_ours(folder: Path) -> None:
    """Check that a folder is new, empty, or a data set, before anything is written.

    Raises:
        OutputError: it holds something else.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is no folder; give a new one")
    if not folder.is_dir() or (folder / NAME).is_file():
        return
    begun = {f"{name}{end}" for name in (NAME, JOURNAL) for end in (".part", ".run", ".run.part")}
    other = sorted(path.name for path in folder.iterdir() if path.name not in begun)
    if other:
        raise OutputError(f"{folder}: holds {other[0]}, and is no data set; give a new folder")


def difference(manifest: Manifest, name: str, asked: Asked) -> str:
    """Return in what a data set differs from the one that is asked for."""
    if manifest.domain.name != name:
        return f"is a data set of {manifest.domain.name}, not of {name}"
    for key, value in msgspec.structs.asdict(asked).items():
        before = getattr(manifest.asked, key)
        if before != value:
            return f"is a data set made with other {key.replace('_', ' ')} ({shown(msgspec.to_builtins(before))})"
    return "is a data set of another state of the domain or of the encodings"


def too_few(note: PartNote, part: TaskOrder, limit: int) -> str:
    """Return that there are fewer tasks than wanted, and why."""
    told = f"only {note.tasks} of {plural(note.wanted, 'task')} for {note.name} found in {plural(note.draws, 'draw')}"
    if note.draws >= limit:
        return f"{told}; raise --max-draws"
    if note.draws >= part.size:
        return f"{told}, which are all that there are"
    return f"{told}; those left weigh next to nothing: give other weights, or --uniform"
