"""The errors of prag_asp, all of them values a program can catch.

PragError
├── DomainError        a domain's files are wrong: every message is ``file:line: what; what to do``
├── QueryError         a question does not fit the domain: unknown action, negative length, bad weight
├── EngineError        an engine cannot express a domain, and says why
│   └── LimitReached   a limit on memory or time ended the work; has the reason and a lower bound
├── SceneError         the scene or a body of it cannot be built
├── MissingError       a package that is needed is not installed; the message says how to install it
│   ├── PhysicsMissingError
│   ├── PicturesMissingError
│   ├── DatasetsMissingError
│   ├── PddlMissingError
│   └── RayMissingError
├── NotFound           fewer results were found than requested
├── WorkerError        the processes that validate tasks died again and again, or could not be started
└── OutputError        a result could not be written
"""

from __future__ import annotations

from prag_asp.stop_reason import StopReason

LONGEST = 500
"""Characters of a line of a message, whatever it quotes."""

CUT = " ... "
HEAD = 300
"""Characters that stay at the beginning of a longer one: where it is and what is wrong; its end says what to do."""


def plain(text: str) -> str:
    """Return a text as one line without control sequences.

    Characters that do not print, such as line ends and signs that change the direction of text, are escaped as in a
    string of Python.
    """
    if text.isprintable():
        return text
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in text)


def one_line(text: str) -> str:
    """Return a text as one line of a message: `plain`, and without its middle if it is too long."""
    line = plain(text)
    return line if len(line) <= LONGEST else f"{line[:HEAD]}{CUT}{line[HEAD + len(CUT) - LONGEST :]}"


class PragError(Exception):
    """Something that the user can fix; the message says what, where and how.

    Each argument is a separate problem, and becomes a line of the message.
    """

    @property
    def lines(self) -> tuple[str, ...]:
        """The lines of the message, each safe for a terminal, whatever it quotes."""
        return tuple(one_line(str(problem)) for problem in self.args)

    def __str__(self) -> str:
        return "\n".join(self.lines)


class DomainError(PragError):
    """The files of a domain are wrong; one line of the message for each problem found."""


class QueryError(PragError):
    """A question does not fit the domain."""


class EngineError(PragError):
    """An engine cannot express the domain: `what` is wrong, at a `place` (``file:line``) where it is known."""

    def __init__(self, what: str, *, place: str = "", remedy: str = "") -> None:
        super().__init__(f"{f'{place}: ' if place else ''}{what}{f'; {remedy}' if remedy else ''}")
        self.what = what
        self.place = place
        self.remedy = remedy


class LimitReached(EngineError):
    """A limit was reached for a `reason`; there are at least `at_least` of what was counted."""

    def __init__(self, message: str, at_least: int, reason: StopReason) -> None:
        super().__init__(message)
        self.at_least = at_least
        self.reason = reason

    def __reduce__(self) -> tuple[type[LimitReached], tuple[str, int, StopReason]]:
        return type(self), (self.what, self.at_least, self.reason)


class SceneError(PragError):
    """A scene cannot be built from its description."""


class MissingError(PragError):
    """A package that is needed is not installed."""


class PhysicsMissingError(MissingError):
    """Physics needs PyBullet, and the panda also frankik."""


class PicturesMissingError(MissingError):
    """Pictures need Pillow."""


class DatasetsMissingError(MissingError):
    """Datasets need pyarrow, and other dataset formats further packages."""


class LearningMissingError(MissingError):
    """Reinforcement learning needs Gymnasium."""


class RayMissingError(MissingError):
    """Work on several machines needs Ray."""


class PddlMissingError(MissingError):
    """Files of PDDL need the package pddl to be read."""


class NotFound(PragError):
    """Fewer results were found than requested."""


class WorkerError(PragError):
    """The processes that validate tasks died again and again, or could not be started."""


class OutputError(PragError):
    """A result could not be written."""
