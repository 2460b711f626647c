"""Show what an action changes: an outline around it, and a close-up where the hand hides it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.demonstration.footage import CameraImage
from prag_asp.physics.filming.studio import Studio
from prag_asp.physics.pictures.camera import OVERSAMPLING, pillow, reduced, view_camera
from prag_asp.physics.pictures.views import DIRECTIONS, FAR, View, acting, counting_camera
from prag_asp.physics.witness import Moment
from prag_asp.scene.cameras import FIELD_OF_VIEW, Camera
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

if TYPE_CHECKING:
    from PIL import Image

MARK, HALO = (232, 18, 124), (255, 255, 255)
"""The colours of outlines and of their inner and outer edges; no object with default colours has the colour of
outlines."""

LINE, EDGE = 2, 1
"""The width of an outline and of each of its edges, in pixels of the picture."""

SPECK = 2
"""Half of the width in pixels up to which a part of an object gets no outline, unless the object has no wider part."""

HIDDEN = 0.55
"""The share of an object that has to be visible, or else the object counts as hidden."""

INSET, BORDER = 0.40, 2
"""The side of a close-up as a share of the shorter side of the picture, and the width of its border in pixels."""

ROOM, LEAST_ROOM = 1.5, 0.09
"""The radius that a close-up shows, as a multiple of the object's radius, and its minimum in metres."""

CLOSE_UP = 64
"""The side in pixels of the images with which directions for a close-up are compared."""

MOVED = 1e-3
"""The motion of an object or of a part of furniture that counts as a change, in metres or radians."""


def changed_entities(task: Task, moments: Sequence[Moment], scene: Scene, state: int) -> list[str]:
    """Return the bodies that the action before a state moves or, if none, those in its subgoal; none for state 0."""
    if state == 0:
        return []
    before, after = moments[state - 1], moments[state]
    things = sorted(acting(task, scene, state) - scene.robots.keys())
    moved = [
        thing
        for thing in after.poses
        if thing in before.poses
        and (
            math.dist(before.poses[thing].position, after.poses[thing].position) > MOVED
            or abs(before.openings.get(thing, 0.0) - after.openings.get(thing, 0.0)) > MOVED
        )
    ]
    return moved or things[:1]


def highlighted(
    studio: Studio, moment: Moment, scene: Scene, changed: Sequence[str], size: tuple[int, int], view: View
) -> Image.Image:
    """Return a picture of a moment with outlines around what has changed, and with a close-up; `size` is in pixels.

    The studio must already show the moment.
    """
    taken = studio.take(view_camera(view, size))
    shown = reduced(_outlined(taken, studio, changed), size)
    hidden = _most_hidden(studio, changed, size, view)
    if hidden is None:
        return shown
    side = round(INSET * min(size))
    close = _close_up(studio, moment, scene, hidden, side)
    if close is not None:
        frame = pillow().new("RGB", (side + 2 * BORDER, side + 2 * BORDER), HALO)
        frame.paste(reduced(_outlined(close, studio, changed), (side, side)), (BORDER, BORDER))
        shown.paste(frame, _emptiest_corner(taken.segmentation, studio, size, side + 2 * BORDER))
    return shown


def _outlined(taken: CameraImage, studio: Studio, changed: Sequence[str]) -> CameraImage:
    """Return an image with an outline around each of the entities."""
    rgb = taken.rgb.copy()
    for entity in changed:
        inside = taken.segmentation == studio.legend.index(entity)
        large = _grown(~_grown(~inside, SPECK * OVERSAMPLING), SPECK * OVERSAMPLING) & inside
        reach = large if large.any() else inside
        for width, colour in ((EDGE, HALO), (LINE, MARK), (EDGE, HALO)):
            wider = _grown(reach, width * OVERSAMPLING)
            rgb[wider & ~reach & ~inside] = colour
            reach = wider
    return taken._replace(rgb=rgb)


def _grown(mask: NDArray[np.bool_], pixels: int) -> NDArray[np.bool_]:
    """Return a mask enlarged by a number of pixels on all sides; every other step also grows it diagonally."""
    grown: NDArray[np.bool_] = mask.copy()
    for step in range(pixels):
        before = grown.copy()
        grown[1:] |= before[:-1]
        grown[:-1] |= before[1:]
        across = grown.copy() if step % 2 else before
        grown[:, 1:] |= across[:, :-1]
        grown[:, :-1] |= across[:, 1:]
    return grown


def _most_hidden(studio: Studio, changed: Sequence[str], size: tuple[int, int], view: View) -> str | None:
    """Return the entity that the robots hide most in a view, or None if all of them are well visible."""
    camera = counting_camera(view, size)
    seen, whole = studio.counts(camera), studio.counts(camera, robots=False)
    shares = {entity: seen[entity] / max(1, whole[entity]) for entity in changed}
    entity = min(shares, key=lambda each: shares[each], default=None)
    return entity if entity is not None and shares[entity] < HIDDEN else None


def _close_up(studio: Studio, moment: Moment, scene: Scene, entity: str, side: int) -> CameraImage | None:
    """Return a close-up of an entity from the direction that shows most of it, or None if no direction shows it."""
    target = moment.poses[entity].position
    radius = max(LEAST_ROOM, ROOM * math.hypot(*scene.shapes[entity].size) / 2)
    distance = radius / math.sin(math.radians(FIELD_OF_VIEW) / 2)
    cameras = []
    for towards in DIRECTIONS:
        length = distance / math.hypot(*towards)
        eye = (target[0] + length * towards[0], target[1] + length * towards[1], target[2] + length * towards[2])
        cameras.append(Camera(eye, target, FIELD_OF_VIEW, size=(CLOSE_UP, CLOSE_UP), near=0.03, far=FAR))
    counts = [studio.counts(camera)[entity] for camera in cameras]
    if max(counts) == 0:
        return None
    pixels = OVERSAMPLING * side
    return studio.take(cameras[counts.index(max(counts))]._replace(size=(pixels, pixels)))


def _emptiest_corner(
    segmentation: NDArray[np.unsignedinteger], studio: Studio, size: tuple[int, int], side: int
) -> tuple[int, int]:
    """Return the pixel for the upper left corner of a square that covers the emptiest corner of a picture."""
    width, height = size
    corners = [(width - side, 0), (0, 0), (width - side, height - side), (0, height - side)]
    bodies = segmentation > studio.legend.index(studio.table)

    def hides(corner: tuple[int, int]) -> int:
        x, y = (place * OVERSAMPLING for place in corner)
        return int(bodies[y : y + side * OVERSAMPLING, x : x + side * OVERSAMPLING].sum())

    return min(corners, key=hides)
