"""Read the results of several machines, each of which has validated its draws of a dataset, in the order of draws."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.making.draw_plan import DrawPlan, Holder
from prag_asp.dataset.store.shard_reader import DrawRows, PartReader

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset


class MachineParts:
    """A reader of all machine parts of a dataset, given in order."""

    def __init__(self, parts: Sequence[Dataset]) -> None:
        self._parts = parts
        self._readers = {
            note.name: [PartReader(part.folder, each) for part in parts for each in part.manifest.parts
                        if each.name == note.name]
            for note in parts[0].manifest.parts
        }  # fmt: skip

    def plan(self, name: str) -> DrawPlan:
        """Return the plan of a part of the split, with the draws that the machines have validated."""
        return DrawPlan(validated=tuple(reader.draws for reader in self._readers[name]))

    def draw(self, name: str, holder: Holder) -> DrawRows:
        """Return the rows of a draw; draws must be requested in ascending order.

        Raises:
            QueryError: a file of a part is missing, or differs from its record in dataset.json.
        """
        return self._readers[name][holder.machine].draw(holder.draw)

    def folder(self, holder: Holder) -> Path:
        """Return the folder of the machine part that contains a draw."""
        return self._parts[holder.machine].folder
