"""The folder of the demonstrations of some tasks, one file a task."""

from __future__ import annotations

import json
import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.errors import OutputError
from prag_asp.output import file_in, make_folder, replace_file
from prag_asp.safe_reading import read_bytes

if TYPE_CHECKING:
    from prag_asp.physics import Demonstration

RUN = "run.json"
"""The file that says of which run the recordings of a folder are: the same run writes them again, no other does."""

LARGEST_RUN = 10_000
"""Bytes of that file."""

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


def claim(folder: str | Path, run: str | None) -> None:
    """Make a folder, and note that its recordings are of a run.

    Raises:
        OutputError: it has recordings of another run, or of none that is known; or it cannot be written.
    """
    path = Path(folder)
    if any(path.glob("*.npz")) and (run is None or _run_in(path) != run):
        raise OutputError(f"{folder}: has recordings already, of another run; give a new folder, or remove them")
    make_folder(path)
    if run is not None:
        replace_file(path / RUN, f"{json.dumps({'run': run})}\n".encode(), follow=False)


def recorded(folder: str | Path, number: int) -> int:
    """Return how many tasks on the first lines, so many, have a recording in a folder."""
    return sum(1 for path in Path(folder).glob("*.npz") if (at := _number(path)) is not None and at <= number)


def remove_after(folder: str | Path, number: int) -> None:
    """Remove the recordings of lines above a number: a longer run has left them."""
    for path in [*Path(folder).glob("*.npz")]:
        at = _number(path)
        if at is not None and at > number:
            with suppress(OSError):
                path.unlink()


def _number(path: Path) -> int | None:
    """Return the line of the task that a recording is of."""
    found = NAME.fullmatch(path.name)
    return int(found[1]) if found else None


def _run_in(folder: Path) -> str | None:
    """Return of which run the recordings of a folder are, None where that is not said."""
    try:
        told = json.loads(read_bytes(folder / RUN, within=folder, at_most=LARGEST_RUN))
        return str(told["run"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
