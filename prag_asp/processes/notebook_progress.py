"""The progress of long calls in a notebook: a line below the cell, updated while code of this package runs.

A thread inspects the stack of the thread that runs the cell: if a call to this package has taken two seconds, the line
appears, with the last progress event. Calls therefore need no argument, and the line appears even during native code
that reports no events.
"""

from __future__ import annotations

import contextvars
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from html import escape
from importlib import import_module
from threading import Event, Lock, Thread, get_ident
from time import monotonic
from types import FrameType
from typing import Any

from prag_asp.processes.progress_events import Note, hear

PATIENCE, LOOK, GAP = 2.0, 0.25, 1.0
"""Seconds after which a call counts as long, seconds between two checks, and the longest pause in seconds between calls
that count as one call, such as those of an iterator."""

PACKAGE = __name__.partition(".")[0]

Display = Callable[[Mapping[str, str], bool], None]
"""A function that shows a value, given by media type: below the cell or, if the second argument is true, in place of
the previous value."""


class NotebookProgress:
    """The progress line of a cell."""

    def __init__(self, show: Display) -> None:
        self._show = show
        self._words, self._heard = "", 0.0
        self._since: float | None = None
        self._last = 0.0
        self._shown: str | None = None

    def hear(self, words: str, now: float) -> None:
        """Record a progress event at the time `now`, in seconds."""
        if not isinstance(words, Note):
            self._words, self._heard = words.partition("\n")[0], now

    def look(self, inside: bool, now: float) -> None:
        """Update the line at the time `now`, in seconds; `inside` states whether code of this package is running."""
        if inside:
            self._since = now if self._since is None else self._since
            self._last = now
        elif self._since is not None and now - self._last > GAP:
            self._since = None
        if self._since is None:
            self.clear()
        elif inside and now - self._since >= PATIENCE:
            # An event before this call describes an earlier one.
            words = self._words if self._words and self._heard >= self._since - GAP else "working"
            self._update(f"{words} ... {now - self._since:.0f} s")

    def clear(self) -> None:
        """Remove the text of the line."""
        if self._shown:
            self._update("")

    def _update(self, text: str) -> None:
        if text != self._shown:
            page = f'<div style="opacity: 0.7">{escape(text)}</div>' if text else ""
            again, self._shown = self._shown is not None, text
            self._show({"text/plain": text, "text/html": page}, again)


def is_inside(frame: FrameType | None) -> bool:
    """Return whether a stack contains a frame of this package outside this module."""
    while frame is not None:
        name = frame.f_globals.get("__name__", "")
        if (name == PACKAGE or name.startswith(f"{PACKAGE}.")) and name != __name__:
            return True
        frame = frame.f_back
    return False


@dataclass
class CellWatch:
    """A watch on the cells of a notebook, one after the other; `enabled` states whether it shows progress."""

    enabled: bool = True
    _line: NotebookProgress | None = None
    _ended: Event | None = None
    _watching: Thread | None = None

    def __post_init__(self) -> None:
        self._lock = Lock()
        hear(self._on_event)

    def begin(self, *_: object) -> None:
        """Begin to watch the cell that is running in the current thread."""
        self.end()
        if self.enabled:
            self._line, self._ended = NotebookProgress(_ipython_display()), Event()
            # The context determines to which cell the output belongs.
            arguments = (self._watch, self._line, self._ended, get_ident())
            self._watching = Thread(target=contextvars.copy_context().run, args=arguments, daemon=True)
            self._watching.start()

    def end(self, *_: object) -> None:
        """Remove the line when the cell has ended."""
        if self._ended is not None and self._line is not None and self._watching is not None:
            self._ended.set()
            self._watching.join()
            self._line.clear()
        self._line = self._ended = self._watching = None

    def _watch(self, line: NotebookProgress, ended: Event, thread: int) -> None:
        while not ended.wait(LOOK):
            inside = is_inside(sys._current_frames().get(thread))
            with self._lock:
                line.look(inside, monotonic())

    def _on_event(self, words: str) -> None:
        if self._line is not None:
            with self._lock:
                self._line.hear(words, monotonic())


_watch: CellWatch | None = None


def watch_notebook() -> None:
    """Show the progress of long calls from now on, if this process is the kernel of a notebook."""
    global _watch  # noqa: PLW0603  a process has one notebook
    shell = import_module("IPython").get_ipython()  # only a kernel has it
    if _watch is None and shell is not None and hasattr(shell, "kernel"):
        _watch = CellWatch()
        shell.events.register("pre_run_cell", _watch.begin)
        shell.events.register("post_run_cell", _watch.end)
        _watch.begin()  # the cell that imports this package


def show_progress(enabled: bool = True) -> None:
    """Switch the progress line of notebooks on or off; it is on by default, and has no effect elsewhere.

    If a call to this package takes longer than two seconds, a line below the cell shows the current activity and the
    time since the call began.
    """
    if _watch is not None:
        _watch.enabled = enabled
        if not enabled:
            _watch.end()


def _ipython_display() -> Display:
    """Return a function that shows a value below the current cell."""
    handle: Any = import_module("IPython.display").DisplayHandle()

    def show(value: Mapping[str, str], again: bool) -> None:
        (handle.update if again else handle.display)(dict(value), raw=True)

    return show
