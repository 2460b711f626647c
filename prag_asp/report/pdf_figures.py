"""The figures of a report as PDF vector graphics, as wide as a column of a paper, with 8-point text."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from prag_asp.analysis.plots.picture import saved
from prag_asp.errors import PicturesMissingError
from prag_asp.report.plots import PlotSeries, ReportPlot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN = 3.35
"""The width of a column in inches; it is 3.33 for ACM, 3.5 for IEEE and 4.8 for Springer (one column)."""

HEIGHT, ROW, MARGIN = 2.4, 0.16, 0.75
"""The heights in inches of a figure, of a row of a category, and of the axis and legend in a figure with such rows."""

POINTS = 8
"""The size of all text, in points."""

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#a86f00", "#777777", "#000000", "#56b4e9")
"""Colours for colour-blind readers (Okabe and Ito 2008)."""

SETTINGS: dict[Any, Any] = {
    "font.size": POINTS, "axes.titlesize": POINTS, "axes.labelsize": POINTS, "xtick.labelsize": POINTS,
    "ytick.labelsize": POINTS, "legend.fontsize": POINTS, "axes.linewidth": 0.6, "lines.linewidth": 1.2,
    "pdf.fonttype": 42, "text.parse_math": False,
}  # fmt: skip
"""The Matplotlib settings; font type 42 keeps text searchable and editable."""

LONGEST = 34
"""The number of characters of a category's name that fit beside a figure."""


def require_matplotlib() -> None:
    """Check that figures can be drawn.

    Raises:
        PicturesMissingError: matplotlib is not installed.
    """
    if find_spec("matplotlib") is None:
        raise PicturesMissingError("figures need matplotlib: pip install 'prag_asp[pictures]'")


def pdf_figure(plot: ReportPlot) -> bytes:
    """Return a figure as a PDF file; the same figure gives the same bytes.

    Raises:
        PicturesMissingError: matplotlib is not installed.
    """
    require_matplotlib()
    from matplotlib import rc_context  # noqa: PLC0415 - heavy
    from matplotlib.figure import Figure  # noqa: PLC0415

    height = MARGIN + ROW * len(plot.categories) * _rows(plot) if plot.categories else HEIGHT
    with rc_context(SETTINGS):
        drawn = Figure(figsize=(COLUMN, COLUMN if plot.kind == "map" else height), layout="constrained")
        axes = drawn.add_subplot()
        for number, series in enumerate(plot.series):
            _draw(axes, plot, series, number)
        _finish(drawn, axes, plot)
        return saved(drawn, ".pdf")


def _rows(plot: ReportPlot) -> int:
    return len(plot.series) if plot.kind == "intervals" else 1


def _draw(axes: Axes, plot: ReportPlot, series: PlotSeries, number: int) -> None:
    color = COLORS[number % len(COLORS)]
    name, places, heights = series.name, series.places, series.heights
    if plot.kind == "map":
        axes.scatter(places, heights, s=3, color=color, label=name, linewidths=0)
    elif plot.kind == "columns":
        axes.bar(places, heights, plot.width, color=color, edgecolor="white", linewidth=0.3, label=name)
    elif plot.kind == "bars":
        if series.style == "marks":
            axes.plot(heights, places, "|", color=color, markersize=8, markeredgewidth=1.5, label=name)
        else:
            axes.barh(places, heights, 0.75, color=color, label=name)
    elif plot.kind == "intervals":
        count = len(plot.series)
        rows = [place + (number - (count - 1) / 2) * 0.8 / count for place in places]
        axes.errorbar(
            heights, rows, xerr=_errors(series), fmt="o", markersize=3, color=color, label=name, elinewidth=0.9
        )
    else:
        line = {"line": "-", "dashed": "--"}.get(series.style, "" if not series.lows else ":")
        mark = "" if series.style == "dashed" else "o"
        ends = _errors(series) if series.lows else None
        axes.errorbar(
            places, heights, yerr=ends, fmt=line + mark, markersize=2.5, color=color, label=name, elinewidth=0.9
        )


def _errors(series: PlotSeries) -> list[list[float]]:
    """Return the distances from the heights to the ends of their intervals."""
    return [
        [max(height - low, 0.0) for height, low in zip(series.heights, series.lows, strict=True)],
        [max(high - height, 0.0) for height, high in zip(series.heights, series.highs, strict=True)],
    ]


def _finish(drawn: Figure, axes: Axes, plot: ReportPlot) -> None:
    """Label and scale the axes."""
    from matplotlib.ticker import MaxNLocator, PercentFormatter  # noqa: PLC0415 - heavy

    axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlabel(plot.across)
    axes.set_ylabel(plot.up)
    if plot.kind == "map":
        axes.set_xticks([])
        axes.set_yticks([])
        axes.set_aspect("equal")
        axes.spines[["left", "bottom"]].set_visible(False)
    elif plot.categories:
        axes.set_yticks(range(len(plot.categories)), [_short(each) for each in plot.categories])
        axes.invert_yaxis()
        axes.set_ylim(len(plot.categories) - 0.4, -0.6)
        axes.grid(axis="x", color="#e0e0e0", linewidth=0.5)
    else:
        if plot.name != "distances":
            axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
        axes.grid(axis="y", color="#e0e0e0", linewidth=0.5)
    axes.set_axisbelow(True)
    if plot.logarithmic:
        axes.yaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
        axes.yaxis.set_major_formatter(lambda value, _: f"$10^{{{value:.0f}}}$")
        for label in axes.get_yticklabels():
            label.set_parse_math(True)
    if plot.share:
        (axes.xaxis if plot.kind == "intervals" else axes.yaxis).set_major_formatter(PercentFormatter(1.0))
        (axes.set_xlim if plot.kind == "intervals" else axes.set_ylim)(-0.03, 1.03)
    if len(plot.series) > 1:
        drawn.legend(loc="outside upper center", ncols=2, frameon=False, handletextpad=0.4, columnspacing=1.0)


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
