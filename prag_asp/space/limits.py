"""Limits on memory and time, and whether results are cached for the next run."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import isinf
from time import monotonic
from typing import TypeVar

from prag_asp.errors import LimitReached, QueryError
from prag_asp.processes.machine import memory_in_use
from prag_asp.stop_reason import LimitCheck, StopKind, StopReason

UNITS = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "t": 10**12}
BINARY = {"ki": 2**10, "mi": 2**20, "gi": 2**30, "ti": 2**40}
DURATIONS = {"": 1, "s": 1, "m": 60, "min": 60, "h": 3600}
QUANTITY = r"(?P<number>\d+(\.\d+)?)\s*(?P<unit>[a-z]*)"
LEAST_CLOSING, MOST_CLOSING = 0.1, 5.0
"""Bounds, in seconds, on the extra time for counting partial results after a time limit, which is 5 % of the limit."""

Item = TypeVar("Item")


@dataclass(frozen=True)
class Limits:
    """The limits of a query: memory of the whole process in bytes, and seconds; None means unlimited.

    They are checked between steps in Python; clingo's grounder, for example, does not check them. With `cached`,
    expensive results are cached for the next run. `since` is the common starting time of all queries on the monotonic
    clock; if it is None, each query has its own. `stop` may return another reason to end a query.
    """

    memory_bytes: int | None = None
    seconds: float | None = None
    cached: bool = True
    since: float | None = None
    stop: LimitCheck | None = None

    def begin(self) -> LimitClock:
        """Start the clock for one query."""
        return LimitClock(self, monotonic() if self.since is None else self.since)


UNLIMITED = Limits()


@dataclass(frozen=True)
class LimitClock:
    """The limits of a query and its start on the monotonic clock; `closing` is extra time at the end, in seconds."""

    limits: Limits
    begun: float
    closing: float = 0.0

    def reached_limit(self, more_bytes: int = 0) -> StopReason | None:
        """Return the limit that is reached, or None; `more_bytes` are about to be allocated."""
        seconds, memory = self.limits.seconds, self.limits.memory_bytes
        if seconds is not None and monotonic() - self.begun > seconds + self.closing:
            return StopReason(StopKind.TIME, seconds)
        if memory is not None and memory_in_use() + more_bytes > memory:
            return StopReason(StopKind.MEMORY, memory)
        return self.limits.stop() if self.limits.stop else None

    def left(self) -> float | None:
        """Return the remaining seconds, or None if there is no time limit."""
        seconds = self.limits.seconds
        return None if seconds is None else max(self.begun + seconds - monotonic(), 0.0)

    def to_close(self) -> LimitClock:
        """Return the clock for counting partial results at a limit: it allows the remaining time, and a little more.

        It has no memory limit because counting needs little memory.
        """
        seconds = self.limits.seconds
        if self.limits.stop and self.limits.stop():
            return LimitClock(Limits(seconds=0.0), self.begun)
        if seconds is None:
            return LimitClock(UNLIMITED, self.begun)
        extra = min(max(seconds / 20, LEAST_CLOSING), MOST_CLOSING)
        late = max(monotonic() - self.begun - seconds, 0)
        return LimitClock(Limits(seconds=seconds), self.begun, late + extra)

    def to_report(self) -> LimitClock:
        """Return the clock that `to_close` returns, or one with `MOST_CLOSING` seconds if only memory is limited."""
        return Limits(seconds=MOST_CLOSING).begin() if self.limits.seconds is None else self.to_close()


def within(limits: Limits, words: Iterator[Item], level: str, length: int) -> Iterator[Item]:
    """Yield words until a limit is reached.

    Raises:
        LimitReached: a limit is reached; the error gives the number of words yielded so far.
    """
    clock = limits.begin()
    for number, word in enumerate(words):
        reason = clock.reached_limit()
        if reason:
            raise limit_error(reason, number, level, length)
        yield word


def limit_error(reason: StopReason, found: int, level: str, length: int, states: int = 0) -> LimitReached:
    """Return the error for a limit that ended a count after `found` words.

    The message gives the number of explored states, if there are any.
    """
    explored = f" with {states:,} states explored" if states else ""
    option = "time" if reason.kind == StopKind.TIME else "memory"
    return LimitReached(
        f"{reason.prose()} was reached{explored}: there are at least {found} {level}s of length {length}; "
        f"allow more (--{option}), or ask for shorter ones",
        found,
        reason,
    )


def parse_memory(text: str) -> int:
    """Return a number of bytes given as a text such as 500MB, 4GB, 2GiB or a plain number.

    Raises:
        QueryError: the text is not such a quantity.
    """
    number, unit = _quantity(text)
    factor = {**UNITS, **BINARY}.get(unit.removesuffix("b"))
    if number is None or factor is None or isinf(number * factor):
        raise QueryError(f"--memory {text}: write a number of bytes above 0, such as 500MB, 4GB or 2GiB")
    return int(number * factor)


def parse_time(text: str) -> float:
    """Return a number of seconds given as a text such as 60, 60s, 1.5m or 2h.

    Raises:
        QueryError: the text is not such a quantity.
    """
    number, unit = _quantity(text)
    factor = DURATIONS.get(unit)
    if number is None or factor is None or isinf(number * factor):
        raise QueryError(f"--time {text}: write a time above 0, such as 60s, 5m or 2h")
    return number * factor


def _quantity(text: str) -> tuple[float | None, str]:
    match = re.fullmatch(QUANTITY, text.strip().lower())
    number = float(match["number"]) if match else 0.0
    return (number, match["unit"]) if match and number else (None, "")
