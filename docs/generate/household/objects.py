"""The objects of the domain: convex parts and visible surfaces, in millimetres; each stands on z = 0."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import chain, product
from typing import NamedTuple

import numpy as np
from parts import Floats, box, hull, lathe, rod, wall
from surfaces import Patch, Region, block, tube, turned


class Model(NamedTuple):
    """Convex parts, each as triangles (n, 3, 3), and visible surfaces."""

    parts: list[Floats]
    looks: list[Patch]


def mug() -> Model:
    """Return a mug of 80 mm with a handle."""
    loop = [
        (37.0, 0.0, 74.0),
        (52.0, 0.0, 76.0),
        (65.0, 0.0, 66.0),
        (66.0, 0.0, 44.0),
        (56.0, 0.0, 27.0),
        (36.0, 0.0, 22.0),
    ]
    parts = [lathe([(0, 37), (6, 38)], 16), *wall([(6, 35.5, 40), (92, 35.5, 40)], 16)]
    parts += rod(loop, [12.0] * 6, [8.0] * 6)
    outside = [(0.0, 1.0), (34.0, 1.0), (36.0, 0.0), (39.0, 4.0), (40.0, 12.0), (40.0, 89.0), (39.0, 92.0)]
    inside = [(39.0, 92.0), (37.0, 92.0), (35.5, 89.0), (35.5, 12.0), (33.0, 7.0), (0.0, 6.0)]
    handle = tube("ceramic", loop, [(6.5, 4.5)] * 6, (0.0, 1.0, 0.0), closed=False)
    return Model(parts, [turned("banded", outside, 36), turned("ceramic", inside, 36), handle])


def bowl() -> Model:
    """Return a bowl of 150 mm with a broad floor and a steep wall."""
    rings = [(6.0, 58.0, 64.0), (20.0, 67.0, 71.5), (58.0, 70.5, 75.0)]
    outside = [(0.0, 2.0), (46.0, 2.0), (48.0, 0.0), (52.0, 0.0), (54.0, 4.0), (63.0, 7.0), (69.0, 14.0), (72.0, 24.0)]
    outside += [(75.0, 56.0), (74.0, 58.0)]
    inside = [(74.0, 58.0), (71.5, 58.0), (70.5, 56.0), (67.5, 24.0), (65.0, 15.0), (58.0, 7.0), (0.0, 6.0)]
    parts = [lathe([(0.0, 50.0), (3.0, 56.0), (6.0, 64.0)], 16), *wall(rings, 16)]
    return Model(parts, [turned("banded", outside, 40), turned("ceramic", inside, 40)])


def plate() -> Model:
    """Return a plate of 164 mm with an upright rim of even thickness, such as those that can be stacked."""
    parts = [lathe([(0.0, 70.0), (5.0, 77.0)], 20), *wall([(5.0, 74.5, 79.0), (26.0, 77.5, 82.0)], 20)]
    outside = [(0.0, 1.0), (66.0, 1.0), (69.0, 0.0), (77.0, 4.0), (80.0, 12.0), (82.0, 25.0), (81.0, 26.0)]
    inside = [(81.0, 26.0), (79.0, 26.0), (78.0, 25.0), (76.0, 11.0), (71.0, 6.0), (0.0, 5.0)]
    return Model(parts, [turned("ceramic", outside, 44), turned("rings", inside, 44)])


def glass() -> Model:
    """Return a tumbler of 66 mm."""
    parts = [lathe([(0.0, 27.0), (8.0, 28.0)], 12), *wall([(8.0, 25.0, 28.0), (105.0, 29.5, 33.0)], 12)]
    outside = [(0.0, 0.0), (26.0, 0.0), (27.5, 2.0), (33.0, 104.0), (32.0, 105.0)]
    inside = [(32.0, 105.0), (30.5, 105.0), (29.5, 104.0), (25.0, 10.0), (0.0, 8.0)]
    return Model(parts, [turned("glass", outside, 32), turned("glass", inside, 32)])


def bottle() -> Model:
    """Return a bottle of 62 mm with a neck of 28 mm."""
    sides = 16
    parts = [
        lathe([(0.0, 29.0), (3.0, 31.0), (118.0, 31.0)], sides),
        lathe([(118.0, 31.0), (140.0, 19.0), (152.0, 13.5)], sides),
        lathe([(152.0, 13.5), (190.0, 13.5)], sides),
    ]
    outside = [
        (0.0, 0.0),
        (28.0, 0.0),
        (31.0, 4.0),
        (31.0, 118.0),
        (28.0, 128.0),
        (19.0, 140.0),
        (13.5, 152.0),
        (13.5, 174.0),
    ]
    outside += [(15.0, 174.0), (15.0, 188.0), (14.0, 190.0), (0.0, 190.0)]
    return Model(parts, [turned("bottle", outside, 32)])


def pot() -> Model:
    """Return a pot of 108 mm with two handles."""
    ear = [(0.0, -22.0), (13.0, -20.0), (20.0, -11.0), (20.0, 11.0), (13.0, 20.0), (0.0, 22.0)]
    parts = [lathe([(0.0, 50.0), (4.0, 52.0)], 16), *wall([(4.0, 50.5, 54.0), (66.0, 50.5, 54.0)], 16)]
    outside = [(0.0, 0.0), (50.0, 0.0), (53.5, 4.0), (54.0, 10.0), (54.0, 63.0), (56.0, 64.0), (55.5, 66.0)]
    inside = [(55.5, 66.0), (51.5, 66.0), (50.5, 64.0), (50.5, 8.0), (46.0, 4.0), (0.0, 4.0)]
    looks = [turned("enamel", outside, 40), turned("steel", inside, 40)]
    ends = ((52.0, 74.0, -24.0, -17.0), (52.0, 74.0, 17.0, 24.0), (68.0, 76.0, -17.0, 17.0))
    for sign in (1.0, -1.0):
        path = [(sign * (52.0 + x), y, 50.0) for x, y in ear]
        looks.append(tube("dark", path, [(4.0, 4.0)] * 6, (0.0, 0.0, 1.0), closed=False))
        for near, far, left, right in ends:
            parts.append(hull(product((sign * near, sign * far), (left, right), (46.0, 54.0))))
    return Model(parts, looks)


def lid() -> Model:
    """Return the lid of the pot, with a knob."""
    parts = [lathe([(0.0, 56.0), (4.0, 56.0), (10.0, 26.0)], 20), lathe([(10.0, 12.0), (32.0, 15.0)], 12)]
    dome = [(0.0, 0.0), (54.0, 0.0), (57.0, 2.0), (56.0, 4.5), (45.0, 7.5), (26.0, 10.0), (0.0, 11.0)]
    knob = [(7.0, 10.0), (7.0, 16.0), (15.0, 22.0), (16.0, 28.0), (13.0, 32.0), (0.0, 33.0)]
    return Model(parts, [turned("enamel", dome, 40), turned("dark", knob, 24)])


def pan() -> Model:
    """Return a small frying pan of 124 mm with a handle."""
    handle = [(57.0, 0.0, 30.0), (78.0, 0.0, 36.0), (132.0, 0.0, 41.0), (155.0, 0.0, 41.0)]
    parts = [lathe([(0.0, 53.0), (4.0, 55.0)], 16), *wall([(4.0, 52.0, 56.0), (36.0, 58.5, 62.0)], 16)]
    parts += rod(handle, [16.0, 16.0, 22.0, 18.0], [8.0, 9.0, 14.0, 12.0])
    looks = [
        turned("coated", [(0.0, 0.0), (53.0, 0.0), (56.0, 4.0), (61.5, 34.0), (61.0, 36.0)], 40),
        turned("steel", [(61.0, 36.0), (59.5, 36.0), (58.5, 34.0), (53.0, 6.0), (50.0, 4.0), (0.0, 4.0)], 40),
        tube("steel", handle[:2], [(8.0, 4.0), (8.0, 4.5)], (0.0, 1.0, 0.0)),
        tube("wood", handle[1:], [(8.0, 5.5), (11.0, 7.0), (9.0, 6.0)], (0.0, 1.0, 0.0)),
    ]
    return Model(parts, looks)


def spoon() -> Model:
    """Return a wooden spoon of 190 mm."""
    path = [(-30.0, 0.0, 6.0), (15.0, 0.0, 7.5), (85.0, 0.0, 5.5), (107.0, 0.0, 4.5)]
    share = np.linspace(0.0, math.pi, 9)
    middle = [(-50.0 - 33.0 * math.cos(a), 0.0, 6.0) for a in share]
    radii = [(max(23.0 * math.sin(a), 0.5), max(6.0 * math.sin(a), 0.5)) for a in share]
    blade = tube("wood", middle, radii, (0.0, 1.0, 0.0), 14, closed=False)
    oval = [(-50.0 - 33.0 * math.cos(a), y * 23.0 * math.sin(a), z) for a in share for y in (-1, 1) for z in (2.5, 9.5)]
    flat = [
        (-50.0 - 26.0 * math.cos(a), y * 16.0 * math.sin(a), z) for a in share for y in (-1, 1) for z in (0.0, 12.0)
    ]
    parts = [hull([*oval, *flat]), *rod(path, [10.0, 10.0, 13.0, 9.0], [9.0, 10.0, 11.0, 9.0])]
    handle = tube("wood", path, [(5.0, 4.5), (5.0, 5.0), (6.5, 5.5), (4.5, 4.5)], (0.0, 1.0, 0.0), 12)
    return Model(parts, [blade, handle])


def knife() -> Model:
    """Return a table knife of 190 mm with a wooden handle."""
    handle = [(-85.0, 0.0, 6.0), (-50.0, 0.0, 7.0), (0.0, 0.0, 6.5)]
    outline = [(0.0, -9.0), (70.0, -10.0), (92.0, -6.0), (105.0, 6.0), (104.0, 9.0), (0.0, 9.0)]
    blade = [(x, y, z) for x, y in outline for z in (4.0, 7.5)]
    parts = [*rod(handle, [16.0, 20.0, 17.0], [12.0, 14.0, 12.0]), hull(blade)]
    looks = [
        tube("wood", handle, [(8.0, 6.0), (10.0, 7.0), (8.5, 6.0)], (0.0, 1.0, 0.0), 14),
        _sheet("steel", outline, 4.0, 7.5),
    ]
    return Model(parts, looks)


def book() -> Model:
    """Return a book that stands upright, its spine to the front; it is 34 mm thick."""
    x, y, z = 52.0, 17.0, 148.0
    cover: Region = (0.0, 0.0, 0.53, 1.0)
    spine: Region = (0.54, 0.0, 0.7, 1.0)
    pages: Region = (0.73, 0.0, 1.0, 1.0)
    regions = {"front": spine, "left": cover, "right": cover, "top": pages, "bottom": pages, "back": pages}
    return Model([box((-x, -y, 0.0), (x, y, z))], [block("book", (-x, -y, 0.0), (x, y, z), regions)])


def cereal() -> Model:
    """Return a box of cereal that is 52 mm thick."""
    x, y, z = 26.0, 52.0, 150.0
    front: Region = (0.0, 0.0, 0.66, 1.0)
    side: Region = (0.67, 0.0, 1.0, 1.0)
    red: Region = (0.01, 0.9, 0.03, 0.98)
    regions = {"front": front, "back": front, "left": side, "right": side, "top": red, "bottom": red}
    return Model([box((-x, -y, 0.0), (x, y, z))], [block("cereal", (-x, -y, 0.0), (x, y, z), regions)])


def carton() -> Model:
    """Return a carton of milk of 62 mm with a gable."""
    a, low, high = 31.0, 108.0, 134.0
    gable = [(x, y, low) for x in (-a, a) for y in (-a, a)] + [(x, y, high) for x in (-a, a) for y in (-2.0, 2.0)]
    fin = box((-a, -2.0, high), (a, 2.0, 148.0))
    white: Region = (0.01, 0.93, 0.06, 0.99)
    looks = [block("carton", (-a, -a, 0.0), (a, a, low), {"top": white, "bottom": white})]
    looks.append(
        block(
            "carton",
            (-a, -2.0, high - 2.0),
            (a, 2.0, 148.0),
            dict.fromkeys(("front", "back", "left", "right", "top", "bottom"), white),
        )
    )
    roof = []
    for sign in (1.0, -1.0):
        roof.append(
            [
                (sign * a, sign * a, low),
                (-sign * a, sign * a, low),
                (-sign * a, sign * 2.0, high),
                (sign * a, sign * 2.0, high),
            ]
        )
        roof.append(
            [
                (sign * a, -sign * a, low),
                (sign * a, sign * a, low),
                (sign * a, sign * 2.0, high),
                (sign * a, -sign * 2.0, high),
            ]
        )
    looks.append(_flat("carton", roof, (0.01, 0.75, 0.15, 0.99)))
    return Model([box((-a, -a, 0.0), (a, a, low)), hull(gable), fin], looks)


def soap() -> Model:
    """Return a bar of soap, rounded, 80 mm long."""
    ends = [(-40.0, 0.55), (-37.0, 0.85), (-30.0, 1.0), (30.0, 1.0), (37.0, 0.85), (40.0, 0.55)]
    look = tube("soap", [(x, 0.0, 13.0) for x, _ in ends], [(27.0 * s, 13.5 * s) for _, s in ends], (0.0, 1.0, 0.0), 20)
    flat = [(x, y, z) for x in (-33.0, 33.0) for y in (-16.0, 16.0) for z in (0.0, 26.0)]
    belt = [
        (x, y, z)
        for x, y in ((-40.0, 14.0), (-32.0, 26.0), (32.0, 26.0), (40.0, 14.0))
        for y in (-y, y)
        for z in (8.0, 18.0)
    ]
    top = [(a, b, 26.1) for a, b in ((-33.0, -16.0), (33.0, -16.0), (33.0, 16.0), (-33.0, 16.0))]
    name = Patch(
        "soap",
        np.array([top]),
        np.array([[(0.1, 0.2), (0.9, 0.2), (0.9, 0.8), (0.1, 0.8)]]),
        np.tile((0.0, 0.0, 1.0), (1, 4, 1)),
    )
    return Model([hull([*flat, *belt])], [look, name])


def sponge() -> Model:
    """Return a sponge of 96 x 62 x 34 mm with a scouring pad on top."""
    low, high = (-48.0, -31.0, 0.0), (48.0, 31.0, 34.0)
    pad: Region = (0.02, 0.8, 0.98, 0.98)
    foam: Region = (0.02, 0.02, 0.98, 0.7)
    return Model([box(low, high)], [block("sponge", low, high, {"top": pad, "bottom": foam})])


def banana() -> Model:
    """Return a banana that lies on its side, 167 mm long."""
    turns = np.radians(np.linspace(-145.0, -35.0, 9))
    thick = [4.5, 9.0, 14.0, 16.0, 16.5, 16.0, 14.0, 9.0, 4.5]
    path = [(98.0 * math.cos(t), 98.0 * math.sin(t) + 97.0, r) for t, r in zip(turns, thick, strict=True)]
    look = tube("banana", path, [(r, r) for r in thick], (0.0, 0.0, 1.0), 12)
    sections = []
    for turn, radius, (x, y, z) in zip(turns, thick, path, strict=True):
        around = [2 * math.pi * (k + 0.5) / 8 for k in range(8)]
        wide = radius / math.cos(math.pi / 8)
        sections.append(
            [
                (
                    x + wide * math.cos(a) * math.cos(turn),
                    y + wide * math.cos(a) * math.sin(turn),
                    z + wide * math.sin(a),
                )
                for a in around
            ]
        )
    return Model([hull(chain(*sections[k - 1 : k + 2])) for k in range(1, 8, 2)], [look])


def apple() -> Model:
    """Return an apple of 68 mm; it stands on a flat bottom."""
    profile = [(0.0, 5.0), (9.0, 1.0), (16.0, 0.0), (25.0, 5.0), (31.5, 17.0), (34.0, 32.0), (33.0, 44.0), (28.0, 55.0)]
    profile += [(20.0, 61.0), (11.0, 62.0), (4.0, 57.0), (0.0, 53.0)]
    solid = [(0.0, 17.0), (5.0, 25.0), (17.0, 31.5), (32.0, 34.0), (44.0, 33.0), (55.0, 28.0), (62.0, 17.0)]
    stalk = tube(
        "stalk",
        [(0.0, 0.0, 52.0), (1.5, 0.0, 62.0), (4.0, 0.0, 71.0)],
        [(1.6, 1.6), (1.4, 1.4), (2.0, 2.0)],
        (0.0, 1.0, 0.0),
        6,
    )
    return Model([lathe(solid, 20)], [turned("apple", profile, 32), stalk])


def basket() -> Model:
    """Return a basket of 270 x 210 mm."""
    return _tray("wicker", (135.0, 105.0, 46.0), 8.0, 6.0, 10.0, repeat=True)


def tray() -> Model:
    """Return a wooden tray of 300 x 220 mm."""
    return _tray("planks", (150.0, 110.0, 32.0), 8.0, 7.0, 3.0)


def sink() -> Model:
    """Return a kitchen sink of steel, 380 x 300 mm, with a drain and a tap behind it."""
    basin = _tray("steel", (190.0, 150.0, 48.0), 10.0, 8.0, 6.0)
    post = [(0.0, 167.0, 40.0), (0.0, 167.0, 80.0), (0.0, 162.0, 98.0), (0.0, 150.0, 106.0), (0.0, 134.0, 100.0)]
    drain = turned("dark", [(20.0, 0.0), (19.0, 1.0), (0.0, 1.0)], 20).moved(z=8.0)
    tap = [turned("steel", [(0.0, 0.0), (18.0, 0.0), (18.0, 52.0), (10.0, 58.0), (0.0, 58.0)], 20).moved(y=167.0)]
    tap.append(tube("steel", post, [(8.0, 8.0)] * 5, (1.0, 0.0, 0.0), 12))
    solid = [np.add(lathe([(0.0, 18.0), (56.0, 18.0)], 8), (0.0, 167.0, 0.0))]
    solid += rod(post, [16.0] * 5, [16.0] * 5)
    return Model([*basin.parts, *solid], [*basin.looks, drain, *tap])


def rack() -> Model:
    """Return a drying rack of 310 x 230 mm: wires on a frame, 60 mm high."""
    x, y, z = 155.0, 115.0, 60.0
    looks, parts = [], []
    for k in range(12):
        at = -x + 8.0 + k * (2 * x - 16.0) / 11
        looks.append(tube("chrome", [(at, -y, z - 3.0), (at, y, z - 3.0)], [(3.0, 3.0)] * 2, (1.0, 0.0, 0.0), 8))
        parts.append(box((at - 2.5, -y, z - 6.0), (at + 2.5, y, z)))
    for sign in (1.0, -1.0):
        at = sign * (y - 4.0)
        looks.append(tube("chrome", [(-x, at, z - 9.0), (x, at, z - 9.0)], [(3.5, 3.5)] * 2, (0.0, 1.0, 0.0), 8))
        parts.append(box((-x, at - 3.0, z - 12.0), (x, at + 3.0, z - 6.0)))
        for other in (1.0, -1.0):
            foot = (other * (x - 12.0), at)
            looks.append(tube("chrome", [(*foot, 4.0), (*foot, z - 8.0)], [(4.0, 4.0)] * 2, (1.0, 0.0, 0.0), 8))
            looks.append(turned("dark", [(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (0.0, 8.0)], 12).moved(*foot))
            parts.append(box((foot[0] - 6.0, foot[1] - 6.0, 0.0), (foot[0] + 6.0, foot[1] + 6.0, z - 8.0)))
    return Model(parts, looks)


def shelf() -> Model:
    """Return a low shelf of 320 x 180 mm: a board on two sides, 110 mm high."""
    x, y, z = 160.0, 90.0, 110.0
    boards = [
        ((-x, -y, z - 16.0), (x, y, z)),
        ((-x, -y, 0.0), (16.0 - x, y, z - 16.0)),
        ((x - 16.0, -y, 0.0), (x, y, z - 16.0)),
    ]
    boards.append(((16.0 - x, y - 12.0, 0.0), (x - 16.0, y, z - 16.0)))
    grain: Mapping[str, Region] = {"front": (0.0, 0.0, 0.6, 1.0)}
    return Model([box(*each) for each in boards], [block("wood", *each, grain) for each in boards])


def hammer() -> Model:
    """Return a hammer that lies on its side, 197 mm long."""
    handle = [(-105.0, 0.0, 12.5), (-75.0, 0.0, 12.5), (-10.0, 0.0, 12.5), (75.0, 0.0, 12.5)]
    parts = rod(handle, [26.0, 28.0, 20.0, 18.0], [22.0, 23.0, 18.0, 16.0])
    claw = [(62.0, y, z) for y in (-14.0, -55.0) for z in (4.0, 21.0)] + [
        (90.0, y, z) for y in (-14.0, -50.0) for z in (4.0, 21.0)
    ]
    parts += [
        box((62.0, -16.0, 0.0), (92.0, 16.0, 25.0)),
        hull(
            [
                (76.0 + 13.0 * math.cos(t), y, 12.5 + 12.5 * math.sin(t))
                for t in np.radians(range(0, 360, 30))
                for y in (16.0, 48.0)
            ]
        ),
        hull(claw),
    ]
    looks = [
        tube("wood", handle, [(13.0, 11.0), (14.0, 11.5), (10.0, 9.0), (9.0, 8.0)], (0.0, 1.0, 0.0), 14),
        tube(
            "steel",
            [(76.0, 14.0, 12.5), (76.0, 44.0, 12.5), (76.0, 48.0, 12.5)],
            [(13.0, 12.5), (13.0, 12.5), (12.0, 11.5)],
            (1.0, 0.0, 0.0),
            20,
        ),
        block("steel", (62.0, -16.0, 0.0), (92.0, 16.0, 25.0)),
        _hexahedron("steel", [(62.0, -55.0), (90.0, -50.0), (90.0, -14.0), (62.0, -14.0)], 4.0, 21.0),
    ]
    return Model(parts, looks)


def _tray(
    material: str, half: tuple[float, float, float], thick: float, floor: float, lean: float, repeat: bool = False
) -> Model:
    """Return an open box with four walls that lean outwards by a distance."""
    x, y, z = half

    def level(inset: float, height: float) -> list[tuple[float, float, float]]:
        return [(a * (x - inset), b * (y - inset), height) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]

    foot = lean * (1.0 - floor / z)
    bottom, rim, well, mouth = level(lean, 0.0), level(0.0, z), level(foot + thick, floor), level(thick, z)
    below = level(lean + thick, 0.0)
    # The floor reaches into the walls: a gap between both would be the lowest point.
    parts = [hull([*level(lean + thick / 2, 0.0), *level(foot + thick / 2, floor)])]
    quads = [below[::-1], well]
    for k in range(4):
        j = (k + 1) % 4
        parts.append(hull([bottom[k], bottom[j], rim[k], rim[j], below[k], below[j], mouth[k], mouth[j]]))
        quads += [
            [bottom[k], bottom[j], rim[j], rim[k]],
            [well[j], well[k], mouth[k], mouth[j]],
            [rim[k], rim[j], mouth[j], mouth[k]],
        ]
    cell = 110.0 if repeat else 0.0
    return Model(parts, [_tiled(material, quads, cell)])


def _tiled(material: str, quads: list[list[tuple[float, float, float]]], cell: float) -> Patch:
    """Return quadrangles; with a `cell` in mm the texture is repeated every so many, otherwise each has all of it."""
    places = []
    for a, b, c, d in np.array(quads, float):
        wide = max(np.linalg.norm(b - a), np.linalg.norm(c - d)) / cell if cell else 1.0
        tall = max(np.linalg.norm(d - a), np.linalg.norm(c - b)) / cell if cell else 1.0
        places.append([(0.0, 0.0), (wide, 0.0), (wide, tall), (0.0, tall)])
    corners = np.array(quads, float)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Patch(material, corners, np.array(places), np.repeat(normals[:, None], 4, 1))


def _flat(material: str, quads: list[list[tuple[float, float, float]]], region: Region) -> Patch:
    """Return flat quadrangles, each with the same region of the texture."""
    left, low, right, high = region
    patch = _tiled(material, quads, 0.0)
    return patch._replace(places=np.tile([(left, low), (right, low), (right, high), (left, high)], (len(quads), 1, 1)))


def _hexahedron(material: str, outline: list[tuple[float, float]], low: float, high: float) -> Patch:
    """Return an upright prism over a quadrangle, whose corners are counter-clockwise from above."""
    quads = [
        [(*outline[k], low), (*outline[(k + 1) % 4], low), (*outline[(k + 1) % 4], high), (*outline[k], high)]
        for k in range(4)
    ]
    quads += [[(*point, high) for point in outline], [(*point, low) for point in outline[::-1]]]
    return _flat(material, quads, (0.0, 0.0, 1.0, 1.0))


def _sheet(material: str, outline: list[tuple[float, float]], low: float, high: float) -> Patch:
    """Return an upright prism over a convex outline, counter-clockwise from above, of six corners."""
    one = [outline[0], outline[1], outline[4], outline[5]]
    two = [outline[1], outline[2], outline[3], outline[4]]
    patches = [_hexahedron(material, each, low, high) for each in (one, two)]
    return Patch(material, *(np.concatenate([patch[k] for patch in patches]) for k in (1, 2, 3)))


MODELS: Mapping[str, Callable[[], Model]] = {
    each.__name__: each
    for each in (
        mug,
        bowl,
        plate,
        glass,
        bottle,
        pot,
        lid,
        pan,
        spoon,
        knife,
        book,
        cereal,
        carton,
        soap,
        sponge,
        banana,
        apple,
        basket,
        tray,
        rack,
        hammer,
        sink,
        shelf,
    )
}
