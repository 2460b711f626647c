"""How many of its steps a run has done that writes a file in each, for the next run of the same to go on from there."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

from prag_asp.output.atomic_files import replace_file
from prag_asp.safe_reading import read_bytes


class Steps:
    """A note of them, in a file that is gone when all are done."""

    def __init__(self, note: Path, run: str) -> None:
        """Read how many steps of the same run are done."""
        self._note, self._run = note, run
        self.done = 0
        try:
            told = json.loads(read_bytes(note))
            if told["run"] == run and type(told["done"]) is int:
                self.done = max(told["done"], 0)
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            pass

    def do(self, number: int) -> None:
        """Note that so many are done.

        Raises:
            OutputError: it cannot be written.
        """
        self.done = number
        content = json.dumps({"run": self._run, "done": number})
        replace_file(self._note, content.encode(), follow=False)

    def finish(self) -> None:
        """Remove the note."""
        with suppress(OSError):
            self._note.unlink()
