"""What is wrong with a dataset, and where."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from prag_asp.errors import one_line

Progress = Callable[[str, int, int], None]
"""Is told what is being looked at, at how many was looked, and of how many."""


class Finding(NamedTuple):
    """Something that is wrong: the file, the row in it from 0 or None for all of it, and what it is."""

    file: str
    row: int | None
    what: str

    def __str__(self) -> str:
        """Return it as one line of a message, whatever the files of a stranger are called and say."""
        place = self.file if self.row is None else f"{self.file}: row {self.row}"
        return one_line(f"{place}: {self.what}")
