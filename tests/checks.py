"""The checks of shipped domains, made once in a process; tests of checks call them, or check other domains."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

import pytest

from prag_asp.domain import load
from prag_asp.lint import Checked, check
from prag_asp.program.paths import data_folder
from prag_asp.program.sources import Program, Source

_checked = lru_cache(maxsize=32)(check)


@contextmanager
def checks_shared() -> Iterator[None]:
    """Check each shipped domain once; other ones may read files that tests change."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(load, "check", _check)
        yield


def _check(program: Program, settings: Source) -> Checked:
    return (_checked if settings.path.is_relative_to(data_folder("domains")) else check)(program, settings)
