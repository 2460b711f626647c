"""A disk that fails at the n-th thing that is asked of it, as SQLite's tests have it; or a kill at that moment."""

from __future__ import annotations

import errno
import json
import os
import signal
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest.mock import patch

Ask = Callable[..., Any]


@dataclass
class Disk:
    """Counts what is asked of it, and fails from the time `first` on, `times` times; it never fails without."""

    first: int | None = None
    times: int = 1
    code: int = errno.ENOSPC
    kills: bool = False
    asked: list[str] = field(default_factory=list)

    def ask(self, name: str, really: Ask, half: Ask | None = None) -> Any:
        """Do something, or fail; what is cut in two is done by half before."""
        self.asked.append(name)
        if self.first is None or not self.first <= len(self.asked) < self.first + self.times:
            return really()
        if half is not None:
            half()
        if self.kills:
            os.kill(os.getpid(), signal.SIGKILL)
        raise OSError(self.code, os.strerror(self.code))

    @contextmanager
    def working(self) -> Iterator[Disk]:
        """Put it in place of the real one, for files that are being written."""
        real_open, real_write, real_cut, real_flush = os.open, os.pwrite, os.ftruncate, os.fsync
        replace, rename, make = Path.replace, Path.rename, Path.mkdir

        def opened(path: Any, flags: int, *more: Any, **others: Any) -> int:
            if not str(path).endswith(".part") or not flags & os.O_CREAT:
                return real_open(path, flags, *more, **others)
            found: int = self.ask("open", lambda: real_open(path, flags, *more, **others))
            return found

        def written(descriptor: int, content: Any, at: int) -> int:
            half = memoryview(content)[: len(content) // 2]
            found: int = self.ask(
                "write", lambda: real_write(descriptor, content, at), lambda: real_write(descriptor, half, at)
            )
            return found

        with (
            patch.object(os, "open", opened),
            patch.object(os, "pwrite", written),
            patch.object(os, "ftruncate", lambda *given: self.ask("cut", lambda: real_cut(*given))),
            patch.object(os, "fsync", lambda *given: self.ask("flush", lambda: real_flush(*given))),
            patch.object(Path, "replace", lambda *given: self.ask("replace", lambda: replace(*given))),
            patch.object(Path, "rename", lambda *given: self.ask("rename", lambda: rename(*given))),
            patch.object(Path, "mkdir", lambda *given, **more: self.ask("mkdir", lambda: make(*given, **more))),
        ):
            yield self


def killed(number: int, work: Callable[[], object]) -> bool:
    """Do something in a process that is killed at its n-th request to the disk; return whether it was."""

    def mortal() -> None:
        with Disk(number, kills=True).working():
            work()

    status, _ = _fork(mortal)
    return os.WIFSIGNALED(status)


def forked(work: Callable[[], object]) -> Any:
    """Return the JSON value that a function returns in a forked process."""
    status, answer = _fork(work)
    assert not status
    return json.loads(answer)


def _fork(work: Callable[[], object]) -> tuple[int, str]:
    """Return the status with which a forked process ended, and the JSON value that `work` returned there."""
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # The child of a process with threads ends without them.
        child = os.fork()
    if not child:
        try:
            value = work()
            os.write(writing, json.dumps(value if isinstance(value, (tuple, int, str)) else None).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as answer:
        text = answer.read()
    return os.waitpid(child, 0)[1], text


def content(folder: Path) -> dict[str, bytes]:
    """Return the files below a folder, by their paths in it."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
