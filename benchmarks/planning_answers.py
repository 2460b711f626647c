"""What tools have said of planning tasks, kept in a file: a run that was broken off goes on where it was."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from peers_process import Run

UNFINISHED = "not finished"
"""How a failure begins that a higher limit may mend."""


@dataclass(frozen=True)
class Answer:
    """What a tool says of a task and a length, at a limit of processor seconds; without a count, why not.

    It has `accepted` a task that it could read.
    """

    task: str
    tool: str
    length: int
    limit: float
    accepted: bool
    count: int | None
    seconds: float
    failure: str

    def within(self, limit: float) -> Answer:
        """Return what the tool says at a limit."""
        if self.count is None or self.seconds <= limit:
            return self
        return replace(self, count=None, limit=limit, failure=f"{UNFINISHED} after {limit:g} s")

    def settles(self, limit: float) -> bool:
        """Tell whether it is known what the tool says at a limit."""
        return self.count is not None or self.limit >= limit or not self.failure.startswith(UNFINISHED)


class Answers:
    """All answers, in a file of JSON lines where there is one; the last one of a tool, a task and a length counts."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        lines = path.read_text().splitlines() if path and path.is_file() else []
        found = (Answer(**json.loads(line)) for line in lines)
        self._known = {(each.task, each.tool, each.length): each for each in found}

    def get(self, task: str, tool: str, length: int, limit: float, ask: Callable[[], Run] | None) -> Answer | None:
        """Return what a tool says; if that is not known, ask it, or return None where it is not to be asked."""
        key = (task, tool, length)
        known = self._known.get(key)
        if known is None or not known.settles(limit):
            if ask is None:
                return None
            known = self._known[key] = _answer(key, limit, ask())
            if self._path:
                with self._path.open("a") as file:
                    file.write(json.dumps(asdict(known)) + "\n")
        return known.within(limit)


def _answer(key: tuple[str, str, int], limit: float, run: Run) -> Answer:
    last = run.results[-1] if run.results else {}
    return Answer(*key, limit, bool(run.results), last.get("count"), round(last.get("seconds", 0.0), 3), run.failure)
