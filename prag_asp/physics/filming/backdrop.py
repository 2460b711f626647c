"""Render the table, its zones and the room with one ray per pixel.

Their surfaces are large, and the time that TinyRenderer takes grows with the number of pixels in a triangle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.filming.room import LEVEL, room_colours
from prag_asp.physics.filming.textures import Floats, wood
from prag_asp.physics.situation import TABLE_THICKNESS
from prag_asp.scene.boxes import Vector
from prag_asp.scene.cameras import Camera
from prag_asp.scene.colours import rgb
from prag_asp.scene.scene import Scene

AMBIENT, DIFFUSE, SPECULAR = 0.62, 0.42, 0.12
UPWARDS = 2
AROUND = 0
"""The entity number of the background."""


class Backdrop(NamedTuple):
    """The image behind robots and objects: colours (H, W, 3), depths in metres (H, W) and entity numbers (H, W).

    The depth of the background is infinite. `level` (H, W) marks the horizontal surfaces on which shadows fall, and
    `shade` is their brightness in the light.
    """

    rgb: NDArray[np.uint8]
    depth: Floats
    numbers: NDArray[np.int32]
    level: NDArray[np.bool_]
    shade: float


class LevelPatch(NamedTuple):
    """A horizontal rectangle: its centre and half-extents in metres, its yaw, colour and entity number.

    `z` is its height above the table in metres.
    """

    x: float
    y: float
    half: tuple[float, float]
    yaw: float
    color: str
    number: int
    z: float = 0.0


@lru_cache(maxsize=16)
def rays(camera: Camera) -> tuple[Floats, Floats]:
    """Return the x and y coordinates of each pixel at depth 1, shapes (1, W) and (H, 1)."""
    (width, height), matrix = camera.size, camera.intrinsics
    x = (np.arange(width) + 0.5 - matrix[0, 2]) / matrix[0, 0]
    y = (np.arange(height) + 0.5 - matrix[1, 2]) / matrix[1, 1]
    return x[None, :].astype(np.float32), y[:, None].astype(np.float32)


def patches(scene: Scene, numbers: Mapping[str, int]) -> list[LevelPatch]:
    """Return the zones of a scene as rectangles; `numbers` are the numbers of the entities."""
    return [_patch(scene, entity, numbers) for entity, shape in scene.shapes.items() if shape.kind == "zone"]


def has_still_floor(scene: Scene, entity: str) -> bool:
    """Return whether an entity is a container fixed on the table, whose floor needs no triangles."""
    shape = scene.shapes[entity]
    return shape.kind == "container" and shape.model is None and entity in scene.fixed


def floors(scene: Scene, numbers: Mapping[str, int]) -> list[LevelPatch]:
    """Return the floors of containers that are fixed on the table; `numbers` are the numbers of the entities."""
    entities = (entity for entity in scene.shapes if entity in numbers and has_still_floor(scene, entity))
    return [_patch(scene, entity, numbers, scene.shapes[entity].wall) for entity in entities]


def _patch(scene: Scene, entity: str, numbers: Mapping[str, int], wall: float = 0.0) -> LevelPatch:
    """Return the floor of a fixed entity as a rectangle at the height `wall` that ends in the middle of the walls."""
    (x, y, yaw), (half_x, half_y, _) = scene.fixed[entity], scene.shapes[entity].half
    half = (half_x - wall / 2, half_y - wall / 2)
    return LevelPatch(x, y, half, yaw, scene.color(entity), numbers[entity], wall)


def backdrop(
    scene: Scene,
    camera: Camera,
    pose: NDArray[np.float64],
    zones: Sequence[LevelPatch],
    table: int,
    light: Vector,
    raised: Sequence[LevelPatch] = (),
) -> Backdrop:
    """Return the image of the table, zones, rectangles `raised` above the table, and background from a camera pose.

    `table` is the number of the table; `light` is the direction to the light.
    """
    (width, height), turn = camera.size, pose[:3, :3].astype(np.float32)
    across, down = rays(camera)
    ahead = [(turn[axis, 0] * across + turn[axis, 1] * down + turn[axis, 2]).ravel() for axis in range(3)]
    # Flat arrays and indices, because masks of images take several times as long.
    colors = np.zeros((width * height, 3), dtype=np.uint8)
    numbers, level = np.full(len(colors), AROUND, dtype=np.int32), np.zeros(len(colors), dtype=np.bool_)
    focal = float(camera.intrinsics[0, 0])
    depth = np.full(len(colors), np.inf, dtype=np.float32)
    eye, half = pose[:3, 3].astype(np.float32), np.array([*scene.table.size, TABLE_THICKNESS], dtype=np.float32) / 2
    centre = np.array([*scene.table.centre, -TABLE_THICKNESS / 2], dtype=np.float32)
    for axis in range(3):
        # The camera sees at most one of two opposite faces, and no other face of a convex body hides it.
        away = float(eye[axis] - centre[axis])
        if abs(away) <= half[axis]:
            continue
        falling = np.where(np.abs(ahead[axis]) < LEVEL, LEVEL, ahead[axis])
        far = np.float32(math.copysign(half[axis], away) - away) / falling
        one, two = (other for other in range(3) if other != axis)
        points = [eye[other] - centre[other] + far * ahead[other] for other in (one, two)]
        within = (far >= camera.near) & (far <= camera.far)
        within &= (np.abs(points[0]) <= half[one]) & (np.abs(points[1]) <= half[two])
        seen = np.flatnonzero(within)
        if not len(seen):
            continue
        shade, near = _shade(axis, away, light), far[seen]
        depth[seen], numbers[seen] = near, table
        if axis != UPWARDS or away <= 0.0:
            colors[seen] = _shaded(scene.table.color, shade)
            continue
        level[seen] = True
        x, y = points[0][seen] + centre[0], points[1][seen] + centre[1]
        colored = np.empty((len(seen), 3), dtype=np.float32)
        colored[:] = np.array(rgb(scene.table.color), np.float32) * shade
        for zone in zones:
            inside = np.flatnonzero(_within(x, y, zone))
            numbers[seen[inside]], colored[inside] = zone.number, np.array(rgb(zone.color), np.float32) * shade
        grain = wood().at(x, y, float(np.median(near)) / focal)
        colors[seen] = np.minimum(colored * grain[:, None], 255.0).astype(np.uint8)
    # TinyRenderer adds the same specular brightness to a horizontal surface for any camera.
    gloss = SPECULAR * (max(0.0, light[UPWARDS]) / math.hypot(*light)) ** 2
    above = _shade(UPWARDS, 1.0, light)
    shade = above + gloss
    falling = np.minimum(ahead[UPWARDS], -LEVEL)
    for patch in raised:
        far = np.float32(patch.z - eye[UPWARDS]) / falling
        within = (far >= camera.near) & (far <= camera.far) & (far < depth)
        within &= _within(eye[0] + far * ahead[0], eye[1] + far * ahead[1], patch)
        seen = np.flatnonzero(within)
        depth[seen], numbers[seen], colors[seen] = far[seen], patch.number, _shaded(patch.color, shade)
        level[seen] = True
    around = np.flatnonzero(numbers == AROUND)
    if len(around):
        seen_rays = (ahead[0][around], ahead[1][around], ahead[2][around])
        colors[around] = room_colours(scene.table, eye, seen_rays, focal, light)
    image = (height, width)
    return Backdrop(
        colors.reshape(*image, 3), depth.reshape(image), numbers.reshape(image), level.reshape(image), above
    )


def _within(x: Floats, y: Floats, zone: LevelPatch) -> NDArray[np.bool_]:
    """Return which points of the table top lie in a zone."""
    cosine, sine = math.cos(zone.yaw), math.sin(zone.yaw)
    along, across = cosine * (x - zone.x) + sine * (y - zone.y), cosine * (y - zone.y) - sine * (x - zone.x)
    inside: NDArray[np.bool_] = (np.abs(along) <= zone.half[0]) & (np.abs(across) <= zone.half[1])
    return inside


def _shade(axis: int, side: float, light: Vector) -> float:
    """Return the brightness of a surface whose normal points along an axis, or against it if `side` is negative."""
    return AMBIENT + DIFFUSE * max(0.0, math.copysign(1.0, side) * light[axis] / math.hypot(*light))


def _shaded(color: str, shade: float) -> NDArray[np.uint8]:
    """Return the RGB values, from 0 to 255, of a colour like ``#e4572e`` with a given brightness."""
    return np.array([min(255.0, part * shade) for part in rgb(color)]).astype(np.uint8)
