"""A finding from the verification of a dataset."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from prag_asp.errors import one_line

Progress = Callable[[str, int, int], None]
"""A callback that reports progress: a message, the number of items checked, and the total number."""


class Finding(NamedTuple):
    """A defect: the file, the index of the row (None for the whole file), and a description."""

    file: str
    row: int | None
    what: str

    def __str__(self) -> str:
        """Return the finding as one line without control characters, because the files may be untrusted."""
        place = self.file if self.row is None else f"{self.file}: row {self.row}"
        return one_line(f"{place}: {self.what}")
