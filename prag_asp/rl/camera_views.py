"""Camera images of moments, rendered in a separate world without dynamics, and a window that shows them."""

from __future__ import annotations

import os
import sys
from contextlib import ExitStack, suppress
from importlib import import_module
from time import monotonic, sleep
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.filming.studio import Studio, open_studio
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Moment
from prag_asp.scene.cameras import Camera
from prag_asp.scene.scene import Scene

Image = NDArray[np.uint8]


INSTEAD = 'use render_mode="rgb_array"'


class Viewer:
    """A renderer of moments; its world is rebuilt only if the bodies or their sizes change.

    `names` lists the cameras whose images are part of observations. Without names, only `TaskEnv.render` uses a camera,
    the first one of the scene.

    Raises:
        QueryError: a camera does not exist or is named twice, or the size is invalid.
    """

    def __init__(self, scene: Scene, names: object, size: object, resources: ExitStack):
        self._observed = tuple(cameras_of(scene, names, size))
        self._cameras = cameras_of(scene, self._observed or (next(iter(scene.cameras)),), size)
        self._resources = resources
        self.forget()

    def forget(self) -> None:
        """Forget the world, which is already closed."""
        self._own: ExitStack | None = None
        self._studio: Studio | None = None
        self._shown: tuple[Scene, tuple[str, ...]] | None = None

    @property
    def spaces(self) -> dict[str, spaces.Box]:
        """The observation spaces of the cameras."""
        sizes = {name: self._cameras[name].size for name in self._observed}
        return {f"camera_{name}": spaces.Box(0, 255, (high, wide, 3), np.uint8) for name, (wide, high) in sizes.items()}

    def images(self, situation: Situation) -> dict[str, Image]:
        """Return the camera images for an observation, each of shape (height, width, 3)."""
        if not self._observed:
            return {}
        studio = self._studio_at(situation)
        return {f"camera_{name}": studio.take(self._cameras[name]).rgb for name in self._observed}

    def image(self, situation: Situation) -> Image:
        """Return the image of the first camera, of shape (height, width, 3)."""
        return self._studio_at(situation).take(next(iter(self._cameras.values()))).rgb

    def _studio_at(self, situation: Situation) -> Studio:
        """Return the studio, set to the moment of a situation."""
        shown = situation.scene, tuple(situation.poses)
        if self._own is None:
            self._own = self._resources.enter_context(ExitStack())
        if self._studio is None or self._shown != shown:
            self._own.close()
            self._studio, self._shown = self._own.enter_context(open_studio(*shown)), shown
        self._studio.show(Moment(situation.poses, situation.arms, situation.openings))
        return self._studio


def cameras_of(scene: Scene, names: object, size: object) -> dict[str, Camera]:
    """Return the named cameras of a scene; `size` is the width and height in pixels.

    Raises:
        QueryError: a camera does not exist or is named twice, or the size is invalid.
    """
    if isinstance(names, str) or not isinstance(names, (tuple, list)):
        raise QueryError(f'cameras {names!r}: give their names, such as ("{next(iter(scene.cameras))}",)')
    sides = size if isinstance(size, (tuple, list)) else (size, size)
    whole = len(sides) == 2 and all(isinstance(side, int) and not isinstance(side, bool) for side in sides)
    if size is not None and not whole:
        raise QueryError(f"size {size!r}: give width and height in pixels, such as (128, 128)")
    staging = Staging(tuple(map(str, names)), None if size is None else (sides[0], sides[1]))
    return staging.cameras_of(scene)


def has_display() -> bool:
    """Return whether the machine may have a display; on Linux, whether the environment variable DISPLAY is set."""
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY"))


class Window:
    """A window that shows `rate` images per second; it needs Tk, which most Python installations include.

    Once the user has closed the window, further images are not shown.

    Raises:
        QueryError: Python has no Tk, or there is no display.
    """

    def __init__(self, title: str, rate: int) -> None:
        self._title, self._period = title, 1 / rate
        self._root: Any = None
        self._due = 0.0
        self._open()

    def show(self, image: Image) -> None:
        """Show an image, of shape (height, width, 3), when it is due."""
        if self._root is None:
            self._open()
        tk = import_module("tkinter")
        height, width = image.shape[:2]
        content = f"P6 {width} {height} 255\n".encode() + image.tobytes()
        sleep(max(0.0, self._due - monotonic()))
        self._due = monotonic() + self._period
        try:
            photo = tk.PhotoImage(master=self._root, data=content, format="PPM", width=width, height=height)
            self._label.configure(image=photo)
            self._label.image = photo  # Tk does not keep a reference to it
            self._root.update()
        except tk.TclError:  # the user has closed the window
            return

    def close(self) -> None:
        """Close the window; the next image opens it again."""
        if self._root is None:
            return
        with suppress(import_module("tkinter").TclError):  # the user has closed the window
            self._root.destroy()
        self._root = None

    def _open(self) -> None:
        """Open the window."""
        try:
            tk = import_module("tkinter")
        except ImportError:
            raise QueryError(
                f"render_mode 'human' needs Tk, which this Python lacks; install it (python3-tk), or {INSTEAD}"
            ) from None
        try:
            self._root = tk.Tk()
        except tk.TclError as error:
            reason = " ".join(str(error).split())
            raise QueryError(
                f"render_mode 'human' needs a display: {reason}; run it on a desktop, under xvfb-run, or {INSTEAD}"
            ) from None
        self._root.title(self._title)
        self._label = tk.Label(self._root)
        self._label.pack()
