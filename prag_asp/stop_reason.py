"""The reason why work stopped early, as a value: code compares it, and turns it into prose only to print it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum


class StopKind(Enum):
    """The kinds of reasons: the first four end a request; after the others, an engine tries a different method."""

    TIME = "the time limit"
    MEMORY = "the memory limit"
    CRASH = "the end of a child process"
    CANCEL = "a newer request"
    SIZE = "more edges than are explored without merging states"
    HALT = "a criterion of the caller"
    FORECAST = "a forecast that exceeds the memory"


@dataclass(frozen=True)
class StopReason:
    """The kind of a reason, and the limit: in seconds for time, in bytes for memory, and None otherwise."""

    kind: StopKind
    limit: float | None = None

    def prose(self) -> str:
        """Return the reason as text for messages."""
        if self.limit is None:
            return self.kind.value
        size = f"{self.limit:g} s" if self.kind == StopKind.TIME else f"{self.limit / 10**6:,.0f} MB"
        return f"{self.kind.value} of {size}"


LimitCheck = Callable[[], "StopReason | None"]
"""A function that returns the limit that has been reached, or None."""
