"""Turns for the requests of pages: one computes at a time, and a newer request ends older ones of the same window.

The work on a request also ends when its client closes the connection, as a browser does when a window is closed. Work
in another process takes a separate turn, so that the views of a page are answered in the meantime.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Lock, local
from time import monotonic

from prag_asp.errors import LimitReached
from prag_asp.processes.progress_events import Note
from prag_asp.stop_reason import StopKind, StopReason

WINDOWS = 256
"""The number of windows whose latest requests are remembered."""

POLL = 0.02
"""The time between two checks of a waiting request, in seconds."""

CANCEL = StopReason(StopKind.CANCEL)


@dataclass(frozen=True)
class Doing:
    """The progress of the request that computes, in words; if it is expected to take long, `note` says why."""

    words: str = ""
    note: str = ""


@dataclass
class Request:
    """A request of a window; `gone` returns whether the client closed the connection, and is called every `POLL` s."""

    window: str = ""
    number: int = 0
    gone: Callable[[], bool] = lambda: False
    _next_look: float = 0.0
    _was_gone: bool = False

    def has_gone(self) -> bool:
        """Return whether the client had closed the connection at the latest check."""
        now = monotonic()
        if not self._was_gone and now >= self._next_look:
            self._was_gone, self._next_look = self.gone(), now + POLL
        return self._was_gone


class Turns:
    """The turns of requests. Each window numbers its requests; requests with equal numbers do not end each other."""

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
        """Return the reason why the request of this thread should end, or None; `Limits` can use this as a check."""
        request: Request | None = getattr(self._current, "request", None)
        if self._closed:
            return CANCEL
        if request is None:
            return None
        outdated = self._latest.get(request.window, request.number) > request.number
        return CANCEL if outdated or request.has_gone() else None

    def tell(self, words: str) -> None:
        """Record the progress of the request that computes."""
        note = str(words) if isinstance(words, Note) else self.doing.note
        self.doing = Doing(self.doing.words if isinstance(words, Note) else str(words), note)

    @contextmanager
    def turn(
        self, window: str, number: int, *, elsewhere: bool = False, gone: Callable[[], bool] = lambda: False
    ) -> Iterator[None]:
        """Wait until no other request computes or, with `elsewhere`, until no other one works in another process.

        `gone` returns whether the client has closed the connection.

        Raises:
            LimitReached: the window has sent a newer request in the meantime, or its connection is closed.
        """
        self._current.request = Request(window, number, gone)
        with self._registering:
            self._latest[window] = max(number, self._latest.get(window, number))
            self._latest.move_to_end(window)
            while len(self._latest) > WINDOWS:
                self._latest.popitem(last=False)
        lock = self._elsewhere if elsewhere else self._computing
        try:
            while not lock.acquire(timeout=POLL):
                self._check()
        except LimitReached:
            self._current.request = None
            raise
        try:
            self._check()
            if not elsewhere:
                self.doing = Doing()
            yield
        finally:
            lock.release()
            self._current.request = None

    def _check(self) -> None:
        if self.stop():
            raise LimitReached("a newer request of the page, or the end of its window, ended this one", 0, CANCEL)
