"""Write AV1 videos in MP4: one file for many episodes, with the same bytes for the same images."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.output.atomic_file import output_errors

CODEC, PIXELS = "av1", "yuv420p"
OPTIONS = {"g": "10", "crf": "30", "preset": "8", "svtav1-params": "lp=1"}
"""The options of the encoder: a key frame at least every ten images, for quick seeking, and a single thread, for
reproducible bytes.
"""

QUIET = "0"
"""The log level that silences the encoder, which writes to stderr; failures are raised as errors."""


class Video:
    """A writer of a video file, image by image."""

    def __init__(self, path: Path, size: tuple[int, int], rate: int) -> None:
        """Begin a file for images with a width and height in pixels and a `rate` in images per second.

        Raises:
            OutputError: the file cannot be written.
        """
        os.environ.setdefault("SVT_LOG", QUIET)
        import av

        self.path, self._rate, self._pictures = path, rate, 0
        with output_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = av.open(str(path), "w", format="mp4")
        stream: Any = self._file.add_stream("libsvtav1", rate=rate, options=OPTIONS)
        stream.width, stream.height = size
        stream.pix_fmt = PIXELS
        stream.codec_context.thread_count = 1
        self._stream = stream

    @property
    def seconds(self) -> float:
        """The duration so far, in seconds."""
        return self._pictures / self._rate

    @property
    def size(self) -> int:
        """The number of bytes written so far, not counting images that the encoder buffers."""
        return self.path.stat().st_size if self.path.exists() else 0

    def add(self, picture: NDArray[np.uint8], *, key: bool = False) -> None:
        """Add an image of shape (H, W, 3); a `key` frame can be decoded without the preceding frames.

        Raises:
            OutputError: the file cannot be written.
        """
        import av
        from av.video.frame import PictureType

        frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
        if key:
            frame.pict_type = PictureType.I
        self._write(self._stream.encode(frame))
        self._pictures += 1

    def close(self) -> None:
        """Write the buffered images, and close the file.

        Raises:
            OutputError: the file cannot be written.
        """
        self._write(self._stream.encode())
        with output_errors(self.path):
            self._file.close()

    def _write(self, packets: Iterable[Any]) -> None:
        with output_errors(self.path):
            for packet in packets:
                self._file.mux(packet)


def video_info(size: tuple[int, int], rate: int) -> dict[str, Any]:
    """Return LeRobot's description of a video, given its width and height in pixels, and its rate."""
    width, height = size
    return {
        "video.height": height,
        "video.width": width,
        "video.codec": CODEC,
        "video.pix_fmt": PIXELS,
        "video.is_depth_map": False,
        "video.fps": rate,
        "video.channels": 3,
        "has_audio": False,
    }
