"""The common interface of all formats of problems: it turns folders into problems and failures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from prag_asp.audit.audited_problem import AuditedProblem


@dataclass(frozen=True)
class FailedRead:
    """A file in a suite that could not be read: its location, and the reason."""

    suite: str
    place: str
    text: str


class ProblemSource(Protocol):
    """A format of problems."""

    def recognizes(self, folder: Path) -> bool:
        """Return whether a folder contains problems in this format."""

    def read(self, folders: Mapping[str, Path]) -> Iterator[AuditedProblem | FailedRead]:
        """Yield the problems in folders, which are given by the names of their suites."""
