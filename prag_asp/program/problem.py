"""What the linter reports: a place, what is wrong there, and what to do."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from prag_asp.errors import DomainError


class Problem(NamedTuple):
    """One line of the report; `text` reads ``what is wrong; what to do``."""

    path: Path
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.text}"


def raise_problems(problems: Iterable[Problem]) -> None:
    """Raise all problems as one error, each once, in the order they were found in.

    Raises:
        DomainError: there is a problem.
    """
    lines = list(dict.fromkeys(map(str, problems)))
    if lines:
        raise DomainError("\n".join(lines))
