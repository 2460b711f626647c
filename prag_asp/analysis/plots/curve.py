"""Plot the numbers of plans, tasks, skeletons and all sequences of names against the length, as in the paper.

Counts exceed the range of floats, so their decimal logarithms are plotted, which are far more precise than a picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import MAX_EMAX, Context, Decimal, localcontext
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.analysis.plots.picture import COLORS, DATES, DOTS, GREY, saved
from prag_asp.errors import PicturesMissingError, QueryError
from prag_asp.html import Markup, element, html_page, scroll_table
from prag_asp.output import replace_file
from prag_asp.processes.progress_events import stage
from prag_asp.space.task_space import TaskSpace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KINDS = (".html", *DATES)

SIZE = (8.0, 5.5)
"""The size of a picture in inches."""

MARKED = 60
"""The maximum number of lengths with a marker for each length."""


@dataclass(frozen=True)
class Series:
    """A line in the plot: its name, and a count for each length from 1 on."""

    name: str
    counts: tuple[int, ...]

    def points(self) -> tuple[tuple[int, ...], tuple[float, ...]]:
        """Return the lengths with a count above 0, and the decimal logarithms of their counts."""
        heights = enumerate(logarithms(self.counts), 1)
        points = [(length, height) for length, height in heights if height is not None]
        return tuple(length for length, _ in points), tuple(height for _, height in points)


@dataclass(frozen=True)
class Curve:
    """The lines for one domain; the last one is drawn with dashes."""

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
    names = len(space.action_texts("skeleton"))
    counted = [
        Series(f"{level}s", tuple(space.at(length).count(level) for length in lengths))
        for level in ("plan", "task", "skeleton")
    ]
    every = Series(f"{names}^n, all sequences of names", tuple(names**length for length in lengths))
    return Curve(space.domain.label, (*counted, every))


def check_file(file: str) -> None:
    """Check that a curve can be written to a file, before counting.

    Raises:
        QueryError: the file's extension is unknown.
        PicturesMissingError: matplotlib is not installed.
    """
    if Path(file).suffix.lower() not in KINDS:
        raise QueryError(f"{file}: a curve is written to a file that ends in {', '.join(KINDS[:-1])} or {KINDS[-1]}")
    if find_spec("matplotlib") is None:
        raise PicturesMissingError("a curve needs matplotlib: pip install 'prag_asp[pictures]'")


def draw_curve(curve: Curve, file: str) -> None:
    """Write the curve as a picture, or as a self-contained web page with the picture and the counts.

    Raises:
        QueryError: the file's extension is unknown.
        PicturesMissingError: matplotlib is not installed.
        OutputError: the file cannot be written.
    """
    check_file(file)
    stage("drawing the curve")
    kind = Path(file).suffix.lower()
    replace_file(file, page(curve).encode() if kind == ".html" else saved(figure(curve), kind))


def figure(curve: Curve) -> Figure:
    """Return the curve as a matplotlib figure."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - heavy
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415 - heavy

    drawn = Figure(figsize=SIZE, dpi=DOTS, layout="constrained")
    axes = drawn.add_subplot(xlabel="length n", ylabel="number")
    axes.set_title(curve.title, parse_math=False)
    for series, color in zip(curve.series, (*COLORS[:3], GREY), strict=True):
        line = "--" if series is curve.series[-1] else "o-" if len(series.counts) <= MARKED else "-"
        axes.plot(*series.points(), line, color=color, linewidth=2, label=series.name, clip_on=False)
    axes.set_ylim(bottom=0.0)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    axes.yaxis.set_major_formatter("$10^{{{x:.0f}}}$")
    axes.grid(axis="y", color="#e0e0e0")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="upper left")
    return drawn


def page(curve: Curve) -> str:
    """Return the curve as a web page: the picture, and a table of the counts."""
    picture = saved(figure(curve), ".svg").decode()
    rows = [
        (str(length), *map(shown, counts))
        for length, counts in enumerate(zip(*(series.counts for series in curve.series), strict=True), 1)
    ]
    return html_page(
        curve.title,
        element("h1", curve.title),
        element("div", Markup(picture[picture.index("<svg") :]), class_="picture"),
        scroll_table(("length", *(series.name for series in curve.series)), rows, label="counts by length"),
    )


def logarithms(counts: tuple[int, ...]) -> list[float | None]:
    """Return the decimal logarithm of each count, or None for 0."""
    with localcontext(Context(prec=30, Emax=MAX_EMAX)):
        return [float(Decimal(count).log10()) if count else None for count in counts]


def shown(count: int) -> str:
    """Return a count of up to 30 digits in full, or otherwise its number of digits."""
    height = logarithms((count,))[0] or 0
    return f"{count:,}" if height < 30 else f"{int(height) + 1:,} digits"
