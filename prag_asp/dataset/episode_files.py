"""The folder of the demonstrations of some tasks, one file a task."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.output import file_in, make_folder

if TYPE_CHECKING:
    from prag_asp.physics import Demonstration

NAME = re.compile(r"(\d{6,})\.npz")


class Recordings:
    """Writes demonstrations into a folder, each file whole; no folder, no files."""

    def __init__(self, folder: str | Path | None):
        """Make the folder, where there is to be one.

        Raises:
            OutputError: it cannot be made.
        """
        self._folder = None if folder is None else make_folder(folder)

    def write(self, number: int, demonstration: Demonstration | None) -> str | None:
        """Write the demonstration of the task on a line, counted from 1, and return the name of its file.

        Raises:
            OutputError: it cannot be written.
        """
        if self._folder is None or demonstration is None:
            return None
        name = name_of(number)
        demonstration.save(file_in(self._folder, name))
        return name


def name_of(number: int) -> str:
    """Return the name of the file for the task on a line, counted from 1."""
    return f"{number:06d}.npz"


def remove_after(folder: str | Path, number: int) -> None:
    """Remove the recordings of lines above a number: an interrupted run has left them."""
    for path in [*Path(folder).glob("*.npz")]:
        found = NAME.fullmatch(path.name)
        if found is not None and int(found[1]) > number:
            with suppress(OSError):
                path.unlink()
