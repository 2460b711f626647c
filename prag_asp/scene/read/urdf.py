"""Read a URDF of one rigid body: its collision solids, mass, centre of mass and inertia.

Several links form one body if all their joints are fixed. The solids are boxes, cylinders, balls and meshes; visual
elements define the appearance, and other elements are ignored. No simulator is loaded, so that the linter can measure a
body. Lengths are metres.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import SceneError
from prag_asp.safe_reading import read_bytes
from prag_asp.scene.mass import MassProperties, combined, point_mass
from prag_asp.scene.read.asset_paths import find_asset, require_inside
from prag_asp.scene.read.body import body_shape, ends, roll_pitch_yaw, solid_mass, too_thin
from prag_asp.scene.read.looks.surface import hex_color
from prag_asp.scene.read.looks.surfaces import look_surfaces
from prag_asp.scene.read.scene_values import SMALLEST
from prag_asp.scene.read.stability import rotation
from prag_asp.scene.scene import Look, Shape, Size, Solid
from prag_asp.wording import plural

Floats = NDArray[np.float64]

ZEROS = "0 0 0"
LARGEST = 1_000_000
"""The largest size of a URDF in bytes, which is ample for a rigid body."""

MOST_SOLIDS = 1000
"""The largest number of collision solids of a body, because each adds time to every check of every pose."""


PROLOGUE = re.compile(rb"((?:\xef\xbb\xbf|\s|<!--.*?-->)+)(<\?xml\s.*?\?>)", re.DOTALL)
"""Characters that some files contain before the XML declaration, where XML allows none."""

BARE_AMPERSAND = re.compile(rb"&(?!(?:#[0-9]+|#x[0-9a-fA-F]+|amp|lt|gt|quot|apos);)")
"""An ampersand that begins no reference; XML forbids it, but simulators read it as a character."""

OTHER_AMPERSANDS = (b"<!ENTITY", b"<![CDATA[", b"\0")
"""Signs of a file in which ampersands have other meanings or another encoding."""

INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
"""The attributes of ``<inertia>``: the upper triangle of the matrix, row by row."""


class Frame(NamedTuple):
    """A rotation matrix (3, 3) and a position (3,) in metres."""

    rows: Floats
    at: Floats


def read_urdf(path: Path, folder: Path) -> Shape:
    """Return the shape of the body that a URDF describes; the file and its meshes must be inside a folder.

    The centre of the bounding box of the solids becomes the origin. A link whose ``<inertial>`` has no ``<origin>`` has
    its centre of mass at the centroid of its solids; an inertia that is impossible for a body of this size and mass is
    replaced by the inertia of uniform solids.

    Raises:
        SceneError: a file is missing, malformed or outside the folder, or does not describe one rigid body.
    """
    require_inside(path, folder)
    root, lines = _parsed(path, folder)
    frames = _frames(root, lines, path)
    solids: list[Solid] = []
    masses: list[MassProperties] = []
    for link, frame in frames.items():
        name = f"link {link.get('name', 'without a name')}"
        own = []
        for number, element in enumerate(link.iter("collision"), 1):
            with _errors_at(path, lines[element], f"{name}, collision {number}"):
                own.append(_solid(element, path, folder))
                list(ends(own[-1]))
        mass = link.find("inertial/mass")
        if mass is not None:
            with _errors_at(path, lines[mass], name):
                masses += _mass(link, mass, own, frame, len(frames) > 1)
        solids += own if frame is None else [_moved(solid, frame) for solid in own]
    if not masses or not solids:
        first = next(iter(frames))
        missing = "<collision>" if masses else "<mass> in an <inertial>"
        one = f"link {first.get('name', 'without a name')} has no"
        text = f"{one if len(frames) == 1 else 'none of its links has a'} {missing}"
        raise SceneError(f"{path}:{lines[first]}: {text}; add one")
    return body_shape("urdf", solids, combined(masses), looks=_looks(root, frames, path, folder))


def _looks(
    root: ElementTree.Element, frames: Mapping[ElementTree.Element, Frame | None], path: Path, folder: Path
) -> list[Look]:
    """Return the visual parts of the links, or none if any cannot be read, because half a body would be misleading."""
    named = {material.get("name", ""): material for material in root.iter("material") if len(material)}
    looks = []
    try:
        for link, frame in frames.items():
            for element in link.iter("visual"):
                solid, material = _solid(element, path, folder), element.find("material")
                paint = None if material is None else named.get(material.get("name", ""), material)
                look = Look(solid if frame is None else _moved(solid, frame), str(folder), *_paint(paint, path, folder))
                if solid.mesh:
                    look_surfaces(look)
                looks.append(look)
    except SceneError:
        return []
    return looks


def _paint(material: ElementTree.Element | None, path: Path, folder: Path) -> tuple[str, str]:
    """Return the colour and the texture path of a material; each may be empty."""
    color = None if material is None else material.find("color")
    texture = None if material is None else material.find("texture")
    rgba = "" if color is None else hex_color(*_numbers(" ".join(color.get("rgba", "").split()[:3]), 3, "a colour"))
    return rgba, "" if texture is None else str(find_asset(texture.get("filename", ""), path, folder))


def _frames(
    root: ElementTree.Element, lines: Mapping[ElementTree.Element, int], path: Path
) -> dict[ElementTree.Element, Frame | None]:
    """Return the frame of each link relative to the first link, whose frame is None; all joints have to be fixed.

    Raises:
        SceneError: there is no link, a joint moves, or the joints do not connect the links.
    """
    links = root.findall("link")
    joints = root.findall("joint")
    for joint in joints:
        kind = joint.get("type", "without a type")
        if kind != "fixed":
            text = f"joint {joint.get('name', 'without a name')} is {kind}, and a body is rigid; make it fixed"
            raise SceneError(f"{path}:{lines[joint]}: {text}")
    ends_of = {
        joint: tuple("" if (end := joint.find(tag)) is None else end.get("link", "") for tag in ("parent", "child"))
        for joint in joints
    }
    children = {child for _, child in ends_of.values()}
    by_name = {link.get("name", ""): link for link in links}
    roots = [link for link in links if link.get("name", "") not in children]
    if len(roots) != 1 or len(by_name) != len(links):
        named = ", ".join(f"{link.get('name')} in line {lines[link]}" for link in links)
        content = f"{plural(len(links), 'link')}{f' ({named})' if named else ''}"
        connected = ", or connect them by fixed joints" if links else ""
        raise SceneError(f"{path}:{lines[root]}: has {content}; give a URDF of one rigid link{connected}")
    frames: dict[ElementTree.Element, Frame | None] = {roots[0]: None}
    for link, frame in (waiting := list(frames.items())):
        for joint, (parent, child) in ends_of.items():
            if parent == link.get("name", "") and child in by_name and by_name[child] not in frames:
                with _errors_at(path, lines[joint], f"joint {joint.get('name', 'without a name')}"):
                    own = _frame(joint.find("origin"))
                frames[by_name[child]] = placed = own if frame is None else _composed(frame, own)
                waiting.append((by_name[child], placed))
    apart = next((link for link in links if link not in frames), None)
    if apart is not None:
        raise SceneError(f"{path}:{lines[apart]}: link {apart.get('name')} is not connected to the others by joints")
    return frames


def _frame(origin: ElementTree.Element | None) -> Frame:
    """Return the frame that an ``<origin>`` element describes."""
    at, turn = _origin(origin)
    return Frame(np.array(rotation(turn)), np.array(at))


def _composed(outer: Frame, inner: Frame) -> Frame:
    """Compose two frames, the second of which is relative to the first."""
    return Frame(outer.rows @ inner.rows, outer.rows @ inner.at + outer.at)


def _moved(solid: Solid, frame: Frame) -> Solid:
    """Transform a solid from the frame of its link to the frame of its body."""
    rows, at = _composed(frame, Frame(np.array(rotation(solid.turn)), np.array(solid.at)))
    x, y, z = map(float, at)
    return solid._replace(at=(x, y, z), turn=roll_pitch_yaw(rows))


def _mass(
    link: ElementTree.Element, mass: ElementTree.Element, solids: list[Solid], frame: Frame | None, among_others: bool
) -> list[MassProperties]:
    """Return the mass properties of a link in the body's frame, or none for a massless link `among_others`."""
    if among_others and _numbers(mass.get("value", ""), 1, "the value of <mass>")[0] == 0.0:
        return []
    kilograms = _lengths(mass, "value", 1)[0]
    uniform = solid_mass(solids).scaled(kilograms) if solids else point_mass(kilograms, np.zeros(3))
    origin = link.find("inertial/origin")
    own = _frame(origin)
    result = uniform if origin is None else uniform._replace(centre=own.at)
    inertia = link.find("inertial/inertia")
    if inertia is not None and solids:
        values = [_numbers(inertia.get(name, "0"), 1, f"the {name} of <inertia>")[0] for name in INERTIA]
        xx, xy, xz, yy, yz, zz = values
        matrix = own.rows @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ own.rows.T
        stated = result._replace(inertia=matrix)
        points = np.array([end for solid in solids for end in ends(solid)])
        if stated.fits(points.min(0), points.max(0)):
            result = stated
    return [result if frame is None else result.moved(*frame)]


