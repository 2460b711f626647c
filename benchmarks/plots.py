"""Figures for a paper: curves and heat maps side by side, and images with captions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from PIL import Image, ImageDraw, ImageFont

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""A palette for colour-blind readers (Okabe and Ito 2008)."""

GREY, GRID = "#777777", "#e3e6ea"
HEAT = LinearSegmentedColormap.from_list("heat", ["#fdf1e7", "#005a8c"])
NOTHING, DARK = "#f4f5f7", 0.55
"""The colour of an empty cell, and the share of the largest value above which a cell's text is white."""

PANEL, DOTS = (6.2, 5.2), 100
"""The size of a panel in inches, and the resolution in pixels per inch."""

GAP, LINE = 16, 24
"""The gap between images and the height of a caption line, in pixels."""


@dataclass(frozen=True)
class Curves:
    """A panel of lines over labelled positions of the x axis; `reference` is the label and height of a dashed line."""

    title: str
    across: str
    up: str
    places: Sequence[str]
    lines: Sequence[tuple[str, Sequence[float | None]]]
    low: float = 0.0
    high: float = 100.0
    reference: tuple[str, float] | None = None
    legend: str = "lower right"


@dataclass(frozen=True)
class Heat:
    """A panel of coloured cells: `cells` by row, from top to bottom, None if empty; the scale is 0 to `high`."""

    title: str
    across: str
    up: str
    columns: Sequence[str]
    rows: Sequence[str]
    cells: Sequence[Sequence[float | None]]
    high: float = 100.0
    shown: Callable[[float], str] = "{:.0f}".format


def draw(panels: Sequence[Curves | Heat], title: str, file: Path, across: int = 3) -> None:
    """Write panels under a title as a PNG, at most `across` in a row."""
    columns = min(across, len(panels))
    rows = -(-len(panels) // columns)
    layout = ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.12)
    figure = Figure(figsize=(columns * PANEL[0], rows * PANEL[1] + 0.5 * bool(title)), dpi=DOTS, layout=layout)
    figure.suptitle(title, fontsize="x-large")
    for place, panel in enumerate(panels, 1):
        axes = figure.add_subplot(rows, columns, place, title=panel.title, xlabel=panel.across, ylabel=panel.up)
        if isinstance(panel, Curves):
            _curves(axes, panel)
        else:
            _heat(axes, panel)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


def _curves(axes: Axes, panel: Curves) -> None:
    places = range(len(panel.places))
    for (name, values), color in zip(panel.lines, COLORS, strict=False):
        heights = [np.nan if value is None else value for value in values]
        axes.plot(places, heights, "o-", color=color, label=name, clip_on=False)
    if panel.reference is not None:
        name, height = panel.reference
        axes.axhline(height, color=GREY, linestyle="--")
        axes.annotate(name, (1.0, height), (-6, 4), axes.get_yaxis_transform(), "offset points", ha="right", color=GREY)
    axes.set_xticks(places, panel.places)
    axes.set_ylim(panel.low, panel.high)
    axes.grid(axis="y", color=GRID)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc=panel.legend)


def _heat(axes: Axes, panel: Heat) -> None:
    shares = np.array([[np.nan if value is None else value / panel.high for value in row] for row in panel.cells])
    axes.imshow(shares, HEAT.with_extremes(bad=NOTHING), vmin=0.0, vmax=1.0, aspect="auto")
    for (row, column), share in np.ndenumerate(shares):
        value = panel.cells[row][column]
        if value is not None:
            ink = "white" if share > DARK else "black"
            axes.text(column, row, panel.shown(value), color=ink, ha="center", va="center")
    axes.set_xticks(range(len(panel.columns)), panel.columns)
    axes.set_yticks(range(len(panel.rows)), panel.rows)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def gallery(pictures: Sequence[Image.Image], captions: Sequence[Sequence[str]], file: Path) -> None:
    """Write images side by side as a PNG, each above its caption."""
    wide, high = pictures[0].size
    room = LINE * max(map(len, captions)) + 3 * GAP
    sheet = Image.new("RGB", (len(pictures) * (wide + GAP) + GAP, high + room), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(18)
    for place, (picture, lines) in enumerate(zip(pictures, captions, strict=True)):
        left = GAP + place * (wide + GAP)
        sheet.paste(picture, (left, GAP))
        for row, line in enumerate(lines):
            pen.text((left + 4, 2 * GAP + high + LINE * row), line, "black", font)
    file.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(file, optimize=True)
