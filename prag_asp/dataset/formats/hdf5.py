"""The common parts of the HDF5 formats: files with reproducible bytes, and the observations in an episode."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.formats.episode_source import EpisodeSource, ExportEpisode
from prag_asp.errors import QueryError
from prag_asp.output.atomic_file import output_errors
from prag_asp.processes.workers import uninterrupted

PACKED, STRENGTH = "gzip", 6
BLOCK, ROWS = 16, 8
"""The numbers of images and of pixel rows in a compressed block, in which unchanged pixels take little space."""

LONGEST = 60_000
"""The maximum length of a text attribute in bytes, because the header of a group in HDF5 holds 64 kB."""


class _Disk:
    """A file object for HDF5 that stores the first error instead of raising it, because HDF5 would abort the process.

    After an error, nothing more is written, and reads may return zeros, so writers must call `check` regularly.
    """

    def __init__(self, path: Path) -> None:
        self.failed: OSError | None = None
        self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC)
        self._at = self._size = 0

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        self._at = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._size}[whence]
        return self._at

    def tell(self) -> int:
        return self._at

    def write(self, content: memoryview) -> int:
        left, at = memoryview(content).cast("B"), self._at
        try:
            while left and self.failed is None:
                count = os.pwrite(self._descriptor, left, at)
                left, at = left[count:], at + count
        except OSError as error:
            self.failed = error
        return self._moved(memoryview(content).nbytes)

    def read(self, count: int) -> bytes:
        content = bytearray(count)
        self.readinto(memoryview(content))
        return bytes(content)

    def readinto(self, buffer: memoryview) -> int:
        into = memoryview(buffer).cast("B")
        try:
            content = os.pread(self._descriptor, into.nbytes, self._at)
        except OSError as error:
            self.failed, content = self.failed or error, b""
        into[:] = content.ljust(into.nbytes, b"\0")
        return self._moved(into.nbytes)

    def truncate(self, size: int) -> int:
        try:
            os.ftruncate(self._descriptor, size)
        except OSError as error:
            self.failed = self.failed or error
        self._size = size
        return size

    def flush(self) -> None:
        """Do nothing: there is no buffer."""

    def close(self) -> None:
        os.close(self._descriptor)

    def check(self) -> None:
        """Raise the first error, if there was one.

        Raises:
            OSError: reading or writing failed.
        """
        if self.failed is not None:
            raise self.failed

    def _moved(self, count: int) -> int:
        self._at += count
        self._size = max(self._size, self._at)
        return count


@contextmanager
def written(path: Path, shown: Path) -> Iterator[tuple[h5py.File, Callable[[], None]]]:
    """Yield a new HDF5 file, and a function that raises an error if writing failed; call it after each episode.

    Errors give `shown` as the path.

    Raises:
        OutputError: the file cannot be written.
    """
    with output_errors(shown):
        disk = _Disk(path)
        try:
            with uninterrupted():
                file = h5py.File(disk, "w")
            try:
                yield file, disk.check
            finally:
                with uninterrupted():
                    file.close()
        except Exception:
            disk.check()
            raise
        finally:
            disk.close()
        disk.check()


def put(group: h5py.Group, name: str, values: NDArray[Any]) -> None:
    """Write an array to a group; images are compressed without loss."""
    options: dict[str, Any] = {}
    if values.ndim > 2 and min(values.shape):
        chunks = (min(BLOCK, len(values)), min(ROWS, values.shape[1]), *values.shape[2:])
        options = {"chunks": chunks, "compression": PACKED, "compression_opts": STRENGTH}
    with uninterrupted():  # HDF5 would treat an interruption during a write as an error
        group.create_dataset(name, data=values, **options)


def group_in(group: h5py.Group, name: str) -> h5py.Group:
    """Create a group in another group."""
    with uninterrupted():
        return group.create_group(name)


def numbers_of(source: EpisodeSource, episode: ExportEpisode) -> dict[str, NDArray[np.float32]]:
    """Return the numeric observations in an episode; `openings` exist only if there is furniture."""
    observations = {"state": episode.state, "objects": source.objects_of(episode), "tools": source.tools_of(episode)}
    return observations | ({"openings": source.openings_of(episode)} if source.furniture else {})


def pictures_of(source: EpisodeSource, episode: ExportEpisode) -> Iterator[tuple[str, str, NDArray[Any]]]:
    """Yield each video: its camera, its kind (``rgb``, ``depth`` or ``segmentation``), and its images."""
    for camera, video in episode.videos.items():
        yield camera, "rgb", video.rgb
        yield camera, "depth", video.depth
        yield camera, "segmentation", source.segmentation_of(episode, camera)


def require_steps(source: EpisodeSource, episode: ExportEpisode) -> int:
    """Return the number of actions between the time steps of an episode.

    Raises:
        QueryError: there is only one time step.
    """
    if episode.length < 2:
        task = f"task {episode.entry.number} of {episode.entry.part}"
        raise QueryError(f"{source.data.folder}: the video of {task} has one image; record at a higher --rate")
    return episode.length - 1


def note(group: h5py.Group, values: Mapping[str, Any]) -> None:
    """Write texts and numbers as attributes of a group.

    Raises:
        QueryError: a text is longer than HDF5 allows.
    """
    for name, value in values.items():
        if isinstance(value, str) and len(value.encode()) > LONGEST:
            raise QueryError(f"{group.name}: {name} is too long for HDF5; export shorter tasks, or --level vague")
        with uninterrupted():
            group.attrs[name] = value


def origin(episode: ExportEpisode) -> Mapping[str, Any]:
    """Return the origin of an episode: its instruction, its plan, and the part, task and start in the dataset."""
    entry = episode.entry
    return {
        "instruction": episode.instruction,
        "plan": episode.plan,
        "subgoals": list(episode.subgoals),
        "part": entry.part,
        "task": entry.number,
        "start": episode.start,
        "rank": str(entry.rank),
    }
