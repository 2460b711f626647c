"""Figures for a paper, drawn with Pillow: curves and heat maps side by side in one picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image, ImageDraw, ImageFont

from prag_asp.analysis.chart import SMOOTH, dashes

if TYPE_CHECKING:
    from PIL.ImageFont import FreeTypeFont
    from PIL.ImageFont import ImageFont as PlainFont

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours that colour-blind readers tell apart (Okabe and Ito 2008)."""

GREY, INK, GRID = "#777777", "#212529", "#e3e6ea"
LOW, HIGH = (0xFD, 0xF1, 0xE7), (0x00, 0x5A, 0x8C)
"""Colours of a heat map at 0 and at its largest value."""

PANEL, TITLE = (620, 520), 56
"""Pixels of a panel, and of the title above all."""

LEFT, RIGHT, TOP, BOTTOM = 84, 24, 56, 78
"""Pixels around the plot within a panel."""

Point = tuple[float, float]


@dataclass(frozen=True)
class Curves:
    """A panel of lines over named places of the x axis; `reference` is a dotted line with its name."""

    title: str
    across: str
    up: str
    places: Sequence[str]
    lines: Sequence[tuple[str, Sequence[float | None]]]
    low: float = 0.0
    high: float = 100.0
    ticks: int = 5
    reference: tuple[str, float] | None = None
    legend: str = "lower right"


@dataclass(frozen=True)
class Heat:
    """A panel of coloured cells: `cells` by row, from the top down, None where there is nothing; 0 to `high`."""

    title: str
    across: str
    up: str
    columns: Sequence[str]
    rows: Sequence[str]
    cells: Sequence[Sequence[float | None]]
    high: float = 100.0
    shown: Callable[[float], str] = "{:.0f}".format


class _Pen:
    """Draws in the pixels of the finished picture, on one that is `SMOOTH` times as large."""

    def __init__(self, draw: ImageDraw.ImageDraw) -> None:
        self._draw = draw

    def line(self, points: Sequence[Point], color: str, width: float = 1.0) -> None:
        places = [(x * SMOOTH, y * SMOOTH) for x, y in points]
        self._draw.line(places, color, round(width * SMOOTH), joint="curve")

    def dashed(self, one: Point, two: Point, color: str) -> None:
        for piece in dashes([one, two], 7.0):
            self.line(piece, color, 2.0)

    def dot(self, x: float, y: float, color: str, radius: float = 5.0) -> None:
        corners = [(x - radius) * SMOOTH, (y - radius) * SMOOTH, (x + radius) * SMOOTH, (y + radius) * SMOOTH]
        self._draw.ellipse(corners, fill=color)

    def box(self, x: float, y: float, right: float, bottom: float, color: str) -> None:
        self._draw.rectangle([x * SMOOTH, y * SMOOTH, right * SMOOTH - 1, bottom * SMOOTH - 1], fill=color)

    def text(self, x: float, y: float, words: str, size: int = 18, anchor: str = "mm", color: str = INK) -> None:
        self._draw.text((x * SMOOTH, y * SMOOTH), words, color, _font(size * SMOOTH), anchor)

    def length(self, words: str, size: int) -> float:
        return self._draw.textlength(words, _font(size * SMOOTH)) / SMOOTH


