"""Folders with folders in them, and files that a library writes itself: whole, or not there at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from prag_asp.errors import OutputError
from prag_asp.output.atomic_files import behind, is_stream, told
from prag_asp.output.folders import make_folder
from prag_asp.output.partial_file import SUFFIX, Part, flush_folder


@contextmanager
def growing(folder: Path, name: str, content: bytes) -> Iterator[Path]:
    """Yield ``NAME.part`` to write files and folders into; it becomes a new folder in one stroke.

    It gets a file of a `name` with a `content` in the end. While it grows, ``name.part`` in it marks it as ours, and is
    locked, so that two runs do not mix. What a killed run has left is removed.

    Raises:
        OutputError: there is such a folder already, another run is at it, or something cannot be written.
    """
    if folder.name in ("", ".."):
        raise OutputError(f"{folder}: name a new folder")
    if os.path.lexists(folder) and (folder.is_symlink() or not folder.is_dir() or any(folder.iterdir())):
        raise OutputError(f"{folder}: is there already; remove it, or give a new folder")
    tree = folder.with_name(folder.name + SUFFIX)
    if tree.is_symlink():
        raise OutputError(f"{tree}: is a link, but has to be a folder; remove it")
    make_folder(tree)
    with told(tree):
        _require_ours(tree, name, folder)
        mark = Part(tree / name)
        try:
            _clear(tree, keep=mark.path)
            yield tree
            _flush(tree)
            mark.cut(0)
            mark.write(content, 0)
            mark.replace()
            tree.rename(folder)
            flush_folder(folder.parent)
        except BaseException:
            with suppress(OSError):
                _clear(tree, keep=mark.path)
                mark.discard()
                tree.rmdir()
            raise
        finally:
            mark.close()


@contextmanager
def whole_file(file: Path) -> Iterator[Path]:
    """Yield the path ``NAME.part`` of an empty file, which takes the place of the file when it is written.

    Raises:
        OutputError: it cannot be written, another run is at it, or what is there is no file.
    """
    if is_stream(file):
        raise OutputError(f"{file}: is no regular file; give a file")
    with told(file):
        part = Part(behind(file))
        try:
            part.cut(0)
            yield part.path
            part.replace()
        except BaseException:
            part.discard()
            raise
        finally:
            part.close()


def _require_ours(tree: Path, name: str, folder: Path) -> None:
    """Check that a folder is empty, or has the mark of a run.

    Raises:
        OutputError: it is neither.
    """
    found = sorted(path.name for path in tree.iterdir())
    if found and name not in found and name + SUFFIX not in found:
        raise OutputError(f"{tree}: holds {found[0]}, but has to be empty for {folder}; move it away")


def _clear(tree: Path, keep: Path) -> None:
    """Remove all that is in a folder but for a file; links are not followed."""
    for path in tree.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        elif path != keep:
            path.unlink()


def _flush(tree: Path) -> None:
    """Have all files and folders in a folder outlive a loss of power."""
    for path in tree.rglob("*"):
        if path.is_dir():
            flush_folder(path)
        else:
            descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)
    flush_folder(tree)
