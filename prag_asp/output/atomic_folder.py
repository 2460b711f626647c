"""Atomic folders, which are filled under a temporary name, flushed and renamed; folders and paths for output files."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from prag_asp.errors import OutputError
from prag_asp.output.atomic_file import SUFFIX, flush_folder, locked, output_errors
from prag_asp.safe_reading import is_inside


@contextmanager
def new_folder(folder: Path) -> Iterator[Path]:
    """Yield an empty folder to fill, which is renamed atomically to the new folder when the block ends.

    The folder is filled as ``NAME.part/NAME``, while ``NAME.part`` is locked. The remains of a killed run are removed
    first.

    Raises:
        OutputError: the folder exists already, another run is writing it, or a file or folder cannot be written.
    """
    if folder.name in ("", ".."):
        raise OutputError(f"{folder}: name a new folder")
    _require_new(folder)
    part = folder.with_name(folder.name + SUFFIX)
    if part.is_symlink():
        raise OutputError(f"{part}: is a link, but has to be a folder; remove it")
    with output_errors(part):
        lock = locked(part, lambda: os.open(make_folder(part), os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW))
    inner = part / folder.name
    try:
        _require_new(folder)  # another run may have created it in the meantime
        with output_errors(part):
            others = sorted({path.name for path in part.iterdir()} - {folder.name})
            if others:
                raise OutputError(f"{part}: holds {others[0]}, but has to be empty for {folder}; move {others[0]} away")
            _remove(inner)
            inner.mkdir()
        yield inner
        with output_errors(folder):
            _flush(inner)
            inner.rename(folder)
            flush_folder(folder.parent)
    finally:
        with suppress(OSError):
            _remove(inner)
            part.rmdir()
        os.close(lock)


def _require_new(folder: Path) -> None:
    """Check that a folder does not exist, or is empty."""
    if os.path.lexists(folder) and (folder.is_symlink() or not folder.is_dir() or any(folder.iterdir())):
        raise OutputError(f"{folder}: already exists; remove it, or give a new folder")


def make_folder(folder: str | Path) -> Path:
    """Create a folder and its parents if they are missing, and return the folder.

    Raises:
        OutputError: the folder cannot be created.
    """
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{path}: the folder cannot be created: {error.strerror}; choose another") from None
    return path


def file_in(folder: str | Path, name: str) -> Path:
    """Return the path of a file to be written in a folder, which may contain links made by others.

    Raises:
        OutputError: the path exists and is not a regular file, or is a link that leads out of the folder.
    """
    path = Path(folder) / name
    if not is_inside(path, folder):
        raise OutputError(f"{path}: leads out of the folder; remove the link, or choose another folder")
    if os.path.lexists(path) and not path.is_file():
        raise OutputError(f"{path}: is not a regular file; remove it, or choose another folder")
    return path


def _remove(folder: Path) -> None:
    """Remove a folder if it exists; links are not followed."""
    if folder.is_symlink() or folder.is_file():
        folder.unlink()
    elif folder.exists():
        shutil.rmtree(folder)


def _flush(folder: Path) -> None:
    """Flush all files and folders in a folder."""
    for path in folder.rglob("*"):
        if path.is_dir():
            flush_folder(path)
        else:
            descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)
    flush_folder(folder)
