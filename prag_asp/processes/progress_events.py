"""What the program is just doing: told by those who do it, heard by who says where a limit has struck."""

from __future__ import annotations

from collections.abc import Callable

Listener = Callable[[str], None]


class Note(str):
    """Words of progress that are to be read whatever else is told, also where no terminal shows it."""

    __slots__ = ()


_listeners: list[Listener] = []
_now = ""


def stage(words: str) -> None:
    """Say what is done from now on, in words that go on ``while``: "grounding tabletop"."""
    global _now  # noqa: PLW0603  a process does one thing at a time
    _now = words
    _tell(words)


def so_far(words: str) -> None:
    """Say how far the stage is."""
    _tell(f"{_now} ({words})" if _now else words)


def note(words: str) -> None:
    """Say what is to be read, and leaves the stage what it is."""
    _tell(Note(words))


def hear(listener: Listener) -> None:
    """Have a function hear what is done from now on."""
    _listeners.append(listener)


def _tell(words: str) -> None:
    for listener in _listeners:
        listener(words)
