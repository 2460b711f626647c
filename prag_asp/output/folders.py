"""Folders that results are written into."""

from __future__ import annotations

from pathlib import Path

from prag_asp.errors import OutputError


def make_folder(folder: str | Path) -> Path:
    """Make a folder and those that it lies in, where they are not there yet, and return it.

    Raises:
        OutputError: it cannot be made.
    """
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{path}: the folder cannot be made: {error.strerror}; choose another") from None
    return path
