"""The answers of tools on planning tasks, saved in a file so that an interrupted run can be resumed."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from peers_process import Run

UNFINISHED = "not finished"
"""The prefix of a failure that a higher limit may resolve."""


@dataclass(frozen=True)
class Answer:
    """The count of a tool for a task and a length within a limit of processor seconds, or its failure.

    `accepted` says whether the tool could read the task.
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
        """Return the answer within another limit."""
        if self.count is None or self.seconds <= limit:
            return self
        return replace(self, count=None, limit=limit, failure=f"{UNFINISHED} after {limit:g} s")

    def settles(self, limit: float) -> bool:
        """Return whether this answer determines the answer within a limit."""
        return self.count is not None or self.limit >= limit or not self.failure.startswith(UNFINISHED)


class Answers:
    """All answers, saved in a file of JSON lines if `path` is given; the last one for a key is valid."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        lines = path.read_text().splitlines() if path and path.is_file() else []
        answers = (Answer(**json.loads(line)) for line in lines)
        self._saved = {(each.task, each.tool, each.length): each for each in answers}

    def get(self, task: str, tool: str, length: int, limit: float, run: Callable[[], Run] | None) -> Answer | None:
        """Return the saved answer; without one, that of `run`, or None if `run` is None."""
        key = (task, tool, length)
        answer = self._saved.get(key)
        if answer is None or not answer.settles(limit):
            if run is None:
                return None
            answer = self._saved[key] = _answer(key, limit, run())
            if self._path:
                with self._path.open("a") as file:
                    file.write(json.dumps(asdict(answer)) + "\n")
        return answer.within(limit)


def _answer(key: tuple[str, str, int], limit: float, run: Run) -> Answer:
    last = run.results[-1] if run.results else {}
    return Answer(*key, limit, bool(run.results), last.get("count"), round(last.get("seconds", 0.0), 3), run.failure)
