"""Common parts of all pictures: colours, resolution, and files that are identical in every run."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DATES = {".png": "Creation Time", ".svg": "Date", ".pdf": "CreationDate"}
"""The metadata key for the date in each picture format; dates are omitted."""

DOTS = 200
"""Pixels per inch."""

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours for colour-blind readers (Okabe and Ito 2008); the first is used for single lines."""

GREY = "#777777"
"""The colour for tasks without a group, and for all sequences of names."""


def saved(drawn: Figure, kind: str) -> bytes:
    """Return a figure as a reproducible picture in a given format."""
    from matplotlib import rc_context  # noqa: PLC0415 - heavy

    buffer = BytesIO()
    with rc_context({"svg.hashsalt": "prag_asp"}):
        drawn.savefig(buffer, format=kind.removeprefix("."), metadata={DATES[kind]: None})
    return buffer.getvalue()
