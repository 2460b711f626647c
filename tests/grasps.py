"""The grasps of bodies, searched once for all processes that run tests: the search takes seconds for a household."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

_folders: list[Path] = []


@contextmanager
def grasps_shared(folder: Path) -> Iterator[None]:
    """Keep the grasps that are found in a folder, by the content of the body, as the user's cache does."""
    from prag_asp.physics.grasps import body_grasps

    _folders.append(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(body_grasps, "cache_folder", lambda: folder)
        yield
    _folders.pop()


def shared_folder() -> Path | None:
    """Return the folder with the grasps, if they are shared."""
    return _folders[-1] if _folders else None
