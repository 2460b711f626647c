"""The surroundings of the bodies in an episode: the table with its zones, and the floor."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO

import numpy as np

from prag_asp.physics.filming.room import FLOOR, FLOOR_HEIGHT
from prag_asp.physics.filming.textures import FLOOR_SIDE, WOOD_SIDE, Texture, concrete, wood
from prag_asp.physics.pictures.camera import pillow
from prag_asp.physics.playback.mesh_pieces import MeshPiece, body_pieces
from prag_asp.physics.playback.tracks import BodyTrack
from prag_asp.physics.situation import TABLE_THICKNESS
from prag_asp.physics.world.visible_pieces import Rgba, paint
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import yaw_quaternion
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import boxes
from prag_asp.scene.surfaces import Floats
from prag_asp.scene.variation import table_of

TEXELS, QUALITY = 512, 85
"""The number of texels along a side of a texture in a file, 3 mm each on the table, and the JPEG quality: 60 KB in all.
"""

BRIGHTEST = 1.25
"""The brightness factor that a white texel stands for; the colour of the surface is multiplied by it."""

LEG, INSET = 0.03, 0.06
"""Half the thickness of a table leg, and its distance from the edges of the table, in metres."""

FLOOR_HALF = 4.0
"""Half the side of the floor in metres; viewers fade it out before it ends."""

FLOOR_NAME = "floor"
"""The name of the floor's body."""

ABOVE = 0.0005
"""The height in metres at which zones are drawn above the table, so that they hide the table."""


def surroundings(scene: Scene) -> Iterator[BodyTrack]:
    """Yield the table, its zones and the floor, which never move.

    Raises:
        PicturesMissingError: Pillow is not installed.
    """
    (x, y), (wide, deep) = scene.table.centre, (side / 2 for side in scene.table.size)
    grain = _image(wood())
    top = _rectangle((wide, deep), paint(scene.table.color), grain, WOOD_SIDE, (x, y))
    low, high = FLOOR_HEIGHT, -TABLE_THICKNESS
    legs = [
        ((i * (wide - INSET), j * (deep - INSET), (low + high) / 2), (LEG, LEG, (high - low) / 2))
        for i in (-1, 1)
        for j in (-1, 1)
    ]
    slab = ((0.0, 0.0, -TABLE_THICKNESS / 2 - ABOVE), (wide, deep, TABLE_THICKNESS / 2))
    yield _still(table_of(scene), [top, *body_pieces(boxes([slab, *legs]), (), scene.table.color)], (x, y, 0.0))
    for entity, shape in scene.shapes.items():
        if shape.kind == "zone":
            zone_x, zone_y, yaw = scene.fixed[entity]
            half = (shape.half[0], shape.half[1])
            piece = _rectangle(half, paint(scene.color(entity)), grain, WOOD_SIDE, (zone_x, zone_y))
            yield _still(entity, [piece], (zone_x, zone_y, ABOVE), yaw)
    red, green, blue = (part / 255 for part in FLOOR)
    floor = _rectangle((FLOOR_HALF, FLOOR_HALF), (red, green, blue, 1.0), _image(concrete()), FLOOR_SIDE, (x, y))
    yield _still(FLOOR_NAME, [floor], (x, y, FLOOR_HEIGHT))


def _still(name: str, pieces: list[MeshPiece], at: Vector, yaw: float = 0.0) -> BodyTrack:
    return BodyTrack(name, pieces, np.array([(*at, *yaw_quaternion(yaw))], dtype=np.float32))


def _rectangle(
    half: tuple[float, float], rgba: Rgba, image: bytes, side: float, centre: tuple[float, float]
) -> MeshPiece:
    """Return a horizontal rectangle with a texture that repeats every `side` metres; `half` are half-extents."""
    corners: Floats = np.array([(x * half[0], y * half[1], 0.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    triangles = corners[[[0, 1, 2], [0, 2, 3]]]
    normals = np.broadcast_to((0.0, 0.0, 1.0), triangles.shape)
    places = (triangles[..., :2] + centre) / side
    brighter = tuple(min(1.0, BRIGHTEST * part) for part in rgba[:3])
    return MeshPiece(triangles, normals, (*brighter, 1.0), places, image)


def _image(texture: Texture) -> bytes:
    """Return a texture of brightness factors as a grey JPEG."""
    level = next(level for level in texture.levels if len(level) == TEXELS)
    grey = np.clip(np.round(level / BRIGHTEST * 255), 0, 255).astype(np.uint8)
    buffer = BytesIO()
    # A texture has its first row at y = 0, an image at the top.
    pillow().fromarray(grey[::-1].copy()).save(buffer, "JPEG", quality=QUALITY)
    return buffer.getvalue()
