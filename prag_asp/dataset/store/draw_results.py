"""Results of draws, as they are stored in rows and in the journal of a run."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from prag_asp.physics.verdict import Verdict

NOTHING = msgspec.Raw(b"null")

TRIVIAL = "the final state is the initial state"
"""The reason why a trivial task is left out."""


class RecordingInfo(msgspec.Struct):
    """The recording from an initial state, as stored in a row, with the colours of entities if these are randomized."""

    file: str
    sha256: str
    frames: int
    seconds: float
    ends: list[int]
    colours: dict[str, str] = {}


class StartResult(msgspec.Struct):
    """The result for an initial state of a task: the index of the search, the witness as JSON, and the recording."""

    index: int
    witness: msgspec.Raw = NOTHING
    recording: RecordingInfo | None = None

    @property
    def text(self) -> str | None:
        """The witness as JSON, or None if there is no witness."""
        content = bytes(self.witness)
        return None if content == bytes(NOTHING) else content.decode()


class DrawResult(msgspec.Struct):
    """The result of a draw: the verdict without its witness, and the result for each initial state.

    There is no verdict on a `trivial` task that is left out.
    """

    part: str
    draw: int
    verdict: Verdict | None
    starts: list[StartResult]
    trivial: bool = False

    @property
    def passed(self) -> bool:
        """Whether the task was accepted rather than rejected."""
        return not self.trivial and (self.verdict is None or self.verdict.feasible)

    @property
    def witnesses(self) -> int:
        """The number of initial states with a witness."""
        return sum(bytes(start.witness) != bytes(NOTHING) for start in self.starts)

    @property
    def colours(self) -> Mapping[str, str]:
        """The colours in the first recording, to which the texts refer; empty if they are those of the scene."""
        recording = self.starts[0].recording if self.starts else None
        return {} if recording is None else recording.colours

    def to_json(self) -> bytes:
        """Return the result as JSON, for the journal and for other processes."""
        verdict = None if self.verdict is None else self.verdict.to_json()
        if verdict is not None:
            del verdict["witness"]
        return msgspec.json.encode({**msgspec.structs.asdict(self), "verdict": verdict})
