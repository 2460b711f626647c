"""The requests of pages: one computes at a time, and a newer request from a window ends the work on its older ones.

Work in another process takes a separate turn, so that the views of a page are answered in the meantime.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Lock, local

from prag_asp.errors import LimitReached
from prag_asp.processes.progress_events import Note
from prag_asp.stop_reason import StopKind, StopReason

WINDOWS = 256
"""The number of windows whose latest requests are remembered."""

POLL = 0.02
"""Seconds between two checks of a waiting request."""

CANCEL = StopReason(StopKind.CANCEL)


@dataclass(frozen=True)
class Doing:
    """What the computing request is doing, in words; `note` says why it will take long, if that is forecast."""

    words: str = ""
    note: str = ""


class Turns:
    """Lets requests take turns. Each window numbers its requests; requests with equal numbers do not end each other."""

    def __init__(self) -> None:
        self._latest: OrderedDict[str, int] = OrderedDict()
        self._registering, self._computing, self._elsewhere = Lock(), Lock(), Lock()
        self._current = local()
        self._closed = False
        self.doing = Doing()

    def close(self) -> None:
        """End the work on all requests."""
        self._closed = True

    def stop(self) -> StopReason | None:
        """Return why the request of this thread should end, or None; this serves as a check for `Limits`."""
        window, number = getattr(self._current, "request", ("", 0))
        return CANCEL if self._closed or self._latest.get(window, number) > number else None

    def tell(self, words: str) -> None:
        """Record the progress of the request that computes."""
        note = str(words) if isinstance(words, Note) else self.doing.note
        self.doing = Doing(self.doing.words if isinstance(words, Note) else str(words), note)

    @contextmanager
    def turn(self, window: str, number: int, *, elsewhere: bool = False) -> Iterator[None]:
        """Wait until no other request computes or, with `elsewhere`, until none has work in another process.

        Raises:
            LimitReached: the window has sent a newer request in the meantime.
        """
        self._current.request = (window, number)
        with self._registering:
            self._latest[window] = max(number, self._latest.get(window, number))
            self._latest.move_to_end(window)
            while len(self._latest) > WINDOWS:
                self._latest.popitem(last=False)
        lock = self._elsewhere if elsewhere else self._computing
        while not lock.acquire(timeout=POLL):
            self._check()
        try:
            self._check()
            if not elsewhere:
                self.doing = Doing()
            yield
        finally:
            lock.release()
            self._current.request = ("", 0)

    def _check(self) -> None:
        if self.stop():
            raise LimitReached("a newer request of the page ended this one", 0, CANCEL)
