"""How much memory and time a question may take, and whether answers are kept for the next run."""

from __future__ import annotations

import os
import re
import resource
import sys
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

from prag_asp.errors import LimitReached, QueryError

UNITS = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "t": 10**12}
BINARY = {"ki": 2**10, "mi": 2**20, "gi": 2**30, "ti": 2**40}
DURATIONS = {"": 1, "s": 1, "m": 60, "min": 60, "h": 3600}
QUANTITY = r"(?P<number>\d+(\.\d+)?)\s*(?P<unit>[a-z]*)"


@dataclass(frozen=True)
class Limits:
    """What a question may take: memory of the whole process in bytes, seconds; None is without limit.

    `cached` says whether what took long to compute is kept in the cache folder for the next run.
    """

    memory_bytes: int | None = None
    seconds: float | None = None
    cached: bool = True

    def begin(self) -> Budget:
        """Start the clock for one question."""
        return Budget(self, monotonic())


UNLIMITED = Limits()


@dataclass(frozen=True)
class Budget:
    """The limits of a question that was begun at a time of the monotonic clock."""

    limits: Limits
    begun: float

    def spent(self, more_bytes: int = 0) -> str | None:
        """Return which limit is reached, in words, or None; `more_bytes` are about to be taken."""
        seconds, memory = self.limits.seconds, self.limits.memory_bytes
        if seconds is not None and monotonic() - self.begun > seconds:
            return f"the time limit of {seconds:g} s"
        if memory is not None and memory_in_use() + more_bytes > memory:
            return f"the memory limit of {memory / 10**6:,.0f} MB"
        return None


def stopped_at(limit: str, found: int, level: str, length: int) -> LimitReached:
    """Return the error for a limit, given in words, that ended a count when `found` words were found."""
    return LimitReached(
        f"{limit} was reached: there are at least {found} {level}s of length {length}; allow more, or ask for "
        "shorter ones",
        found,
    )


def cache_folder() -> Path | None:
    """Return the folder of the cache: ``PRAG_ASP_CACHE``, or one in the user's; None where that variable is empty."""
    own = os.environ.get("PRAG_ASP_CACHE")
    if own is not None:
        return Path(own) if own else None
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "prag_asp"
    except RuntimeError:  # there is no home
        return None


def memory_in_use() -> int:
    """Return the memory of this process in bytes: what is resident now, or the most that ever was."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak if sys.platform == "darwin" else peak * 1024
    return pages * resource.getpagesize()


def parse_memory(text: str) -> int:
    """Return a number of bytes given as 500MB, 4GB, 2GiB or a plain number.

    Raises:
        QueryError: it is none.
    """
    number, unit = _quantity(text)
    factor = {**UNITS, **BINARY}.get(unit.removesuffix("b"))
    if number is None or factor is None:
        raise QueryError(f"--memory {text}: write a number of bytes above 0, such as 500MB, 4GB or 2GiB")
    return int(number * factor)


def parse_time(text: str) -> float:
    """Return a number of seconds given as 60, 60s, 1.5m or 2h.

    Raises:
        QueryError: it is none.
    """
    number, unit = _quantity(text)
    factor = DURATIONS.get(unit)
    if number is None or factor is None:
        raise QueryError(f"--time {text}: write a time above 0, such as 60s, 5m or 2h")
    return number * factor


def _quantity(text: str) -> tuple[float | None, str]:
    found = re.fullmatch(QUANTITY, text.strip().lower())
    number = float(found["number"]) if found else 0.0
    return (number, found["unit"]) if found and number else (None, "")
