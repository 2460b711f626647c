"""What a form of data sets is, and the list of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple, Protocol

from prag_asp.dataset.formats.episode_source import Source

Told = Callable[[str, int, int], None]
"""Is told how far things are: in words, how many are done, and how many there are."""


class Form(Protocol):
    """A form of data sets."""

    def write(self, source: Source, target: Path, progress: Told) -> None:
        """Write a data set, whole or not at all, in the memory of one episode.

        Raises:
            QueryError: it lacks something that this form needs.
            OutputError: it cannot be written.
        """


class Known(NamedTuple):
    """A form that there is: the name of its class, the packages that it needs, and whether it is of recordings."""

    title: str
    packages: tuple[str, ...]
    recorded: bool = True


FORMS: Mapping[str, Known] = {
    "lerobot": Known("LeRobot", ("pyarrow", "av")),
    "minari": Known("Minari", ("pyarrow", "h5py", "PIL")),
    "robomimic": Known("Robomimic", ("pyarrow", "h5py")),
    "bddl": Known("Bddl", ("pyarrow",), recorded=False),
}
"""The forms: each is a file here of that name, with a class of this one."""
