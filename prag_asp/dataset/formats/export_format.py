"""What a form of datasets is, and the list of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple, Protocol

from prag_asp.dataset.formats.episode_source import EpisodeSource

Progress = Callable[[str, int, int], None]
"""Is told how far things are: in words, how many are done, and how many there are."""


class ExportFormat(Protocol):
    """A form of datasets."""

    def write(self, source: EpisodeSource, target: Path, progress: Progress) -> None:
        """Write a dataset, whole or not at all, in the memory of one episode.

        Raises:
            QueryError: it lacks something that this form needs.
            OutputError: it cannot be written.
        """


class FormatInfo(NamedTuple):
    """A form that there is: the name of its class, the packages that it needs, and whether it is of recordings."""

    title: str
    packages: tuple[str, ...]
    recorded: bool = True


FORMS: Mapping[str, FormatInfo] = {
    "lerobot": FormatInfo("LeRobot", ("pyarrow", "av")),
    "minari": FormatInfo("Minari", ("pyarrow", "h5py", "PIL")),
    "robomimic": FormatInfo("Robomimic", ("pyarrow", "h5py")),
    "bddl": FormatInfo("Bddl", ("pyarrow",), recorded=False),
}
"""The forms: each is a file here of that name, with a class of this one."""
