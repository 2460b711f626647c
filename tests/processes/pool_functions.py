"""The functions that a pool of workers runs in its tests."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

Wish = tuple[str, object]


@contextmanager
def opened(folder: str) -> Iterator[Callable[[int, Wish], object]]:
    """Yield a function of an index and a wish; `folder` is where it notes what happened."""

    def function(index: int, wish: Wish) -> object:
        name, of = wish
        if name == "raise":
            raise ValueError(f"item {index}")
        if name == "sleep":
            time.sleep(float(str(of)))
        if name == "die":
            os.kill(os.getpid(), 9)
        if name == "die once":
            try:
                Path(folder, f"died_{index}").touch(exist_ok=False)
            except FileExistsError:
                return index
            os.kill(os.getpid(), 9)
        return index if name != "pid" else os.getpid()

    yield function


@contextmanager
def unopened() -> Iterator[Callable[[int, Wish], object]]:
    raise OSError("it cannot be opened")
    yield lambda index, wish: None
