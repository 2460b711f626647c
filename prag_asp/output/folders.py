"""Folders that results are written into, and the files in them."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from prag_asp.errors import OutputError
from prag_asp.output.atomic_files import told
from prag_asp.output.partial_file import SUFFIX, flush_folder
from prag_asp.safe_reading import is_inside


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


def file_in(folder: str | Path, name: str) -> Path:
    """Return the path of a file of a folder, which may be somebody else's, to write to it.

    Raises:
        OutputError: what lies there is no file, or a link that leads out of the folder.
    """
    path = Path(folder) / name
    if not is_inside(path, folder):
        raise OutputError(f"{path}: leads out of the folder; remove the link, or choose another folder")
    if os.path.lexists(path) and not path.is_file():
        raise OutputError(f"{path}: is no regular file; remove it, or choose another folder")
    return path


@contextmanager
def building(folder: Path, names: Collection[str]) -> Iterator[Path]:
    """Yield the folder ``NAME.part``, which becomes a new folder in one stroke when the block has written its files.

    What a killed run has left of them is written again.

    Raises:
        OutputError: it cannot be made or renamed, or holds other files than those of these `names`.
    """
    part = make_folder(folder.with_name(folder.name + SUFFIX))
    own = {*names, *(name + SUFFIX for name in names)}
    with told(part):
        strange = sorted({path.name for path in part.iterdir()} - own)
    if strange:
        raise OutputError(f"{part}: holds {strange[0]}, but has to be empty for {folder}; move it away")
    try:
        yield part
        with told(folder):
            flush_folder(part)
            part.rename(folder)
            flush_folder(folder.parent)
    except BaseException:
        for name in own:
            with suppress(OSError):
                (part / name).unlink()
        with suppress(OSError):
            part.rmdir()
        raise
