"""A folder of recorded demonstrations, one file per task."""

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
    """Writes demonstrations into a folder, each file atomically; without a folder, it writes nothing."""

    def __init__(self, folder: str | Path | None):
        """Create the folder, if there is one.

        Raises:
            OutputError: it cannot be created.
        """
        self._folder = None if folder is None else make_folder(folder)

    def write(self, number: int, demonstration: Demonstration | None) -> str | None:
        """Write the demonstration of the task of a line, counted from 1, and return the name of its file.

        Raises:
            OutputError: it cannot be written.
        """
        if self._folder is None or demonstration is None:
            return None
        name = name_of(number)
        demonstration.save(file_in(self._folder, name))
        return name


def name_of(number: int) -> str:
    """Return the name of the file for the task of a line, counted from 1."""
    return f"{number:06d}.npz"


def remove_after(folder: str | Path, number: int) -> None:
    """Remove the recordings of lines after a number, which an interrupted run left behind."""
    for path in [*Path(folder).glob("*.npz")]:
        match = NAME.fullmatch(path.name)
        if match is not None and int(match[1]) > number:
            with suppress(OSError):
                path.unlink()
