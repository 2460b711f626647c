"""The formats that datasets can be exported to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple, Protocol

from prag_asp.dataset.formats.episode_source import EpisodeSource

Progress = Callable[[str, int, int], None]
"""Takes the progress: in words, how many are done, and how many there are."""


class ExportFormat(Protocol):
    """Writes a dataset in the format of another program."""

    def write(self, source: EpisodeSource, target: Path, progress: Progress) -> None:
        """Write a dataset, whole or not at all, in the memory of one episode.

        Raises:
            QueryError: it lacks something that this form needs.
            OutputError: it cannot be written.
        """


class FormatInfo(NamedTuple):
    """A format: the name of its class, the packages that it needs, and whether it needs recordings."""

    title: str
    packages: tuple[str, ...]
    recorded: bool = True


FORMS: Mapping[str, FormatInfo] = {
    "lerobot": FormatInfo("LeRobot", ("pyarrow", "av")),
    "minari": FormatInfo("Minari", ("pyarrow", "h5py", "PIL")),
    "robomimic": FormatInfo("Robomimic", ("pyarrow", "h5py")),
    "bddl": FormatInfo("Bddl", ("pyarrow",), recorded=False),
}
"""The formats by name; each is the module of that name, with a class of this one."""
