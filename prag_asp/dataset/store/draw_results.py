"""What is known of a draw: the values that go into rows, and into the journal of a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

NOTHING = msgspec.Raw(b"null")


class RecordingInfo(msgspec.Struct):
    """A recording of a first state, as its row says, and the colours that things have in it, where they vary."""

    file: str
    sha256: str
    frames: int
    seconds: float
    ends: list[int]
    colours: dict[str, str] = {}


class StartResult(msgspec.Struct):
    """A first state of a task: the index of its search, and where there are some a witness as JSON and a recording."""

    index: int
    witness: msgspec.Raw = NOTHING
    recording: RecordingInfo | None = None

    @property
    def text(self) -> str | None:
        """The witness as JSON, None where there is none."""
        content = bytes(self.witness)
        return None if content == bytes(NOTHING) else content.decode()


class DrawResult(msgspec.Struct):
    """What is known of a draw: the verdict on it, without the witness, and what was found for each first state."""

    part: str
    draw: int
    verdict: dict[str, Any] | None
    starts: list[StartResult]

    @property
    def passed(self) -> bool:
        """Whether it is a task of the dataset, and not one of those refused."""
        return self.verdict is None or self.verdict["status"] == "feasible"

    @property
    def witnesses(self) -> int:
        """How many first states have a witness."""
        return sum(bytes(start.witness) != bytes(NOTHING) for start in self.starts)

    @property
    def colours(self) -> Mapping[str, str]:
        """The colours of the recording of which the words of the task are, as far as they are not the scene's."""
        recording = self.starts[0].recording if self.starts else None
        return {} if recording is None else recording.colours
