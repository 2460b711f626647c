"""The options of demonstrations: the cameras that record them, and the properties that vary between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from prag_asp.errors import QueryError
from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND
from prag_asp.scene.cameras import Camera
from prag_asp.scene.read.camera_reader import PIXELS
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import KINDS, Variation, draw_variation
from prag_asp.wording import did_you_mean

RATES = tuple(rate for rate in range(1, FRAMES_A_SECOND + 1) if FRAMES_A_SECOND % rate == 0)
"""The frame rates that divide the frame rate of episodes."""


@dataclass(frozen=True)
class Staging:
    """The cameras of a scene that record demonstrations, and the properties that vary, which are some of `KINDS`.

    `size` is the width and height of images in pixels, by default those set for each camera; `rate` is in images per
    second.

    Raises:
        QueryError: a camera is named twice, a size or a rate is invalid, or a kind of variation is unknown.
    """

    cameras: tuple[str, ...] = ()
    size: tuple[int, int] | None = None
    rate: int = 10
    vary: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for kind in self.vary:
            if kind not in KINDS:
                raise QueryError(f"{kind} cannot vary; {did_you_mean(kind, KINDS)}")
        for name in self.cameras:
            if self.cameras.count(name) > 1:
                raise QueryError(f"the camera {name} is named {self.cameras.count(name)} times; name it once")
        if self.rate not in RATES:
            rates = ", ".join(map(str, RATES))
            raise QueryError(f"an episode has {FRAMES_A_SECOND} frames per second: record at {rates}; got {self.rate}")
        low, high = PIXELS
        if self.size is not None and not all(low <= side <= high for side in self.size):
            width, height = self.size
            raise QueryError(f"a camera's picture has {low} to {high} pixels a side; got {width}x{height}")

    def sample_variation(self, scene: Scene, objects: Sequence[str], seeds: Sequence[int]) -> Variation | None:
        """Return a random variation for a demonstration with the given objects, or None if nothing varies."""
        return draw_variation(scene, self.vary, objects, seeds) if self.vary else None

    def cameras_of(self, scene: Scene) -> dict[str, Camera]:
        """Return the cameras that record in a scene, by name, with the requested size of images.

        Raises:
            QueryError: the scene lacks one of the cameras.
        """
        for name in self.cameras:
            if name not in scene.cameras:
                hint = did_you_mean(name, scene.cameras)
                raise QueryError(f"the scene has no camera {name}; {hint}")
        cameras = {name: scene.cameras[name] for name in self.cameras}
        return cameras if self.size is None else {name: each._replace(size=self.size) for name, each in cameras.items()}
