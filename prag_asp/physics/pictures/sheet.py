"""Arrange pictures with captions on one sheet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from prag_asp.physics.pictures.camera import pillow

if TYPE_CHECKING:
    from PIL import Image

INK, QUIET, PAPER = (33, 37, 41), (108, 117, 125), (255, 255, 255)
MARGIN, GUTTER = 14, 12
HEADING, TEXT = 17, 14
HEADING_LINE, TEXT_LINE = 22, 19
ABOVE, BETWEEN = 8, 4


class Panel(NamedTuple):
    """A picture with a heading and a text below it."""

    image: Image.Image
    heading: str
    text: str = ""


def sheet(panels: Sequence[Panel], columns: int, *, lines: int = 1) -> Image.Image:
    """Return a sheet of panels of one size in even rows of at most `columns`, each picture above its caption.

    Headings have room for at least `lines` lines.
    """
    from PIL import ImageDraw  # noqa: PLC0415 - pictures are optional

    width, height = panels[0].image.size
    large, small = _font(HEADING), _font(TEXT)
    written = [(wrap(panel.heading, large, width - 2), wrap(panel.text, small, width - 2)) for panel in panels]
    columns = math.ceil(len(panels) / math.ceil(len(panels) / columns))
    rows = [range(begin, min(begin + columns, len(panels))) for begin in range(0, len(panels), columns)]
    # The height of each caption, and the largest height in each row, in pixels.
    heights = [
        ABOVE + HEADING_LINE * max(lines, len(heading)) + (BETWEEN + TEXT_LINE * len(text) if text else 0)
        for heading, text in written
    ]
    rooms = [max(heights[i] for i in row) for row in rows]
    total = (
        len(rows[0]) * (width + GUTTER) - GUTTER + 2 * MARGIN,
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
                pen.text((x + 2, below + HEADING_LINE * number), line, font=large, fill=INK)
            below += HEADING_LINE * len(heading) + BETWEEN
            for number, line in enumerate(text):
                pen.text((x + 2, below + TEXT_LINE * number), line, font=small, fill=QUIET)
        y += height + room + GUTTER
    return page


def line_count(panels: Sequence[Panel]) -> int:
    """Return the number of lines in the longest heading."""
    return max(len(wrap(panel.heading, _font(HEADING), panel.image.width - 2)) for panel in panels)


def wrap(text: str, font: Any, width: int) -> list[str]:
    """Return a text wrapped to a width in pixels; a word that exceeds the width gets a separate line."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and font.getlength(longer) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def _font(size: int) -> Any:
    """Return the font with a size in pixels."""
    from PIL import ImageFont  # noqa: PLC0415 - pictures are optional

    return ImageFont.load_default(size=size)
