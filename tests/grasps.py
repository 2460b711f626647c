"""The grasps and cavities of bodies, searched once for all processes that run tests: they take seconds for a household.

What is found is kept in a folder, by the content of the body, as the user's cache does.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

_folders: list[Path] = []


@contextmanager
def grasps_shared(folder: Path) -> Iterator[None]:
    """Share the grasps and cavities of bodies in a folder; a test that sets another cache keeps cavities there."""
    from prag_asp.output.cache_files import cache_folder
    from prag_asp.physics.grasps import body_grasps
    from prag_asp.scene.read.cavities import flooding

    _folders.append(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(body_grasps, "cache_folder", lambda: folder)
        patch.setattr(flooding, "cache_folder", lambda: cache_folder() or folder)
        yield
    _folders.pop()


def shared_folder() -> Path | None:
    """Return the folder with the grasps and cavities, if they are shared."""
    return _folders[-1] if _folders else None