def _parsed(path: Path, folder: Path) -> tuple[ElementTree.Element, dict[ElementTree.Element, int]]:
    """Return the root of an XML file, and the line in which each element begins."""
    try:
        content = read_bytes(path, within=folder, at_most=LARGEST)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    # The declaration is moved to the start; it takes up one line, so no line number changes.
    before = PROLOGUE.match(content)
    if before is not None:
        content = before[2] + before[1].replace(b"\xef\xbb\xbf", b"") + content[before.end() :]
    if not any(sign in content for sign in OTHER_AMPERSANDS):
        content = BARE_AMPERSAND.sub(b"&amp;", content)
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
    """Put the line and name of a URDF element before the messages of errors that the block raises."""
    try:
        yield
    except SceneError as error:
        raise SceneError(f"{path}:{line}: {what}: {error}") from error


def _solid(element: ElementTree.Element, path: Path, folder: Path) -> Solid:
    """Return the solid of a collision element."""
    place = _origin(element.find("origin"))
    geometry = element.find("geometry")
    shape = None if geometry is None else next(iter(geometry), None)
    if shape is None:
        raise SceneError("has no <geometry>; give it a box, cylinder, sphere or mesh")
    if shape.tag == "mesh":
        file = find_asset(shape.get("filename", ""), path, folder)
        return Solid("mesh", _lengths(shape, "scale", 3, "1 1 1"), *place, str(file))
    if shape.tag == "box":
        return _thick(Solid("box", _lengths(shape, "size", 3), *place))
    if shape.tag in ("cylinder", "sphere"):
        diameter = 2 * _lengths(shape, "radius", 1)[0]
        height = _lengths(shape, "length", 1)[0] if shape.tag == "cylinder" else diameter
        return _thick(Solid(shape.tag, (diameter, diameter, height), *place))
    raise SceneError(f"unknown geometry <{shape.tag}>; known are box, cylinder, sphere and mesh")


