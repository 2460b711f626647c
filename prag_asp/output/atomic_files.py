"""Files that are written in one stroke."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from prag_asp.errors import OutputError
from prag_asp.output.partial_file import EVERYBODY, Part

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def replace_file(file: str | Path, content: bytes, *, mode: int = EVERYBODY, follow: bool = True) -> None:
    """Write a file whole: whatever ends this, the file is the old one, or the new one.

    What is no file (a device, a pipe) is written as it is. With `follow`, a link is followed, otherwise replaced.
    `mode` has the permissions of a new file.

    Raises:
        OutputError: it cannot be written.
    """
    path = Path(file)
    with told(path):
        if is_stream(path):
            with path.open("wb") as stream:
                stream.write(content)
            return
        part = Part(behind(path) if follow else path, mode)
        try:
            part.cut(0)
            part.write(content, 0)
            part.replace()
        except BaseException:
            part.discard()
            raise
        finally:
            part.close()


def is_stream(path: Path) -> bool:
    """Tell whether there is something that is no file, and that cannot be replaced: a device, a pipe, a folder."""
    return path.exists() and not path.is_file()


def behind(path: Path) -> Path:
    """Return the file that a link leads to; one that is no link is itself."""
    return path.resolve() if path.is_symlink() else path


@contextmanager
def told(path: Path | str) -> Iterator[None]:
    """Tell what the system answers in one line with the name of the file.

    Raises:
        OutputError: something cannot be written.
    """
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        hint = "free some space" if error.errno in FULL else "choose another file"
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}; {hint}") from None
