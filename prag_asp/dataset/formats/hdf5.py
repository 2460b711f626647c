"""What the forms in HDF5 have in common: files with the same bytes for the same arrays, and what an episode shows."""

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
"""Pictures, and rows of them, that are packed together: what stays as it is from one to the next takes little room."""


LONGEST = 60_000
"""Bytes of a text that is noted at a group: HDF5 has room for 64 kB there."""


class _Disk:
    """A file that HDF5 writes to, which keeps the first failure to itself: told of one, HDF5 ends the whole process.

    After it nothing more is written, and what is read back is zeros; so whoever writes asks now and then for it.
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
        found = bytearray(count)
        self.readinto(memoryview(found))
        return bytes(found)

    def readinto(self, buffer: memoryview) -> int:
        into = memoryview(buffer).cast("B")
        try:
            found = os.pread(self._descriptor, into.nbytes, self._at)
        except OSError as error:
            self.failed, found = self.failed or error, b""
        into[:] = found.ljust(into.nbytes, b"\0")
        return self._moved(into.nbytes)

    def truncate(self, size: int) -> int:
        try:
            os.ftruncate(self._descriptor, size)
        except OSError as error:
            self.failed = self.failed or error
        self._size = size
        return size

    def flush(self) -> None:
        """Do nothing: nothing is held back."""

    def close(self) -> None:
        os.close(self._descriptor)

    def check(self) -> None:
        """Tell of a failure.

        Raises:
            OSError: there was one.
        """
        if self.failed is not None:
            raise self.failed

    def _moved(self, count: int) -> int:
        self._at += count
        self._size = max(self._size, self._at)
        return count


@contextmanager
def written(path: Path, shown: Path) -> Iterator[tuple[h5py.File, Callable[[], None]]]:
    """Yield a new HDF5 file, and what is called after each episode: it ends the work where the disk has failed.

    The file is `shown` by another name where it cannot be written.

    Raises:
        OutputError: it cannot be written.
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
    """Put an array into a group; pictures are packed without loss."""
    packed: dict[str, Any] = {}
    if values.ndim > 2 and min(values.shape):
        chunks = (min(BLOCK, len(values)), min(ROWS, values.shape[1]), *values.shape[2:])
        packed = {"chunks": chunks, "compression": PACKED, "compression_opts": STRENGTH}
    with uninterrupted():  # an interruption that comes while HDF5 asks us to write is one more failure to it
        group.create_dataset(name, data=values, **packed)


def group_in(group: h5py.Group, name: str) -> h5py.Group:
    """Return a new group in another one."""
    with uninterrupted():
        return group.create_group(name)


def numbers_of(source: EpisodeSource, episode: ExportEpisode) -> dict[str, NDArray[np.float32]]:
    """Return what an episode shows but for pictures: `tools` are there where cameras are."""
    found = {"state": episode.state, "objects": source.objects_of(episode)}
    if source.furniture:
        found["openings"] = source.openings_of(episode)
    footage = episode.demonstration.footage
    return found if footage is None else {**found, "tools": footage.tools}


def pictures_of(source: EpisodeSource, episode: ExportEpisode) -> Iterator[tuple[str, str, NDArray[Any]]]:
    """Yield the camera, ``rgb``, ``depth`` or ``segmentation``, and the pictures, one such film at a time."""
    for camera, film in episode.films.items():
        yield camera, "rgb", film.rgb
        yield camera, "depth", film.depth
        yield camera, "segmentation", source.segmentation_of(episode, camera)


def require_steps(source: EpisodeSource, episode: ExportEpisode) -> int:
    """Return how many actions there are between the moments of an episode.

    Raises:
        QueryError: there is one moment alone.
    """
    if episode.length < 2:
        task = f"task {episode.entry.number} of {episode.entry.part}"
        raise QueryError(f"{source.data.folder}: the film of {task} has one picture; film at a higher --rate")
    return episode.length - 1


def note(group: h5py.Group, values: Mapping[str, Any]) -> None:
    """Note texts and numbers at a group.

    Raises:
        QueryError: a text is longer than HDF5 allows.
    """
    for name, value in values.items():
        if isinstance(value, str) and len(value.encode()) > LONGEST:
            raise QueryError(f"{group.name}: {name} is too long for HDF5; export shorter tasks, or --level vague")
        with uninterrupted():
            group.attrs[name] = value


def origin(episode: ExportEpisode) -> Mapping[str, Any]:
    """Return what is noted of an episode: its words, its plan, and where in the dataset it stands."""
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
