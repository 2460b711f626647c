"""Progress events: the current stage of a computation, for messages about limits and for progress bars."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from time import monotonic
from typing import TypeVar

Item = TypeVar("Item")

Listener = Callable[[str], None]


class Note(str):
    """A message to the user that is shown even if progress is not, for example without a terminal."""

    __slots__ = ()


OFTEN = 0.5
"""Seconds between two progress reports of a loop."""

_listeners: list[Listener] = []
_now = ""


def stage(words: str) -> None:
    """Report that a stage begins; `words` can follow ``while``, as in "grounding tabletop"."""
    global _now  # noqa: PLW0603  a process does one thing at a time
    _now = words
    _publish(words)


def so_far(words: str) -> None:
    """Report the progress of the current stage."""
    _publish(f"{_now} ({words})" if _now else words)


def report_progress(words: str, done: float, total: float | None) -> None:
    """Report an activity and how much of it is done; this is the default of parameters named `progress`."""
    count = "" if total is None else f", {done:,.0f} of {total:,.0f}"
    so_far(f"{words}{count}")


def counted(items: Sequence[Item], what: str) -> Iterator[Item]:
    """Yield items, and report every half second how many of them are done: ``3,000 of 10,000 steps``."""
    last = monotonic()
    for number, item in enumerate(items):
        yield item
        now = monotonic()
        if now - last > OFTEN:
            last = now
            so_far(f"{number + 1:,} of {len(items):,} {what}")


def note(words: str) -> None:
    """Report a message to the user; the stage remains the same."""
    _publish(Note(words))


def hear(listener: Listener) -> None:
    """Call a function with every event from now on."""
    _listeners.append(listener)


def _publish(words: str) -> None:
    for listener in _listeners:
        listener(words)
