"""Arrange pictures with captions on one sheet."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from prag_asp.physics.pictures.camera import pillow

if TYPE_CHECKING:
    from PIL import Image

INK, QUIET, PAPER = (33, 37, 41), (92, 101, 109), (255, 255, 255)
MARGIN, GUTTER = 14, 12
ABOVE, BETWEEN = 8, 4

PAGE, LEGIBLE = 830, 12.5
"""The width in pixels at which web pages such as those of GitHub show a wide picture, and the minimum size of text at
that width."""

HEADING, TEXT, LINE = 1.2, 14, 1.35
"""The size of a heading relative to that of the text, the minimum size of the text in pixels, and the height of a line
relative to the size of its text."""


class Panel(NamedTuple):
    """A picture with a heading and a text below it."""

    image: Image.Image
    heading: str
    text: str = ""


def sheet(panels: Sequence[Panel], columns: int, *, lines: int = 1) -> Image.Image:
    """Return a sheet of panels of one size in even rows of at most `columns`, each picture above its caption.

    Headings have room for at least `lines` lines. The text grows with the width of the sheet, so that it is legible
    when the sheet is shown at the width of a page.
    """
    from PIL import ImageDraw  # noqa: PLC0415 - pictures are optional

    width, height = panels[0].image.size
    columns = math.ceil(len(panels) / math.ceil(len(panels) / columns))
    large_size, small_size = text_sizes(width, columns)
    large, small = font(large_size), font(small_size)
    large_line, small_line = round(LINE * large_size), round(LINE * small_size)
    written = [(wrap(panel.heading, large, width - 2), wrap(panel.text, small, width - 2)) for panel in panels]
    rows = [range(begin, min(begin + columns, len(panels))) for begin in range(0, len(panels), columns)]
    # The height of each caption, and the largest height in each row, in pixels.
    heights = [
        ABOVE + large_line * max(lines, len(heading)) + (BETWEEN + small_line * len(text) if text else 0)
        for heading, text in written
    ]
    rooms = [max(heights[i] for i in row) for row in rows]
    total = (
        sheet_width(width, columns),
        sum(height + room for room in rooms) + (len(rows) - 1) * GUTTER + 2 * MARGIN,
    )
    page: Image.Image = pillow().new("RGB", total, PAPER)
    pen = ImageDraw.Draw(page)
    y = MARGIN
    for row, room in zip(rows, rooms, strict=True):
        for column, i in enumerate(row):
            x = MARGIN + column * (width + GUTTER)
            page.paste(panels[i].image, (x, y))
            heading, text = written[i]
            below = y + height + ABOVE
            for number, line in enumerate(heading):
                pen.text((x + 2, below + large_line * number), line, font=large, fill=INK)
            below += large_line * len(heading) + BETWEEN
            for number, line in enumerate(text):
                pen.text((x + 2, below + small_line * number), line, font=small, fill=QUIET)
        y += height + room + GUTTER
    return page


def sheet_width(width: int, columns: int) -> int:
    """Return the width of a sheet in pixels, given the width of a picture and the number of columns."""
    return columns * (width + GUTTER) - GUTTER + 2 * MARGIN


def text_sizes(width: int, columns: int) -> tuple[int, int]:
    """Return the font sizes, in pixels, of headings and text on a sheet with `columns` columns of pictures."""
    text = max(TEXT, math.ceil(LEGIBLE * sheet_width(width, columns) / PAGE))
    return round(HEADING * text), text


def line_count(headings: Iterable[str], width: int) -> int:
    """Return the number of lines that the longest heading takes up below a picture of a given width in pixels."""
    large = font(text_sizes(width, 1)[0])
    return max(len(wrap(heading, large, width - 2)) for heading in headings)


def wrap(text: str, letters: Any, width: int) -> list[str]:
    """Return a text wrapped to a width in pixels in the font `letters`; a word that is too wide gets its own line."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and letters.getlength(longer) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def font(size: int) -> Any:
    """Return the font in a given size in pixels."""
    from PIL import ImageFont  # noqa: PLC0415 - pictures are optional

    return ImageFont.load_default(size=size)
