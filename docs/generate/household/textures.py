"""Procedural textures: small pictures with few colours. The scene multiplies them by the colour of an object."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Floats = NDArray[np.float64]
SIDE = 128
COLOURS = 24
"""The number of colours of a file, to keep it small."""


def noise(rng: np.random.Generator, rows: int, columns: int, height: int = SIDE, width: int = SIDE) -> Floats:
    """Return smooth noise between 0 and 1 that repeats, of shape (height, width, 1)."""
    coarse = rng.random((rows, columns))
    y, x = np.arange(height) * rows / height, np.arange(width) * columns / width
    i, j = y.astype(int), x.astype(int)
    a, b = (y - i)[:, None], (x - j)[None, :]
    a, b = a * a * (3 - 2 * a), b * b * (3 - 2 * b)
    one, two = coarse[i % rows], coarse[(i + 1) % rows]
    rows_of = [(each[:, j % columns], each[:, (j + 1) % columns]) for each in (one, two)]
    top, low = (left * (1 - b) + right * b for left, right in rows_of)
    return (top * (1 - a) + low * a)[:, :, None]


def mixed(share: Floats, *colours: str) -> Floats:
    """Return a picture in which a share from 0 to 1 runs through colours."""
    stops = np.array([[int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in colours], dtype=float)
    at = np.clip(share, 0.0, 1.0) * (len(stops) - 1)
    k = np.minimum(at.astype(int), len(stops) - 2)
    rest = at - k
    return stops[k[..., 0]] * (1 - rest) + stops[k[..., 0] + 1] * rest


def ceramic(rng: np.random.Generator) -> Image.Image:
    """Return glazed stoneware: speckles, and bands near the upper end."""
    picture = mixed(noise(rng, 5, 5), "#f4f2ec", "#fffefa")
    for y, x in rng.integers(0, SIDE, (170, 2)):
        picture[y, x] *= 0.55
    return _image(picture)


def banded(rng: np.random.Generator) -> Image.Image:
    """Return stoneware with two painted bands, for round walls."""
    picture = np.asarray(ceramic(rng), dtype=float).copy()
    for low, high, shade in ((30, 42, 0.45), (46, 49, 0.45)):
        picture[low:high] *= shade
    return _image(picture)


def rings(rng: np.random.Generator) -> Image.Image:
    """Return stoneware with bands all over its profile, for plates."""
    picture = np.asarray(ceramic(rng), dtype=float).copy()
    for low, high in ((60, 64), (68, 70), (96, 102)):
        picture[low:high] *= (0.35, 0.5, 0.75)
    return _image(picture)


def steel(rng: np.random.Generator) -> Image.Image:
    """Return brushed steel."""
    return _image(mixed(0.8 * noise(rng, 128, 2) + 0.2 * noise(rng, 3, 3), "#b4bac0", "#d9dde1"))


def enamel(rng: np.random.Generator) -> Image.Image:
    """Return enamel with a dark rim."""
    picture = mixed(noise(rng, 4, 4), "#eceae4", "#ffffff")
    picture[:7] = (58, 62, 70)
    for y, x in rng.integers(0, SIDE, (60, 2)):
        picture[y, x] *= 0.7
    return _image(picture)


def wood(rng: np.random.Generator) -> Image.Image:
    """Return wood with its grain along x."""
    lines = noise(rng, 40, 2) * 0.55 + noise(rng, 12, 3) * 0.45
    return _image(mixed(lines, "#8a5a33", "#b98450", "#d9ab74"))


def planks(rng: np.random.Generator) -> Image.Image:
    """Return boards of wood with gaps."""
    picture = np.asarray(wood(rng), dtype=float).copy()
    for k in range(0, SIDE, 32):
        picture[k : k + 32] *= 0.86 + 0.22 * rng.random()
        picture[k : k + 2] *= 0.5
    return _image(picture)


def wicker(rng: np.random.Generator) -> Image.Image:
    """Return woven willow."""
    y, x = np.mgrid[0:SIDE, 0:SIDE]
    over = (x // 16 + y // 8) % 2 == 0
    along = np.abs(np.sin(np.pi * (y % 8 + 0.5) / 8))
    across = np.abs(np.sin(np.pi * (x % 16 + 0.5) / 16))
    share = np.where(over, along, 0.75 * across * along + 0.1)[:, :, None] * (0.75 + 0.25 * noise(rng, 16, 16))
    return _image(mixed(share, "#5d3f20", "#a77a42", "#dfb878"))


def glass(rng: np.random.Generator) -> Image.Image:
    """Return coloured glass with bright streaks."""
    picture = mixed(noise(rng, 2, 8), "#9fd3dd", "#c6eaf0")
    for k, wide in ((12, 5), (60, 3), (92, 8)):
        picture[:, k : k + wide] = (240, 252, 255)
    return _image(picture)


def bottle(rng: np.random.Generator) -> Image.Image:
    """Return a green bottle with a paper label around its lower half; the profile runs upwards."""
    picture = mixed(noise(rng, 2, 6), "#1f6b3a", "#2f8a4c")
    picture[:, 20:26] = (120, 200, 140)
    image = _image(picture)
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 58, SIDE, 104), fill="#f3ead2")
    draw.rectangle((0, 58, SIDE, 61), fill="#b8322a")
    draw.rectangle((0, 101, SIDE, 104), fill="#b8322a")
    for k in (4, 68):
        _text(draw, (k, 70), "OLIVE", 17, "#33541f")
    draw.rectangle((0, 0, SIDE, 9), fill="#c9a227")
    return image


def apple(rng: np.random.Generator) -> Image.Image:
    """Return the skin of an apple, from the bottom to the stalk."""
    streaks = noise(rng, 3, 40)
    height = np.linspace(1.0, 0.0, SIDE)[:, None, None]
    share = 0.5 * streaks + 0.65 * (1 - np.abs(2 * height - 0.9))
    picture = mixed(share, "#e3c64d", "#d8452f", "#b81d24")
    for y, x in rng.integers(0, SIDE, (120, 2)):
        picture[y, x] = (240, 205, 120)
    return _image(picture)


def banana(rng: np.random.Generator) -> Image.Image:
    """Return the skin of a banana with brown ends, along x."""
    picture = mixed(0.6 * noise(rng, 3, 12) + 0.4 * noise(rng, 24, 24), "#e8bd2c", "#f8dc55")
    x = np.arange(SIDE)
    ends = np.clip((np.abs(x - SIDE / 2) - 50) / 12, 0.0, 1.0)[None, :, None]
    picture = picture * (1 - ends) + np.array((92.0, 66.0, 30.0)) * ends
    for y, k in rng.integers(6, SIDE - 6, (26, 2)):
        picture[y : y + 2, k : k + 4] *= 0.55
    return _image(picture)


def sponge(rng: np.random.Generator) -> Image.Image:
    """Return a sponge with pores; its upper quarter is a green scouring pad."""
    picture = mixed(noise(rng, 20, 20), "#e3b62c", "#f7d65a")
    for y, x in rng.integers(0, SIDE - 4, (140, 2)):
        wide = int(rng.integers(2, 5))
        picture[y : y + wide, x : x + wide] *= 0.68
    picture[: SIDE // 4] = mixed(noise(rng, 32, 64)[: SIDE // 4], "#1d5c3a", "#3c8f5f")
    return _image(picture)


def soap(rng: np.random.Generator) -> Image.Image:
    """Return a bar of soap with its name pressed in."""
    image = _image(mixed(noise(rng, 4, 6), "#f2d7e2", "#fff3f8"))
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle((14, 34, 113, 93), 22, outline="#cf9fb4", width=3)
    _text(draw, (36, 46), "soap", 26, "#c48ba3")
    return image


def cereal(rng: np.random.Generator) -> Image.Image:
    """Return the sides of a box of cereal: the front on the left two thirds, a narrow side on the right."""
    image = Image.new("RGB", (192, 192), "#d9352b")
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 118, 127, 191), fill="#f4c430")
    draw.ellipse((18, 84, 108, 168), fill="#ffffff", outline="#1f4f8a", width=3)
    for angle in np.linspace(0, 2 * np.pi, 30):
        radius = 34 * rng.random() ** 0.5
        x, y = 63 + radius * np.cos(angle) * 1.1, 126 + radius * np.sin(angle)
        draw.ellipse((x - 6, y - 6, x + 6, y + 6), fill="#c98a3a", outline="#8c5a20")
    _text(draw, (8, 8), "CRUNCHY", 24, "#ffffff")
    _text(draw, (26, 38), "RINGS", 28, "#f4c430")
    draw.rectangle((128, 0, 191, 191), fill="#f6efe0")
    draw.rectangle((128, 0, 191, 30), fill="#d9352b")
    for row in range(10):
        draw.line((136, 46 + 13 * row, 158 + int(rng.integers(0, 26)), 46 + 13 * row), fill="#4a4a4a", width=3)
    return image


def carton(rng: np.random.Generator) -> Image.Image:
    """Return the side of a carton of milk."""
    image = Image.new("RGB", (SIDE, SIDE), "#f7fafc")
    draw = ImageDraw.Draw(image)
    draw.polygon([(0, 88), (40, 76), (86, 92), (127, 78), (127, 127), (0, 127)], fill="#2f7fc1")
    _text(draw, (22, 20), "milk", 40, "#2f7fc1")
    for x, y in ((20, 104), (60, 112), (98, 100)):
        draw.ellipse((x, y, x + 16, y + 10), fill="#f7fafc")
    return image


def book(rng: np.random.Generator) -> Image.Image:
    """Return the cover of a book on the left half, its spine next to it and its pages on the right."""
    image = Image.new("RGB", (SIDE, SIDE), "#ffffff")
    draw = ImageDraw.Draw(image)
    cover = _image(mixed(noise(rng, 40, 40), "#dcdcdc", "#f4f4f4"))
    image.paste(cover.crop((0, 0, 90, SIDE)), (0, 0))
    draw.rectangle((5, 5, 63, 122), outline="#6d6d6d", width=2)
    _text(draw, (12, 20), "LOGIC", 17, "#4a4a4a")
    _text(draw, (14, 42), "for", 12, "#4a4a4a")
    _text(draw, (12, 58), "robots", 15, "#4a4a4a")
    draw.ellipse((22, 86, 46, 110), fill="#8a8a8a")
    for y in (14, 20, 104, 110):
        draw.line((68, y, 90, y), fill="#5a5a5a", width=2)
    for x in range(92, SIDE, 2):
        draw.line((x, 0, x, SIDE), fill="#e9e2cf" if x % 4 else "#cfc6ae")
    draw.rectangle((91, 0, 91, SIDE), fill="#e9e2cf")
    return image


def _text(draw: ImageDraw.ImageDraw, at: tuple[int, int], text: str, size: int, colour: str) -> None:
    draw.text(at, text, fill=colour, font=ImageFont.load_default(size))


def _image(picture: Floats) -> Image.Image:
    return Image.fromarray(np.clip(picture, 0, 255).astype(np.uint8), "RGB")


TEXTURES: Mapping[str, Callable[[np.random.Generator], Image.Image]] = {
    each.__name__: each
    for each in (
        ceramic,
        banded,
        rings,
        steel,
        enamel,
        wood,
        planks,
        wicker,
        glass,
        bottle,
        apple,
        banana,
        sponge,
        soap,
        cereal,
        carton,
        book,
    )
}