def _origin(origin: ElementTree.Element | None) -> tuple[Size, Size]:
    """Return the position in metres and the roll, pitch and yaw in radians of an ``<origin>``, or zeros without one."""
    at, turn = ((ZEROS if origin is None else origin.get(name, ZEROS)) for name in ("xyz", "rpy"))
    return _numbers(at, 3, "the xyz of <origin>"), _numbers(turn, 3, "the rpy of <origin>")


def _thick(solid: Solid) -> Solid:
    """Check that a solid is thick enough to collide with, and return it."""
    if min(solid.size) < SMALLEST:
        raise SceneError(f"a <{solid.kind}> is {too_thin(min(solid.size))}")
    return solid


def _lengths(element: ElementTree.Element, name: str, count: int, default: str = "") -> Size:
    """Return the `count` positive numbers in an attribute, padded with zeros."""
    values = _numbers(element.get(name, default), count, f"the {name} of <{element.tag}>")
    if min(values[:count]) <= 0.0:
        raise SceneError(f"<{element.tag}> has the {name} {element.get(name)!r}; give positive numbers")
    return values


def _numbers(text: str, count: int, name: str) -> Size:
    """Return the `count` finite numbers in a text, padded with zeros."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise SceneError(f"{name} is {text!r}; give {count} finite number{'s' if count > 1 else ''}")
    x, y, z = [*values, 0.0, 0.0][:3]
    return (x, y, z)
