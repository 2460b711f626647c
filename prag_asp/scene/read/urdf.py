"""Read a URDF of one rigid link: its collision solids, their bounding box, and its mass.

The solids are boxes, cylinders, balls and meshes (.obj and .stl, of which simulators take convex hulls); other elements
are ignored. No simulator is loaded, so that the linter can measure a body. Lengths are metres.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers import expat

from prag_asp.errors import SceneError
from prag_asp.safe_reading import is_inside, read_bytes
from prag_asp.scene.forms import FORMS
from prag_asp.scene.read.mesh import mesh_points, thickness
from prag_asp.scene.read.scene_values import SMALLEST
from prag_asp.scene.read.stability import rotation
from prag_asp.scene.scene import BodyModel, Shape, Size, Solid
from prag_asp.wording import plural

ZEROS = "0 0 0"
LARGEST = 1_000_000
"""The largest size of a URDF in bytes, ample for one rigid link."""

MOST_SOLIDS = 1000
"""The largest number of collision solids of a body: each takes time in every check of every pose."""


def read_urdf(path: Path, folder: Path) -> Shape:
    """Return the shape of the body that a URDF describes; the file and its meshes have to be inside a folder.

    The centre of the bounding box of the solids becomes the origin, and counts as the centre of mass.

    Raises:
        SceneError: a file is missing, outside or malformed, or does not describe one rigid body.
    """
    _require_inside(path, folder)
    root, lines = _parsed(path, folder)
    links = root.findall("link")
    if len(links) != 1:
        named = ", ".join(f"{link.get('name')} in line {lines[link]}" for link in links)
        content = f"{plural(len(links), 'link')}{f' ({named})' if named else ''}"
        raise SceneError(f"{path}:{lines[root]}: has {content}; give a URDF of one rigid link")
    (link,) = links
    name = f"link {link.get('name', 'without a name')}"
    solids, corners = [], list[Size]()
    for number, element in enumerate(link.iter("collision"), 1):
        with _errors_at(path, lines[element], f"{name}, collision {number}"):
            solids.append(_solid(element, path, folder))
            corners += _ends(solids[-1])
    mass = link.find("inertial/mass")
    if mass is None or not solids:
        missing = "<collision>" if mass is not None else "<mass> in an <inertial>"
        raise SceneError(f"{path}:{lines[link]}: {name} has no {missing}; add one")
    with _errors_at(path, lines[mass], name):
        weight = _lengths(mass, "value", 1)[0]
    low, high = (_size([end(corner[i] for corner in corners) for i in range(3)]) for end in (min, max))
    middle = _size([(a + b) / 2 for a, b in zip(low, high, strict=True)])
    centred = tuple(solid._replace(at=_minus(solid.at, middle)) for solid in solids)
    return Shape("urdf", _minus(high, low), model=BodyModel(centred, weight))


def _parsed(path: Path, folder: Path) -> tuple[ElementTree.Element, dict[ElementTree.Element, int]]:
    """Return the root of an XML file, and the line in which each element begins."""
    try:
        content = read_bytes(path, within=folder, at_most=LARGEST)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    builder, parser = ElementTree.TreeBuilder(), expat.ParserCreate()
    lines: dict[ElementTree.Element, int] = {}
    solids = count(1)

    def start(tag: str, attributes: dict[str, str]) -> None:
        if tag == "collision" and next(solids) > MOST_SOLIDS:
            where, text = f"{path}:{parser.CurrentLineNumber}", f"more than {MOST_SOLIDS:,} collisions"
            raise SceneError(f"{where}: {text}; give the body a simpler shape, such as one mesh or a few boxes")
        lines[builder.start(tag, attributes)] = parser.CurrentLineNumber

    parser.StartElementHandler, parser.EndElementHandler = start, builder.end
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise SceneError(f"{path}:{error.lineno}: not XML: {expat.ErrorString(error.code)}; fix the line") from error
    except (LookupError, ValueError) as error:
        raise SceneError(f"{path}:1: not XML: its encoding cannot be read; save it as UTF-8") from error
    return builder.close(), lines


@contextmanager
def _errors_at(path: Path, line: int, what: str) -> Iterator[None]:
    """Prefix errors that the block raises with the line of an element of a URDF and its name."""
    try:
        yield
    except SceneError as error:
        raise SceneError(f"{path}:{line}: {what}: {error}") from error


def _require_inside(path: Path, folder: Path) -> None:
    """Check that a file exists inside a folder."""
    if not is_inside(path, folder):
        raise SceneError(f"{path}: lies outside the domain; copy it into {folder}")
    if not path.is_file():
        raise SceneError(f"{path}: there is no such file; give the path from the folder of the domain")


def _solid(element: ElementTree.Element, path: Path, folder: Path) -> Solid:
    """Return the solid of a collision element."""
    origin = element.find("origin")
    at, turn = ((ZEROS if origin is None else origin.get(name, ZEROS)) for name in ("xyz", "rpy"))
    place = (_numbers(at, 3, "the xyz of <origin>"), _numbers(turn, 3, "the rpy of <origin>"))
    geometry = element.find("geometry")
    shape = None if geometry is None else next(iter(geometry), None)
    if shape is None:
        raise SceneError("has no <geometry>; give it a box, cylinder, sphere or mesh")
    if shape.tag == "mesh":
        file = path.parent / shape.get("filename", "").removeprefix("package://")
        _require_inside(file, folder)
        return Solid("mesh", _lengths(shape, "scale", 3, "1 1 1"), *place, str(file))
    if shape.tag == "box":
        return _thick(Solid("box", _lengths(shape, "size", 3), *place))
    if shape.tag in ("cylinder", "sphere"):
        diameter = 2 * _lengths(shape, "radius", 1)[0]
        height = _lengths(shape, "length", 1)[0] if shape.tag == "cylinder" else diameter
        return _thick(Solid(shape.tag, (diameter, diameter, height), *place))
    raise SceneError(f"unknown geometry <{shape.tag}>; known are box, cylinder, sphere and mesh")


def _thick(solid: Solid) -> Solid:
    """Return a solid after a check that it is thick enough to collide with."""
    if min(solid.size) < SMALLEST:
        raise SceneError(f"a <{solid.kind}> is {_thin(min(solid.size))}")
    return solid


def _thin(thickness: float) -> str:
    """Return the problem of a solid that is too thin, and the remedy, in words."""
    return f"{thickness:.3g} m thin; make it at least {SMALLEST:g} m thick"


def _lengths(element: ElementTree.Element, name: str, count: int, default: str = "") -> Size:
    """Return the `count` positive numbers of an attribute, padded with zeros."""
    values = _numbers(element.get(name, default), count, f"the {name} of <{element.tag}>")
    if min(values[:count]) <= 0.0:
        raise SceneError(f"<{element.tag}> has the {name} {element.get(name)!r}; give positive numbers")
    return values


def _numbers(text: str, count: int, name: str) -> Size:
    """Return the `count` finite numbers of a text, padded with zeros."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise SceneError(f"{name} is {text!r}; give {count} finite number{'s' if count > 1 else ''}")
    return _size([*values, 0.0, 0.0][:3])


def _ends(solid: Solid) -> Iterator[Size]:
    """Yield points that have the bounding box of a solid in the frame of the link."""
    rows = rotation(solid.turn)
    if solid.mesh:
        points = mesh_points(solid.mesh, solid.size)
        if thickness(points) < SMALLEST:
            raise SceneError(f"{solid.mesh}: the mesh is {_thin(thickness(points))}")
        turned = [[sum(a * b for a, b in zip(row, point, strict=True)) for row in rows] for point in points]
    else:
        half = _size([side / 2 for side in solid.size])
        reach = [FORMS[solid.kind].reach(half, row) for row in rows]
        turned = [reach, [-side for side in reach]]
    for point in turned:
        yield _size([a + b for a, b in zip(point, solid.at, strict=True)])


def _minus(one: Size, two: Size) -> Size:
    """Return the difference of two vectors."""
    return (one[0] - two[0], one[1] - two[1], one[2] - two[2])


def _size(values: list[float]) -> Size:
    """Return three numbers as a tuple."""
    return (values[0], values[1], values[2])
