"""What others have made of a data set: the draws that were dealt to each of them, in one order again."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from prag_asp.dataset.store.shard_reader import Given, GivenPart
from prag_asp.space.sampling.sharding import Deal

if TYPE_CHECKING:
    from pathlib import Path

    from prag_asp.dataset.store.dataset import Dataset


class Jobs:
    """The parts of one data set, all of them, by their numbers from 1."""

    def __init__(self, parts: Sequence[Dataset]) -> None:
        self._parts = parts
        self._given = {
            note.name: [GivenPart(part.folder, each) for part in parts for each in part.manifest.parts
                        if each.name == note.name]
            for note in parts[0].manifest.parts
        }  # fmt: skip

    def have(self, name: str, draw: int) -> bool:
        """Tell whether a draw of a part of the split was looked at."""
        own, job = divmod(draw, len(self._parts))
        return own < self._given[name][job].draws

    def lacking(self, name: str, first: int, limit: int) -> Iterable[Iterable[int]]:
        """Yield the draws that nobody has looked at, from one on to before another, some together."""
        given, jobs = self._given[name], len(self._parts)
        whole = min(Deal(number, jobs).whole(part.draws) for number, part in enumerate(given, 1))
        every = max(Deal(number, jobs).whole(part.draws) for number, part in enumerate(given, 1))
        first, last = max(first, whole), min(every, limit)
        yield (draw for draw in range(first, last) if not self.have(name, draw))
        yield range(max(first, last), limit)

    def draw(self, name: str, draw: int) -> Given:
        """Return what is known of a draw that was looked at; none before it is asked for later.

        Raises:
            QueryError: a file of a part is missing, or is not what its dataset.json says.
        """
        own, job = divmod(draw, len(self._parts))
        return self._given[name][job].draw(own)

    def folder(self, draw: int) -> Path:
        """Return the folder of the part that a draw was dealt to."""
        return self._parts[draw % len(self._parts)].folder
