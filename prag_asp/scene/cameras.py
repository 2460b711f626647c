"""Cameras: their positions, their targets, and the projection of points to pixels.

Lengths are metres. The axes of a camera are those of the pinhole model: x points to the right in the image, y down, and
z forwards.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.scene.boxes import Vector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

TOWARDS_EYE, FIELD_OF_VIEW = (0.86, 0.36, 0.56), 42.0
"""The default direction from the scene to the eye, and the default vertical field of view in degrees."""

FRONT = "front"
"""The name of the default camera."""

BORDER = 0.97
"""The share of a camera image that the fitted points may fill."""

FITTINGS = 40
HAND_ROOM = 0.12
"""The height above the table, in metres, that the default camera shows, so that hands are visible."""

WRIST, WRIST_AT, WRIST_LOOK_AT, WRIST_FIELD = "wrist", (0.08, 0.0, -0.06), (0.015, 0.0, 0.04), 75.0
"""The name of the default camera at a wrist, its position and its target in the frame of the tool in metres, and its
field of view in degrees: a 50 mm cube that is less than 0.2 m below the fingers covers at least 300 pixels of an image
of 128 x 128 pixels."""

STRAIGHT = 0.999
"""The cosine of the smallest angle between the viewing direction and the axis that points upwards in the image."""


class Camera(NamedTuple):
    """A camera at a place, in metres, that looks at a point; `field_of_view` is vertical, in degrees.

    With a `mount`, the name of a robot, both points are in the frame of its tool: the fingers point along its z axis
    and open along its y axis, and its x axis points upwards in the image. Without a mount, the z axis of the scene
    points upwards in the image. `size` is the width and height of an image in pixels. Points nearer than `near` or
    farther than `far` metres are clipped.
    """

    at: Vector
    look_at: Vector
    field_of_view: float = FIELD_OF_VIEW
    mount: str = ""
    size: tuple[int, int] = (128, 128)
    near: float = 0.02
    far: float = 5.0

    @property
    def intrinsics(self) -> NDArray[np.float64]:
        """The camera matrix with the focal lengths fx and fy and the principal point cx and cy in pixels, shape (3, 3).

        The centre of the first pixel is at (0.5, 0.5), and pixels are square.
        """
        import numpy as np  # noqa: PLC0415 - a scene can be read without using its cameras

        width, height = self.size
        focal = height / 2 / math.tan(math.radians(self.field_of_view) / 2)
        return np.array([[focal, 0.0, width / 2], [0.0, focal, height / 2], [0.0, 0.0, 1.0]])

    @property
    def pose(self) -> NDArray[np.float64]:
        """The pose of the camera in the frame of its mount, or of the scene, as a homogeneous matrix, shape (4, 4)."""
        import numpy as np  # noqa: PLC0415

        eye, target = np.array(self.at), np.array(self.look_at)
        ahead = (target - eye) / np.linalg.norm(target - eye)
        up = (1.0, 0.0, 0.0) if self.mount else (0.0, 0.0, 1.0)
        if abs(ahead @ up) > STRAIGHT:
            up = (0.0, 1.0, 0.0) if self.mount else (1.0, 0.0, 0.0)
        right = np.cross(ahead, up)
        right /= np.linalg.norm(right)
        placed = np.eye(4)
        placed[:3] = np.column_stack([right, np.cross(ahead, right), ahead, eye])
        return placed


def usual_cameras(
    workspace: tuple[float, float, float, float], robots: Sequence[str], fixed: Sequence[Vector] = ()
) -> dict[str, Camera]:
    """Return the default cameras of a scene: one in front, and one at the wrist of each robot.

    The first shows the workspace, the fingers over it, and the points of fixed bodies, as closely as possible.
    """
    low_x, high_x, low_y, high_y = workspace
    corners = tuple((x, y, z) for x in (low_x, high_x) for y in (low_y, high_y) for z in (0.0, HAND_ROOM))
    eye, target = fitted((*corners, *fixed), 1.0)
    wrists = {(f"{robot}_{WRIST}" if len(robots) > 1 else WRIST): robot for robot in robots}
    return {
        FRONT: Camera(eye, target),
        **{name: Camera(WRIST_AT, WRIST_LOOK_AT, WRIST_FIELD, robot) for name, robot in wrists.items()},
    }


@lru_cache(maxsize=1 << 7)
def fitted(
    seen: Sequence[Vector], aspect: float, towards: Vector = TOWARDS_EYE, field_of_view: float = FIELD_OF_VIEW
) -> tuple[Vector, Vector]:
    """Return the eye and the target for which the points just fit into an image with a given width-to-height ratio.

    `towards` is the direction from the points to the eye.
    """
    import numpy as np  # noqa: PLC0415

    axis = np.array(towards) / np.linalg.norm(towards)
    right = np.cross((0.0, 0.0, 1.0), axis)
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(axis, right), axis])
    slope = BORDER * math.tan(math.radians(field_of_view) / 2)
    slopes = np.array([slope * aspect, slope])
    points = np.array(seen) @ axes.T
    centre, distance = points.mean(axis=0), 1.0
    for _ in range(FITTINGS):
        # Set the distance so that every point fits, then move the target so that the points are centred in the image.
        offsets = points - centre
        distance = float((offsets[:, 2] + (np.abs(offsets[:, :2]) / slopes).max(axis=1)).max())
        shown = offsets[:, :2] / (distance - offsets[:, 2:])
        centre[:2] += (shown.max(axis=0) + shown.min(axis=0)) / 2 * distance / 2
    target = centre @ axes
    eye = target + distance * axis
    return (float(eye[0]), float(eye[1]), float(eye[2])), (float(target[0]), float(target[1]), float(target[2]))
