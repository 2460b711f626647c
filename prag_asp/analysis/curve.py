"""The curve of the paper: how many plans, tasks and skeletons there are of each length, beside all sequences of names.

Counts outgrow every float, so their decimal logarithms are drawn: they are exact to far more digits than a picture has.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import MAX_EMAX, Context, Decimal, localcontext
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.errors import OutputError, QueryError
from prag_asp.space.task_space import TaskSpace

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

KINDS = (".html", ".png")


@dataclass(frozen=True)
class Series:
    """A line of the curve: its name, and a count for each length from 1 on."""

    name: str
    counts: tuple[int, ...]


@dataclass(frozen=True)
class Curve:
    """The lines for one domain."""

    title: str
    series: tuple[Series, ...]


def counts_by_length(space: TaskSpace) -> Curve:
    """Return the counts of plans, tasks and skeletons for the lengths from 1 to that of the space.

    Raises:
        QueryError: the length is below 1.
    """
    if space.length < 1:
        raise QueryError("a curve needs lengths from 1 on; give a larger length")
    lengths = range(1, space.length + 1)
    names = len(space.letters("skeleton"))
    counted = [
        Series(f"{level}s", tuple(space.at(length).count(level) for length in lengths))
        for level in ("plan", "task", "skeleton")
    ]
    every = Series(f"{names}^n, all sequences of names", tuple(names**length for length in lengths))
    return Curve(space.domain.label, (*counted, every))


def check_file(file: str) -> None:
    """Refuse a file that no picture is written to.

    Raises:
        QueryError: it ends in neither .html nor .png.
    """
    if Path(file).suffix.lower() not in KINDS:
        raise QueryError(f"{file}: a curve is written to a file that ends in {' or '.join(KINDS)}")


def draw_curve(curve: Curve, file: str) -> None:
    """Write the curve as a web page that needs no network, or as a picture.

    Raises:
        QueryError: the file's ending is unknown, or the package that draws is not installed.
        OutputError: the file cannot be written.
    """
    check_file(file)
    try:
        if Path(file).suffix.lower() == ".html":
            figure(curve).write_html(file, include_plotlyjs=True)
        else:
            from prag_asp.analysis.chart import draw_chart  # noqa: PLC0415 - it imports this file

            draw_chart(curve, file)
    except ImportError as error:
        raise QueryError(f"{error.name} is missing; install it with: pip install 'prag_asp[pictures]'") from None
    except OSError as error:
        raise OutputError(f"{file}: cannot be written: {error.strerror or error}; choose another file") from None


def figure(curve: Curve) -> Figure:
    """Return the curve as a figure of plotly, with the exact counts where the pointer is."""
    from plotly import graph_objects  # noqa: PLC0415 - heavy

    result = graph_objects.Figure()
    for place, series in enumerate(curve.series):
        heights = logarithms(series.counts)
        dash = "dash" if place == len(curve.series) - 1 else "solid"
        points = [(length, height) for length, height in enumerate(heights, 1) if height is not None]
        result.add_scatter(
            x=[length for length, _ in points],
            y=[height for _, height in points],
            name=series.name,
            mode="lines+markers" if len(heights) <= 60 else "lines",
            line={"dash": dash},
            text=[shown(series.counts[length - 1]) for length, _ in points],
            hovertemplate="n = %{x}: %{text}<extra>%{fullData.name}</extra>",
        )
    result.update_layout(
        template="simple_white",
        title=curve.title,
        xaxis_title="length n",
        yaxis={"title": "number", "tickprefix": "10<sup>", "ticksuffix": "</sup>", "tickformat": "d"},
        legend={"x": 0.02, "y": 0.98},
    )
    return result


def logarithms(counts: tuple[int, ...]) -> list[float | None]:
    """Return the decimal logarithm of each count, or None for 0."""
    with localcontext(Context(prec=30, Emax=MAX_EMAX)):
        return [float(Decimal(count).log10()) if count else None for count in counts]


def shown(count: int) -> str:
    """Return a count in full where it has at most 30 digits, else how many it has."""
    height = logarithms((count,))[0] or 0
    return f"{count:,}" if height < 30 else f"{int(height) + 1:,} digits"
