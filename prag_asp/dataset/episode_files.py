"""A folder of recorded demonstrations, one file per task."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.output import file_in

if TYPE_CHECKING:
    from prag_asp.physics import Demonstration

NAME = re.compile(r"(\d{6,})\.npz")


def name_of(number: int) -> str:
    """Return the name of the file for the task on a given line, counting from 1."""
    return f"{number:06d}.npz"


def write_episode(folder: Path | None, number: int, demonstration: Demonstration | None) -> str | None:
    """Write a task's demonstration into a folder, and return the name of the file, or None if an argument is None.

    Raises:
        OutputError: the file cannot be written.
    """
    if folder is None or demonstration is None:
        return None
    demonstration.save(file_in(folder, name_of(number)))
    return name_of(number)


def remove_after(folder: str | Path, number: int) -> None:
    """Remove the recordings for all lines after a given one, which an interrupted run left behind."""
    for path in [*Path(folder).glob("*.npz")]:
        match = NAME.fullmatch(path.name)
        if match is not None and int(match[1]) > number:
            with suppress(OSError):
                path.unlink()
