"""Animations of demonstrations in the formats GIF, WebP and MP4."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import OutputError, PicturesMissingError, QueryError
from prag_asp.output import whole_file
from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND, Demonstration
from prag_asp.physics.filming.appearance_meshes import FINE, MIDDLE
from prag_asp.physics.filming.camera_rendering import moment_of
from prag_asp.physics.filming.studio import Studio
from prag_asp.physics.pictures.camera import picture, pillow, view_camera
from prag_asp.physics.pictures.picture_world import open_picture_world
from prag_asp.physics.pictures.rendering import caption, check_headings, moments_of
from prag_asp.physics.pictures.saving import save_picture
from prag_asp.physics.pictures.sheet import MARGIN, PAPER, Panel, line_count, sheet
from prag_asp.physics.pictures.views import View
from prag_asp.processes.progress_events import report_progress
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

if TYPE_CHECKING:
    from PIL import Image

RATE = 10
"""The default frame rate of animations, in frames per second."""

LAST_PAUSE = 1500
"""The pause at the end of an animation, in milliseconds."""

ANIMATIONS = (".gif", ".webp", ".mp4")
"""The file suffixes of animations."""

WEBP = {"quality": 80, "method": 2}
"""Options for Pillow: with its default, method 4, the encoder takes twice as long for files that are 3 % smaller."""

MP4 = {"crf": "20", "preset": "veryfast"}
"""Options for the encoder x264: a quality at which no blocks are visible."""

PALETTE, SAMPLES = 256, 6
"""The number of colours of a GIF, and the number of frames from which they are chosen."""

CONTRAST = 24
"""The difference in brightness from a neighbour, from 0 to 255, above which a pixel is smoothed."""


def _report_frames(done: int, total: int) -> None:
    """Report the progress of an animation."""
    report_progress("drawing frames", done, total)


def animate(
    task: Task,
    demonstration: Demonstration,
    scene: Scene,
    path: Path,
    *,
    size: tuple[int, int] = (400, 350),
    speed: float = 2.0,
    rate: int = RATE,
    fine: bool = False,
    headings: Sequence[str | None] | None = None,
    bystanders: bool = True,
    progress: Callable[[int, int], None] = _report_frames,
) -> None:
    """Write an animation of a demonstration, `speed` times as fast, as a .gif, .webp or .mp4, depending on the suffix.

    It shows `rate` frames per second, with the current action below; `size` is the size of a frame in pixels. With
    `fine`, frames are rendered like still pictures, which takes four times as long. With `bystanders`, objects that the
    task does not name are also shown, where they hide and touch nothing. `progress` is called with the number of
    rendered frames and the total number of frames.

    Raises:
        PicturesMissingError: Pillow or, for an .mp4, PyAV is not installed.
        QueryError: the suffix is not supported, the speed is not positive, or the demonstration does not belong to the
            task.
        OutputError: the file cannot be written.
    """
    if path.suffix.lower() not in ANIMATIONS:
        raise QueryError(f"{path}: an animation is a .gif, a .webp or an .mp4")
    if not 0.0 < speed < math.inf:
        raise QueryError(f"the speed of an animation is a positive number; got {speed}")
    moments = moments_of(task, demonstration)
    check_headings(task, headings)
    pillow()
    every = max(1, round(speed * FRAMES_A_SECOND / rate))
    frames = [*range(0, len(demonstration.times) - 1, every), len(demonstration.times) - 1]
    captions = [caption(task, scene, k, headings)[0] for k in range(len(moments))]
    pictures = []
    options: dict[str, Any] = {"fineness": FINE if fine else MIDDLE, "bystanders": bystanders}
    with open_picture_world(task, demonstration, moments, scene, size, **options) as world:
        studio, drawn = world.studio, (moment_of(demonstration, frame) for frame in frames)
        view = world.choose_view(range(len(moments)), drawn)
        blank = pillow().new("RGB", size)
        lines = line_count(captions, size[0])
        pages = [sheet([Panel(blank, each)], 1, lines=lines) for each in captions]
        for frame in frames:
            world.show(moment_of(demonstration, frame))
            k = min(bisect_left(demonstration.ends.tolist(), frame), len(task.actions))
            page = pages[k].copy()
            page.paste(picture(studio, size, view) if fine else _quick_picture(studio, size, view), (MARGIN, MARGIN))
            pictures.append(page)
            progress(len(pictures), len(frames))
    times = demonstration.times[frames] * 1000 / speed
    pauses = [*(int(pause) for pause in np.round(np.diff(times))), LAST_PAUSE]
    if path.suffix.lower() == ".mp4":
        _write_mp4(path, pictures, pauses, rate)
        return
    encoding: dict[str, Any] = WEBP
    if path.suffix.lower() == ".gif":
        pictures, encoding = _in_one_palette(pictures), {"disposal": 1}
    save_picture(pictures[0], path, save_all=True, append_images=pictures[1:], duration=pauses, loop=0, **encoding)


def _quick_picture(studio: Studio, size: tuple[int, int], view: View) -> Image.Image:
    """Return a picture with smoothed edges that is rendered no larger than necessary."""
    image: Image.Image = pillow().fromarray(smoothed(studio.take(view_camera(view, size, 1)).rgb))
    return image


def smoothed(rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return an image (H, W, 3) in which each pixel at an edge is mixed with its four neighbours.

    This takes a fraction of the time that rendering four times as many pixels would take.
    """
    brightness = rgb[..., 1].astype(np.int16)
    edges = np.zeros(brightness.shape, dtype=np.bool_)
    across, down = (np.abs(np.diff(brightness, axis=axis)) > CONTRAST for axis in (1, 0))
    edges[:, 1:] |= across
    edges[:, :-1] |= across
    edges[1:] |= down
    edges[:-1] |= down
    edges[0] = edges[-1] = edges[:, 0] = edges[:, -1] = False
    rows, columns = np.nonzero(edges)
    sums = 4 * rgb[rows, columns].astype(np.uint16)
    for row, column in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        sums += rgb[rows + row, columns + column]
    mixed: NDArray[np.uint8] = rgb.copy()
    mixed[rows, columns] = sums // 8
    return mixed


