"""A finding of the verification of a dataset."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from prag_asp.errors import one_line

Progress = Callable[[str, int, int], None]
"""Takes the progress: what is checked, how many were, and how many there are."""


class Finding(NamedTuple):
    """A defect: the file, the row in it from 0 or None for the whole file, and what is wrong."""

    file: str
    row: int | None
    what: str

    def __str__(self) -> str:
        """Return it as one line that is safe for a terminal, whatever untrusted files contain."""
        place = self.file if self.row is None else f"{self.file}: row {self.row}"
        return one_line(f"{place}: {self.what}")
