"""Read ``[scene.shapes]``: the shapes of the bodies of a class."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from prag_asp.errors import SceneError
from prag_asp.scene.read.scene_values import MAX_LENGTH, SMALLEST, DomainNames, lengths
from prag_asp.scene.scene import Shape, Size
from prag_asp.scene.shape_kinds import KINDS
from prag_asp.tables.report import TableEntry, is_number, shown
from prag_asp.wording import did_you_mean, nearest

SIZES = 8
"""The number of sizes in a range; each size has its own body, because creating and removing bodies leaks memory."""

LEAST = (0.12, 0.12, 0.06)
"""The smallest dimensions of furniture in metres; smaller furniture holds nothing or has no room for a handle."""

WALL = 0.006
"""The default thickness of a container's walls and floor, in metres."""

STAND_IN = (0.3, 0.3, 0.3)
"""The dimensions, in metres, that replace invalid ones, so that they cause no further reports."""


def read_shapes(section: TableEntry, names: DomainNames) -> dict[str, tuple[Shape, ...]]:
    """Return the possible shapes of each entity, smallest first: those of its class or its nearest ancestor."""
    by_class: dict[str, tuple[Shape, ...]] = {}
    for name, entry in section.entries():
        if names.has_class(entry, name):
            by_class[name] = _shapes(entry, names.folder)
        else:
            meant = nearest(name, names.known_classes)
            by_class |= {} if meant is None or meant in section.value else {meant: ()}
    shapes_by_entity = {}
    for entity in names.entities:
        shapes = names.inherited(entity, by_class)
        if shapes:
            shapes_by_entity[entity] = shapes
        elif shapes is not None:
            section.report.doubtful.add(entity)
    return shapes_by_entity


def _shapes(entry: TableEntry, folder: Path) -> tuple[Shape, ...]:
    """Return the shapes of one class: `SIZES` shapes if the table gives a range, and otherwise a single shape."""
    if not entry.is_table('like { kind = "box", size = [0.05, 0.05, 0.05] }'):
        return ()
    kind = entry.value.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        entry.at("kind").add(f"unknown shape {shown(kind)}; {did_you_mean(str(kind), KINDS)}")
        return ()
    traits = KINDS[kind]
    entry.require_known(("kind", *traits.keys))
    if "path" in traits.keys:
        return _from_file(entry, folder)
    low, high = _sizes(entry, kind)
    small = traits.furniture and not all(side >= least for side, least in zip(low, LEAST, strict=True))
    if small or (traits.furniture and low != high):
        entry.at("size").needs(f"one size of at least {' x '.join(f'{side:g}' for side in LEAST)} m for a {kind}")
    wall = 0.0
    if traits.hollow and not small:
        thickness = entry.at("wall", WALL)
        wall = thickness.value
        if not is_number(wall) or wall < SMALLEST or any(2 * wall >= side for side in low):
            thickness.needs(f"a thickness in metres of at least {SMALLEST} that leaves a cavity in size")
    if not entry.is_sound:
        return ()
    if low == high:
        return (Shape(kind, low, wall),)
    (ax, ay, az), (bx, by, bz) = low, high
    shares = [k / (SIZES - 1) for k in range(SIZES)]
    return tuple(Shape(kind, (ax + t * (bx - ax), ay + t * (by - ay), az + t * (bz - az)), wall) for t in shares)


def _from_file(entry: TableEntry, folder: Path) -> tuple[Shape, ...]:
    """Return the shape that a URDF or a mesh describes, given by its path from the folder of the domain."""
    from prag_asp.scene.read.mesh_body import read_mesh_body  # noqa: PLC0415 - few domains have bodies from files
    from prag_asp.scene.read.urdf import read_urdf  # noqa: PLC0415

    path, kind = entry.at("path"), entry.value["kind"]
    if not isinstance(path.value, str) or not path.value:
        what, example = ("URDF", "mug.urdf") if kind == "urdf" else ("mesh", "mug.obj")
        path.needs(f'the path of a {what} in the folder of the domain, like "models/{example}"')
        return ()
    try:
        shape = read_urdf(folder / path.value, folder) if kind == "urdf" else read_mesh_body(entry, folder)
    except SceneError as error:
        path.add(str(error))
        return ()
    if shape is None:
        return ()
    if max(shape.size) > MAX_LENGTH:
        remedy = f"give its lengths in metres (at most {MAX_LENGTH:g}), or give a mesh a smaller scale"
        path.add(f"is {max(shape.size):g} m long; {remedy}")
        return ()
    return (shape,)


def _sizes(entry: TableEntry, kind: str) -> tuple[Size, Size]:
    """Return the dimensions, in metres, of the smallest and the largest bounding box of a shape."""
    keys = KINDS[kind].keys
    if kind == "zone":
        sides = lengths(entry.at("size"), 2) or (0.0, 0.0)
        return (sides[0], sides[1], 0.0), (sides[0], sides[1], 0.0)
    if "size" in keys:
        # either a list of three dimensions, or a table of the smallest and the largest
        size, ends = entry.at("size"), [entry.at("size")]
        if isinstance(size.value, Mapping):
            size.require_known(("low", "high"))
            ends = [size.at("low"), size.at("high")]
        boxes = [lengths(end, 3) for end in ends]
        (ax, ay, az), (bx, by, bz) = boxes[0] or boxes[-1] or STAND_IN, boxes[-1] or boxes[0] or STAND_IN
        if None not in boxes and (ax > bx or ay > by or az > bz):
            size.needs("no side of low greater than that of high")
        return (ax, ay, az), (bx, by, bz)
    radius = _length(entry.at("radius"), SMALLEST / 2) if "radius" in keys else (0.0, 0.0)
    diameter = (2 * radius[0], 2 * radius[1])
    height = _length(entry.at("height"), SMALLEST) if "height" in keys else diameter
    return (diameter[0], diameter[0], height[0]), (diameter[1], diameter[1], height[1])


def _length(entry: TableEntry, least: float) -> tuple[float, float]:
    """Return the smallest and the largest value of a length in metres, given as a number or a list of two."""
    if isinstance(entry.value, list) and len(entry.value) == 2:
        pair = lengths(entry, 2, least) or (0.0, 0.0)
        if pair[0] > pair[1]:
            entry.needs("the smaller length first")
        return pair[0], pair[1]
    length = entry.number(least, MAX_LENGTH, "metres") or 0.0
    return length, length