def _in_one_palette(pictures: Sequence[Image.Image]) -> list[Image.Image]:
    """Return pictures that share one palette, so that the colours of still parts do not change.

    A colour counts as often as the square root of its frequency, because objects are small and the table is large.
    """
    some = np.stack([np.asarray(each) for each in pictures[:: max(1, len(pictures) // SAMPLES)]])
    colours, counts = np.unique((some >> 2).reshape(-1, 3) << 2, axis=0, return_counts=True)
    board = np.repeat(colours, np.ceil(np.sqrt(counts)).astype(int), axis=0)[None]
    palette = pillow().fromarray(board).quantize(PALETTE)
    return [each.quantize(palette=palette, dither=pillow().Dither.NONE) for each in pictures]


def _write_mp4(path: Path, pictures: Sequence[Image.Image], pauses: Sequence[int], rate: int) -> None:
    """Write a video in the format H.264, which every browser can play.

    Raises:
        PicturesMissingError: PyAV is not installed.
        OutputError: the file cannot be written.
    """
    try:
        import av  # noqa: PLC0415 - heavy
    except ImportError as error:
        raise PicturesMissingError('videos need PyAV: pip install "prag_asp[pictures]"') from error
    width, height = (side + side % 2 for side in pictures[0].size)  # the encoder requires an even width and height
    try:
        options = {"movflags": "faststart"}  # the index stands at the beginning, so browsers play at once
        with whole_file(path) as unfinished, av.open(str(unfinished), "w", format="mp4", options=options) as file:
            stream: Any = file.add_stream("libx264", rate=rate, options=MP4)
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            for image in _at_constant_rate(pictures, pauses, rate):
                even = pillow().new("RGB", (width, height), PAPER)
                even.paste(image)
                file.mux(stream.encode(av.VideoFrame.from_ndarray(np.asarray(even), format="rgb24")))
            file.mux(stream.encode())
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: the video cannot be written: {error}") from None


def _at_constant_rate(pictures: Iterable[Image.Image], pauses: Iterable[int], rate: int) -> Iterator[Image.Image]:
    """Yield pictures at a constant rate per second, each repeated to last for its pause, given in milliseconds."""
    shown, due = 0, 0.0
    for frame, pause in zip(pictures, pauses, strict=True):
        due += pause * rate / 1000
        while shown < round(due):
            yield frame
            shown += 1
