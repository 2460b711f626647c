"""The errors of prag_asp, which a program can catch.

PragError
├── DomainError        the files of a domain are wrong: every message is ``file:line: what is wrong; what to do``
├── QueryError         a request does not fit the domain: unknown action, negative length, invalid weight
├── EngineError        an engine cannot handle a domain; the message says why
│   └── LimitReached   a limit on memory or time was reached; holds the count reached by then
├── SceneError         a scene or a body cannot be built
├── MissingError       a required package is not installed; the message says how to install it
│   ├── PhysicsMissingError
│   ├── PicturesMissingError
│   ├── DatasetsMissingError
│   ├── LearningMissingError
│   ├── RayMissingError
│   └── SimilarityMissingError
├── NotFound           less was found than requested
├── WorkerError        processes that validate tasks died repeatedly, or could not be started
└── OutputError        a result could not be written
"""

from __future__ import annotations

from prag_asp.stop_reason import StopReason

LONGEST = 500
"""The largest number of characters in a line of a message."""

CUT = " ... "
HEAD = 300
"""The number of characters kept from the beginning of a longer line (location and problem); its end (what to do) is
also kept.
"""


def plain(text: str) -> str:
    """Return `text` as one line without control characters.

    Unprintable characters, including line ends and text direction marks, are escaped as in Python.
    """
    if text.isprintable():
        return text
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in text)


def one_line(text: str) -> str:
    """Return `text` as one line of a message: without control characters, and without its middle if it is too long."""
    line = plain(text)
    return line if len(line) <= LONGEST else f"{line[:HEAD]}{CUT}{line[HEAD + len(CUT) - LONGEST :]}"


class PragError(Exception):
    """A mistake that the user can correct; the message says what is wrong, where, and how to correct it.

    Each argument is a separate problem, and becomes a line of the message.
    """

    @property
    def lines(self) -> tuple[str, ...]:
        """The lines of the message, shortened and without control characters."""
        return tuple(one_line(str(problem)) for problem in self.args)

    def __str__(self) -> str:
        return "\n".join(self.lines)


class DomainError(PragError):
    """The files of a domain are wrong; the message contains one line for each problem."""


class QueryError(PragError):
    """A request does not fit the domain."""


class EngineError(PragError):
    """An engine cannot express the domain: `what` states the problem; `place` is ``file:line``, if known."""

    def __init__(self, what: str, *, place: str = "", remedy: str = "") -> None:
        super().__init__(f"{f'{place}: ' if place else ''}{what}{f'; {remedy}' if remedy else ''}")
        self.what = what
        self.place = place
        self.remedy = remedy


class LimitReached(EngineError):
    """A limit was reached: `reason` says which, and the exact count is at least `at_least`."""

    def __init__(self, message: str, at_least: int, reason: StopReason) -> None:
        super().__init__(message)
        self.at_least = at_least
        self.reason = reason

    def __reduce__(self) -> tuple[type[LimitReached], tuple[str, int, StopReason]]:
        return type(self), (self.what, self.at_least, self.reason)


class SceneError(PragError):
    """A scene cannot be built from its description."""


class MissingError(PragError):
    """A required package is not installed."""


class PhysicsMissingError(MissingError):
    """Physics needs PyBullet; for the panda robot, it also needs frankik."""


class PicturesMissingError(MissingError):
    """Pictures need Pillow."""


class DatasetsMissingError(MissingError):
    """Datasets need pyarrow; their export formats need further packages."""


class LearningMissingError(MissingError):
    """Reinforcement learning needs Gymnasium."""


class RayMissingError(MissingError):
    """Running on a cluster needs Ray."""


class SimilarityMissingError(MissingError):
    """String metrics need rapidfuzz."""


class NotFound(PragError):
    """Less was found than requested."""


class WorkerError(PragError):
    """Processes that validate tasks died repeatedly, or could not be started."""


class OutputError(PragError):
    """A result could not be written."""
