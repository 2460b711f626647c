"""What cameras of a scene see of a moment, in a world of its own that is only looked at."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.physics.filming.staging import Staging
from prag_asp.physics.filming.studio import Studio, open_studio
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Moment
from prag_asp.scene.cameras import Camera
from prag_asp.scene.model import Scene

Image = NDArray[np.uint8]


class Viewer:
    """Looks at moments; its world is built anew only where other bodies take part or they have other sizes."""

    def __init__(self, cameras: Mapping[str, Camera], resources: ExitStack):
        self._cameras = cameras
        self._own = resources.enter_context(ExitStack())
        self._begun: tuple[Scene, tuple[str, ...]] | None = None
        self._studio: Studio | None = None

    def see(self, situation: Situation, *names: str) -> list[Image]:
        """Return what cameras see of a moment, in the order of their names, each of shape (height, width, 3)."""
        begun = situation.scene, tuple(situation.poses)
        if self._studio is None or self._begun != begun:
            self._own.close()
            self._studio = self._own.enter_context(open_studio(*begun))
            self._begun = begun
        self._studio.show(Moment(situation.poses, situation.arms, situation.openings))
        return [self._studio.take(self._cameras[name]).rgb for name in names]


def cameras_of(scene: Scene, names: object, size: object) -> dict[str, Camera]:
    """Return the cameras of a scene of some names; `size` is width and height in pixels.

    Raises:
        QueryError: there is no such camera, one is named twice, or the size is none.
    """
    if isinstance(names, str) or not isinstance(names, (tuple, list)):
        raise QueryError(f'cameras {names!r}: give their names, such as ("{next(iter(scene.cameras))}",)')
    sides = size if isinstance(size, (tuple, list)) else (size, size)
    whole = len(sides) == 2 and all(isinstance(side, int) and not isinstance(side, bool) for side in sides)
    if size is not None and not whole:
        raise QueryError(f"size {size!r}: give width and height in pixels, such as (128, 128)")
    staging = Staging(tuple(map(str, names)), None if size is None else (sides[0], sides[1]))
    return staging.cameras_of(scene)
