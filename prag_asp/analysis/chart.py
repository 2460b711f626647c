"""The curve as a picture for a paper, drawn with Pillow."""

from __future__ import annotations

from itertools import pairwise
from math import ceil
from typing import TYPE_CHECKING

from prag_asp.analysis.curve import Curve, logarithms

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont, ImageFont

WIDTH, HEIGHT = 1600, 1100
"""Pixels of the picture."""

SMOOTH = 2
"""Times that the picture is drawn larger and then reduced, so that its lines are smooth."""

LEFT, RIGHT, TOP, BOTTOM = 170, 50, 90, 120
"""Pixels around the plot."""

COLORS = ("#0072b2", "#d55e00", "#009e73", "#777777")
"""Colours that colour-blind readers tell apart (Okabe and Ito 2008)."""

TICKS = 8
"""Marks of an axis, at most."""


def draw_chart(curve: Curve, file: str) -> None:
    """Write the curve as a PNG of 1600 x 1100 pixels."""
    from PIL import Image, ImageDraw  # noqa: PLC0415 - heavy

    image = Image.new("RGB", (WIDTH * SMOOTH, HEIGHT * SMOOTH), "white")
    _Chart(curve, ImageDraw.Draw(image)).draw()
    image.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS).save(file)


class _Chart:
    """The places of lengths and logarithms on a picture."""

    def __init__(self, curve: Curve, pen: ImageDraw) -> None:
        self._curve, self._pen = curve, pen
        self._lines = [logarithms(series.counts) for series in curve.series]
        self._lengths = len(curve.series[0].counts)
        self._step = nice_step(max((height or 0 for line in self._lines for height in line), default=1) or 1)
        highest = max((height or 0 for line in self._lines for height in line), default=1)
        self._top = max(ceil(highest / self._step), 1) * self._step

    def _place(self, length: float, height: float) -> tuple[float, float]:
        across = (length - 1) / max(self._lengths - 1, 1)
        x = LEFT + across * (WIDTH - LEFT - RIGHT)
        y = HEIGHT - BOTTOM - height / self._top * (HEIGHT - TOP - BOTTOM)
        return x * SMOOTH, y * SMOOTH

    def draw(self) -> None:
        """Draw the axes, the lines and the legend."""
        self._axes()
        for place, (line, color) in enumerate(zip(self._lines, COLORS, strict=True)):
            points = [self._place(n, height) for n, height in enumerate(line, 1) if height is not None]
            self._line(points, color, dashed=place == len(self._lines) - 1)
            self._key(place, color)
        self._text((WIDTH / 2, TOP / 2), self._curve.title, 40, "mm")

    def _axes(self) -> None:
        right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
        for exponent in range(0, self._top + 1, self._step):
            _, y = self._place(1, exponent)
            self._pen.line([(LEFT * SMOOTH, y), (right * SMOOTH, y)], "#e0e0e0", SMOOTH)
            self._text((LEFT - 46, y / SMOOTH), "10", 32, "rm")
            self._text((LEFT - 44, y / SMOOTH - 14), str(exponent), 22, "lm")
        step = nice_step(self._lengths)
        for length in sorted({1, *range(step, self._lengths + 1, step)}):
            x, _ = self._place(length, 0)
            self._pen.line([(x, bottom * SMOOTH), (x, (bottom + 10) * SMOOTH)], "black", 2 * SMOOTH)
            self._text((x / SMOOTH, bottom + 34), str(length), 32, "mm")
        corners = [(LEFT, TOP), (LEFT, bottom), (right, bottom)]
        self._pen.line([(x * SMOOTH, y * SMOOTH) for x, y in corners], "black", 2 * SMOOTH)
        self._text(((LEFT + right) / 2, HEIGHT - 36), "length n", 34, "mm")
        self._text((20, TOP - 40), "number", 34, "lm")

    def _line(self, points: list[tuple[float, float]], color: str, *, dashed: bool) -> None:
        if dashed:
            for piece in dashes(points, 18 * SMOOTH):
                self._pen.line(piece, color, 4 * SMOOTH)
            return
        self._pen.line(points, color, 5 * SMOOTH, joint="curve")
        if self._lengths <= 60:
            size = 8 * SMOOTH
            for x, y in points:
                self._pen.ellipse([x - size, y - size, x + size, y + size], fill=color)

    def _key(self, place: int, color: str) -> None:
        y = TOP + 40 + 50 * place
        ends: list[tuple[float, float]] = [((LEFT + x) * SMOOTH, y * SMOOTH) for x in (40, 120)]
        self._line(ends, color, dashed=place == len(self._lines) - 1)
        self._text((LEFT + 140, y), self._curve.series[place].name, 32, "lm")

    def _text(self, place: tuple[float, float], text: str, size: int, anchor: str) -> None:
        x, y = place
        self._pen.text((x * SMOOTH, y * SMOOTH), text, "black", _font(size * SMOOTH), anchor)


def nice_step(largest: float) -> int:
    """Return a whole step of 1, 2 or 5 times a power of ten that leads to `largest` in few steps."""
    step = 1
    while largest / step > TICKS:
        step = step * 5 // 2 if str(step).startswith("2") else step * 2
    return step


def dashes(points: list[tuple[float, float]], length: float) -> list[list[tuple[float, float]]]:
    """Return every other piece of a line of straight parts, each of a length."""
    pieces: list[list[tuple[float, float]]] = [points[:1]]
    left = length
    for (x, y), (toward_x, toward_y) in pairwise(points):
        distance = ((toward_x - x) ** 2 + (toward_y - y) ** 2) ** 0.5
        done = 0.0
        while distance - done > left:
            done += left
            cut = (x + (toward_x - x) * done / distance, y + (toward_y - y) * done / distance)
            pieces[-1].append(cut)
            pieces.append([cut])
            left = length
        left -= distance - done
        pieces[-1].append((toward_x, toward_y))
    return [piece for piece in pieces[::2] if len(piece) > 1]


def _font(size: int) -> FreeTypeFont | ImageFont:
    from PIL import ImageFont  # noqa: PLC0415 - heavy

    return ImageFont.load_default(size)