def draw(panels: Sequence[Curves | Heat], title: str, file: Path, across: int = 3) -> None:
    """Write panels under a title as a PNG, at most `across` of them in a row."""
    columns = min(across, len(panels))
    rows = -(-len(panels) // columns)
    size = (columns * PANEL[0], TITLE + rows * PANEL[1])
    image = Image.new("RGB", (size[0] * SMOOTH, size[1] * SMOOTH), "white")
    pen = _Pen(ImageDraw.Draw(image))
    pen.text(size[0] / 2, TITLE / 2 + 6, title, 24)
    for place, panel in enumerate(panels):
        x, y = place % columns * PANEL[0], TITLE + place // columns * PANEL[1]
        (_curves if isinstance(panel, Curves) else _heat)(pen, panel, x, y)  # type: ignore[operator]
    file.parent.mkdir(parents=True, exist_ok=True)
    image.resize(size, Image.Resampling.LANCZOS).save(file, optimize=True)


def _frame(pen: _Pen, panel: Curves | Heat, x: float, y: float) -> tuple[float, float, float, float]:
    """Write what stands around a plot, and return its borders: left, top, right, bottom."""
    left, top, right, bottom = x + LEFT, y + TOP, x + PANEL[0] - RIGHT, y + PANEL[1] - BOTTOM
    pen.text((left + right) / 2, y + TOP / 2 - 4, panel.title, 20)
    pen.text((left + right) / 2, y + PANEL[1] - 22, panel.across)
    pen.text(x + 14, top - 22, panel.up, 18, "lm")
    return left, top, right, bottom


def _curves(pen: _Pen, panel: Curves, x: float, y: float) -> None:
    left, top, right, bottom = _frame(pen, panel, x, y)
    steps = max(len(panel.places) - 1, 1)
    inset = 26

    def at(place: float, value: float) -> Point:
        share = (value - panel.low) / (panel.high - panel.low)
        return left + inset + place / steps * (right - left - 2 * inset), bottom - share * (bottom - top)

    for tick in range(panel.ticks + 1):
        value = panel.low + tick * (panel.high - panel.low) / panel.ticks
        _, height = at(0, value)
        pen.line([(left, height), (right, height)], GRID)
        pen.text(left - 10, height, f"{value:g}", anchor="rm")
    for place, name in enumerate(panel.places):
        across, _ = at(place, panel.low)
        pen.line([(across, bottom), (across, bottom + 6)], INK)
        pen.text(across, bottom + 20, name)
    pen.line([(left, top), (left, bottom), (right, bottom)], INK, 1.5)
    if panel.reference is not None:
        name, value = panel.reference
        _, height = at(0, value)
        pen.dashed((left, height), (right, height), GREY)
        pen.text(right - 6, height - 14, name, 17, "rm", GREY)
    for (_, values), color in zip(panel.lines, COLORS, strict=False):
        points = [at(place, value) for place, value in enumerate(values) if value is not None]
        pen.line(points, color, 3.0)
        for point in points:
            pen.dot(*point, color)
    _legend(pen, panel, (left, top, right, bottom))


def _legend(pen: _Pen, panel: Curves, borders: tuple[float, float, float, float]) -> None:
    """Name the lines in a corner of the plot."""
    left, top, right, bottom = borders
    wide = 46 + max((pen.length(name, 17) for name, _ in panel.lines), default=0.0)
    begin = right - wide - 12 if panel.legend.endswith("right") else left + 30
    first = bottom - 16 - 24 * len(panel.lines) if panel.legend.startswith("lower") else top + 18
    for row, ((name, _), color) in enumerate(zip(panel.lines, COLORS, strict=False)):
        height = first + 24 * row
        pen.line([(begin, height), (begin + 34, height)], color, 3.0)
        pen.dot(begin + 17, height, color)
        pen.text(begin + 44, height, name, 17, "lm")


def _heat(pen: _Pen, panel: Heat, x: float, y: float) -> None:
    left, top, right, bottom = _frame(pen, panel, x, y)
    wide, high = (right - left) / len(panel.columns), (bottom - top) / len(panel.rows)
    for row, name in enumerate(panel.rows):
        pen.text(left - 12, top + (row + 0.5) * high, name, anchor="rm")
        for column, value in enumerate(panel.cells[row]):
            a, b = left + column * wide, top + row * high
            if value is None:
                pen.box(a, b, a + wide, b + high, "#f4f5f7")
                continue
            share = min(1.0, max(0.0, value / panel.high))
            color = tuple(round(low + share * (end - low)) for low, end in zip(LOW, HIGH, strict=True))
            pen.box(a, b, a + wide, b + high, "#{:02x}{:02x}{:02x}".format(*color))
            ink = "#ffffff" if share > 0.55 else INK
            pen.text(a + wide / 2, b + high / 2, panel.shown(value), 17, color=ink)
    for column, name in enumerate(panel.columns):
        pen.text(left + (column + 0.5) * wide, bottom + 20, name)


def _font(size: int) -> FreeTypeFont | PlainFont:
    return ImageFont.load_default(size)


def gallery(pictures: Sequence[Image.Image], captions: Sequence[Sequence[str]], file: Path, gap: int = 16) -> None:
    """Write pictures side by side as a PNG, each above the lines of its caption."""
    wide, high = pictures[0].size
    room = 24 * max(map(len, captions)) + 2 * gap
    size = (len(pictures) * (wide + gap) + gap, high + room + gap)
    image = Image.new("RGB", (size[0] * SMOOTH, size[1] * SMOOTH), "white")
    pen = _Pen(ImageDraw.Draw(image))
    for place, lines in enumerate(captions):
        for row, line in enumerate(lines):
            pen.text(gap + place * (wide + gap) + 4, gap + high + 24 + 24 * row, line, 18, "lm")
    reduced = image.resize(size, Image.Resampling.LANCZOS)
    for place, each in enumerate(pictures):
        reduced.paste(each, (gap + place * (wide + gap), gap))
    file.parent.mkdir(parents=True, exist_ok=True)
    reduced.save(file, optimize=True)
