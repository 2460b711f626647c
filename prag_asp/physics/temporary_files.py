"""Files that are there only while PyBullet reads them.

Processes of multiprocessing end without Python's own finalizers, and workers are ended from outside: a folder that were
there as long as its process would outlive it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from shutil import rmtree
from tempfile import gettempdir
from threading import get_ident
from uuid import uuid4

from prag_asp.errors import OutputError
from prag_asp.processes.workers import uninterrupted

REMEDY = "set TMPDIR to a folder with room that can be written"


@contextmanager
def lent(files: Mapping[str, bytes]) -> Iterator[Path]:
    """Write files into a folder, which is gone afterwards; use it within no other one.

    The folder has the same path each time in a thread, for PyBullet remembers meshes by their paths, for good: give
    what differs different names. What an interruption left of it goes before it is made again.

    Raises:
        OutputError: it cannot be written.
    """
    try:
        folder = Path(gettempdir(), _name(os.getpid(), get_ident()))
    except OSError as error:
        raise OutputError(f"{error.strerror}; {REMEDY}") from None
    if not files:
        yield folder
        return
    try:
        rmtree(folder, ignore_errors=True)
        _write(files, folder)
        yield folder
    finally:
        with uninterrupted():
            rmtree(folder, ignore_errors=True)


def _write(files: Mapping[str, bytes], folder: Path) -> None:
    """Make a folder with files.

    Raises:
        OutputError: it cannot be written.
    """
    try:
        folder.mkdir(mode=0o700)
        for name, content in files.items():
            (folder / name).write_bytes(content)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written: {error.strerror}; {REMEDY}") from None


@cache
def _name(process: int, thread: int) -> str:
    """Return a name that no other thread has, nor could anybody guess; a process that is forked has its own."""
    return f"prag_asp_{process}_{thread:x}_{uuid4().hex}"
