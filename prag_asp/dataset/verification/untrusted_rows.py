"""Read rows of untrusted tables, in which Parquet allows any value to be missing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from prag_asp.dataset.verification.finding import Finding

OPTIONAL = ("verdict", "details")
"""Columns and fields whose values may be missing."""

Row = tuple[int, Mapping[str, Any]]
"""The index of a row in its file, and the values of the row."""


def whole_rows(file: str, rows: Iterable[Mapping[str, Any]]) -> tuple[list[Row], list[Finding]]:
    """Return the complete rows of a file, and a finding for each incomplete row."""
    complete, wrong = list[Row](), list[Finding]()
    for place, row in enumerate(rows):
        missing = sorted({name for name, value in row.items() for _ in _missing(name, value)})
        if missing:
            wrong.append(Finding(file, place, f"has no value in {', '.join(missing)}"))
        else:
            complete.append((place, row))
    return complete, wrong


def _missing(name: str, value: object) -> Iterator[None]:
    """Yield once for each missing value."""
    if value is None and name not in OPTIONAL:
        yield None
    elif isinstance(value, dict):
        for inner, each in value.items():
            if inner not in OPTIONAL:
                yield from _missing(inner, each)
    elif isinstance(value, list):
        for each in value:
            yield from _missing("", each)
