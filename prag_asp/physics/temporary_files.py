"""Temporary files that exist only while PyBullet reads them.

Worker processes are killed from outside and run no finalizers, so a folder that existed as long as its process would be
left behind.
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
def temporary_folder(files: Mapping[str, bytes]) -> Iterator[Path]:
    """Write files into a temporary folder and delete it afterwards; calls must not be nested.

    A thread uses the same path each time. Different contents must have different names, because PyBullet caches meshes
    by path as long as the process lives. Files that an interrupted run left in the folder are deleted first.

    Raises:
        OutputError: the folder cannot be written.
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
        try:
            folder.mkdir(mode=0o700)
            for name, content in files.items():
                (folder / name).write_bytes(content)
        except OSError as error:
            raise OutputError(f"{folder}: cannot be written: {error.strerror}; {REMEDY}") from None
        yield folder
    finally:
        with uninterrupted():
            rmtree(folder, ignore_errors=True)


@cache
def _name(process: int, thread: int) -> str:
    """Return a name that is unique to a thread and cannot be guessed; a forked process gets a new name."""
    return f"prag_asp_{process}_{thread:x}_{uuid4().hex}"
