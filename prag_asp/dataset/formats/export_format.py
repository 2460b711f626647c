"""The formats to which datasets can be exported."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple, Protocol

from prag_asp.dataset.formats.episode_source import EpisodeSource

Progress = Callable[[str, int, int], None]
"""A callback that reports progress: a message, the number of exported items, and the total number."""


class ExportFormat(Protocol):
    """A format of another program, with its options."""

    def write(self, source: EpisodeSource, target: Path, progress: Progress) -> None:
        """Write a dataset atomically, with one episode in memory at a time.

        Raises:
            QueryError: the dataset lacks something that this format needs.
            OutputError: the target cannot be written.
        """


class FormatInfo(NamedTuple):
    """A format: the name of its class, the packages that it needs, whether it needs recordings, and its pip extra."""

    title: str
    packages: tuple[str, ...]
    recorded: bool = True
    extra: str = "formats"


FORMS: Mapping[str, FormatInfo] = {
    "lerobot": FormatInfo("LeRobot", ("pyarrow", "av")),
    "minari": FormatInfo("Minari", ("pyarrow", "h5py", "PIL")),
    "robomimic": FormatInfo("Robomimic", ("pyarrow", "h5py")),
    "bddl": FormatInfo("Bddl", ("pyarrow",), recorded=False),
    "rerun": FormatInfo("Rerun", ("pyarrow", "PIL", "rerun"), extra="rerun"),
}
"""The formats by name, which is also the name of the module that defines the class."""
