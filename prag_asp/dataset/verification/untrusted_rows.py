"""Rows of untrusted tables: a value may be missing wherever Parquet allows it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from prag_asp.dataset.verification.finding import Finding

OPTIONAL = ("verdict", "details")
"""Columns that may have no value, or values without some of theirs."""

Row = tuple[int, Mapping[str, Any]]
"""The number of a row in its file, and its values."""


def whole_rows(file: str, rows: Iterable[Mapping[str, Any]]) -> tuple[list[Row], list[Finding]]:
    """Return the complete rows of a file, and a finding for each other row."""
    found, wrong = list[Row](), list[Finding]()
    for place, row in enumerate(rows):
        lacking = sorted({name for name, value in row.items() for _ in _missing(name, value)})
        if lacking:
            wrong.append(Finding(file, place, f"has no value in {', '.join(lacking)}"))
        else:
            found.append((place, row))
    return found, wrong


def _missing(name: str, value: object) -> Iterator[None]:
    """Yield something for each value that is missing."""
    if value is None and name not in OPTIONAL:
        yield None
    elif isinstance(value, dict):
        for inner, each in value.items():
            if inner not in OPTIONAL:
                yield from _missing(inner, each)
    elif isinstance(value, list):
        for each in value:
            yield from _missing("", each)
