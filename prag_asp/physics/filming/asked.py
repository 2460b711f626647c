"""What is asked of cameras: which of them film a demonstration, how large the pictures are, and how many a second."""

from __future__ import annotations

from dataclasses import dataclass

from prag_asp.errors import QueryError
from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND
from prag_asp.scene.cameras import Camera
from prag_asp.scene.model import Scene
from prag_asp.wording import did_you_mean

RATES = tuple(rate for rate in range(1, FRAMES_A_SECOND + 1) if FRAMES_A_SECOND % rate == 0)
"""Pictures a second that a recording has frames for, evenly."""

SMALLEST, LARGEST = 16, 2048
"""Pixels of a side of a picture."""


@dataclass(frozen=True)
class Filming:
    """Cameras of a scene by their names, `size` of their pictures as width and height in pixels, and pictures a second.

    Without a size each camera has its own.

    Raises:
        QueryError: no camera is named, one twice, or a size or a rate cannot be.
    """

    cameras: tuple[str, ...]
    size: tuple[int, int] | None = None
    rate: int = 10

    def __post_init__(self) -> None:
        if not self.cameras:
            raise QueryError("no camera is named; name some of the scene, such as front")
        for name in self.cameras:
            if self.cameras.count(name) > 1:
                raise QueryError(f"the camera {name} is named {self.cameras.count(name)} times; name it once")
        if self.rate not in RATES:
            known = ", ".join(map(str, RATES))
            raise QueryError(f"a recording has {FRAMES_A_SECOND} frames a second: film at {known}; got {self.rate}")
        if self.size is not None and not all(SMALLEST <= side <= LARGEST for side in self.size):
            width, height = self.size
            raise QueryError(f"a camera's picture has {SMALLEST} to {LARGEST} pixels a side; got {width}x{height}")

    def of(self, scene: Scene) -> dict[str, Camera]:
        """Return the cameras that film in a scene, by their names, with the size that is asked for.

        Raises:
            QueryError: the scene has no such camera.
        """
        for name in self.cameras:
            if name not in scene.cameras:
                hint = did_you_mean(name, scene.cameras)
                raise QueryError(f"the scene has no camera {name}; {hint}")
        found = {name: scene.cameras[name] for name in self.cameras}
        return found if self.size is None else {name: each._replace(size=self.size) for name, each in found.items()}
