"""The PDDL line from which each line of a program comes, and the layout of programs according to these lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Literal, NamedTuple

from prag_asp.program.sources import Source

File = Literal["domain", "problem"]

PART = "#program "


class FileLine(NamedTuple):
    """A line of the domain file or the problem file."""

    file: File
    line: int


class PlacedLine(str):
    """A line of a program, or a part of a statement; `place` is the PDDL line of its origin."""

    place: FileLine

    def __new__(cls, text: str, place: FileLine) -> PlacedLine:
        """Return a line."""
        line = super().__new__(cls, text)
        line.place = place
        return line


def sources_of(lines: Iterable[str], paths: Mapping[File, Path]) -> Iterator[Source]:
    """Yield a program as sources with the paths of the PDDL files, each statement on its PDDL line.

    Each source contains one program part, so several sources may share a path. Lines without a place are omitted.
    """
    header = ""
    statements: dict[tuple[str, File], dict[int, list[str]]] = {}
    for each in lines:
        if isinstance(each, PlacedLine):
            statements.setdefault((header, each.place.file), {}).setdefault(each.place.line, []).append(each.strip())
        elif each.startswith(PART):
            header = each
    for (part, file), rows in statements.items():
        text = "\n".join(" ".join(rows.get(number, ())) for number in range(1, max(rows) + 1))
        yield Source(paths[file], f"{part} {text}\n" if part else f"{text}\n")
