"""The coverage and the distances of the chosen tasks of a dataset, as stored in dataset.json."""

from __future__ import annotations

import msgspec

from prag_asp.tables.json_fields import Whole


class CoverFigures(msgspec.Struct, frozen=True):
    """The numbers of reachable and of covered combinations of `strength` factors, and the missing combinations."""

    strength: Whole
    reachable: Whole
    covered: Whole
    missing: list[str]


class DiverseFigures(msgspec.Struct, frozen=True):
    """The `separation` of the tasks: the smallest distance between two of them, in a metric.

    Each of the `candidates` is within `radius` of a task.
    """

    metric: str
    candidates: Whole
    separation: float
    radius: float
