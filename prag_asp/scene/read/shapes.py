"""Read ``[scene.shapes]``: what the bodies of a class look like."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from prag_asp.errors import SceneError
from prag_asp.scene.read.report import MAX_LENGTH, SMALLEST, Report, is_number
from prag_asp.scene.scene import Shape, Size
from prag_asp.scene.shape_kinds import KINDS
from prag_asp.wording import did_you_mean, nearest

TRIPLE = 3
SIZES = 8
"""How many sizes a range has: bodies are made once for each, for making and removing them leaks memory."""

LEAST = (0.12, 0.12, 0.06)
"""The smallest sides of furniture in metres: less holds nothing, or leaves no room for a handle."""

NOTHING = (0.0, 0.0, 0.0)
STAND_IN = (0.3, 0.3, 0.3)
"""Takes the place of sides that are wrong, so that nothing else is said of them."""


def read_shapes(report: Report, table: Mapping[str, Any]) -> dict[str, tuple[Shape, ...]]:
    """Return the shapes that every entity can have, the smallest first: those of its class or nearest ancestor."""
    by_class: dict[str, tuple[Shape, ...]] = {}
    for name, value in table.items():
        if report.known_class(f"scene.shapes.{name}", name):
            by_class[name] = _shapes(report, f"scene.shapes.{name}", value)
        else:
            meant = nearest(name, report.classes)
            by_class |= {} if meant is None or meant in table else {meant: ()}
    found = {}
    for entity in report.entities:
        shapes = next((by_class[name] for name in report.line(entity) if name in by_class), None)
        if shapes:
            found[entity] = shapes
        elif shapes is not None:
            report.doubtful.add(entity)
    return found


def _shapes(report: Report, key: str, value: object) -> tuple[Shape, ...]:
    """Return the shapes that a table of ``scene.shapes`` describes: `SIZES` where it gives a range, otherwise one."""
    if not isinstance(value, Mapping):
        report.add(key, f'needs a table like {{ kind = "box", size = [0.05, 0.05, 0.05] }}; got {value!r}')
        return ()
    kind = value.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        report.add(f"{key}.kind", f"unknown shape {kind!r}; {did_you_mean(str(kind), KINDS)}")
        return ()
    before, traits = len(report.problems), KINDS[kind]
    report.unknown(key, value, ("kind", *traits.keys))
    if kind == "urdf":
        return _urdf(report, f"{key}.path", value.get("path"))
    low, high = _sizes(report, key, kind, value)
    small = traits.furniture and not all(side >= least for side, least in zip(low, LEAST, strict=True))
    if small or (traits.furniture and low != high):
        text = f"needs one size of at least {' x '.join(f'{side:g}' for side in LEAST)} m for a {kind}"
        report.add(f"{key}.size", f"{text}; got {value.get('size')!r}")
    wall = _wall(report, key, value, low) if traits.hollow and not small else 0.0
    if len(report.problems) > before:
        return ()
    return tuple(Shape(kind, size, wall) for size in _between(low, high))


def _urdf(report: Report, key: str, path: object) -> tuple[Shape, ...]:
    """Return the shape of a URDF, given by its path from the folder of the domain."""
    from prag_asp.scene.read.urdf import read_urdf  # noqa: PLC0415 - few domains need to read XML

    if not isinstance(path, str) or not path:
        report.add(key, f'needs the path of a URDF in the folder of the domain, like "models/mug.urdf"; got {path!r}')
        return ()
    try:
        shape = read_urdf(report.folder / path, report.folder)
    except SceneError as error:
        report.add(key, str(error))
        return ()
    if max(shape.size) > MAX_LENGTH:
        report.add(key, f"is {max(shape.size):g} m long; give its lengths in metres (at most {MAX_LENGTH:g})")
        return ()
    return (shape,)


def _between(low: Size, high: Size) -> list[Size]:
    """Return the sizes from the smallest to the largest; all sides grow together."""
    if low == high:
        return [low]
    (ax, ay, az), (bx, by, bz) = low, high
    shares = [k / (SIZES - 1) for k in range(SIZES)]
    return [(ax + t * (bx - ax), ay + t * (by - ay), az + t * (bz - az)) for t in shares]


def _sizes(report: Report, key: str, kind: str, value: Mapping[str, Any]) -> tuple[Size, Size]:
    """Return the sides of the smallest and of the largest bounding box of a shape in metres."""
    names = KINDS[kind].keys
    if kind == "zone":
        sides = report.lengths(f"{key}.size", value.get("size"), 2) or NOTHING
        return (sides[0], sides[1], 0.0), (sides[0], sides[1], 0.0)
    if "size" in names:
        return _box(report, f"{key}.size", value.get("size"))
    radius = _length(report, f"{key}.radius", value.get("radius"), SMALLEST / 2) if "radius" in names else (0.0, 0.0)
    diameter = (2 * radius[0], 2 * radius[1])
    height = _length(report, f"{key}.height", value.get("height"), SMALLEST) if "height" in names else diameter
    return (diameter[0], diameter[0], height[0]), (diameter[1], diameter[1], height[1])


def _box(report: Report, key: str, value: object) -> tuple[Size, Size]:
    """Return the smallest and the largest sides of a box: a list of three, or a table of two such lists."""
    ends = [value]
    if isinstance(value, Mapping):
        report.unknown(key, value, ("low", "high"))
        for name in sorted({"low", "high"} - value.keys()):
            report.add(f"{key}.{name}", "missing: a range of sizes has low and high, three lengths in metres each")
        ends = [value[name] for name in ("low", "high") if name in value] or [list(STAND_IN)]
    found = [report.lengths(key, end, TRIPLE) for end in ends]
    (ax, ay, az), (bx, by, bz) = found[0] or found[-1] or STAND_IN, found[-1] or found[0] or STAND_IN
    if None not in found and (ax > bx or ay > by or az > bz):
        report.add(key, f"needs no side of low greater than that of high; got {value!r}")
    return (ax, ay, az), (bx, by, bz)


def _length(report: Report, key: str, value: object, least: float) -> tuple[float, float]:
    """Return the smallest and the largest of a length: a number, or a list of two."""
    count = 2 if isinstance(value, list) and len(value) == 2 else 1
    found = report.lengths(key, value if count == 2 else [value], count, least) or (0.0,)
    if found[0] > found[-1]:
        report.add(key, f"needs the smaller length first; got {value!r}")
    return found[0], found[-1]


def _wall(report: Report, key: str, value: Mapping[str, Any], size: Size) -> float:
    """Return the thickness of a container's walls and floor in metres; 6 mm where it is missing."""
    wall = value.get("wall", 0.006)
    if is_number(wall) and wall >= SMALLEST and all(2 * wall < side for side in size):
        return float(wall)
    report.add(
        f"{key}.wall",
        f"needs a thickness in metres of at least {SMALLEST} that leaves a cavity in size; got {wall!r}",
    )
    return SMALLEST
