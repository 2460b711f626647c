"""Folders that results are written into."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from prag_asp.errors import OutputError
from prag_asp.output.files import told
from prag_asp.output.part import SUFFIX, flush_folder


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
