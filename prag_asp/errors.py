"""The errors of prag_asp, all of them values a program can catch.

PragError
├── DomainError        a domain's files are wrong: every message is ``file:line: what; what to do``
├── QueryError         a question does not fit the domain: unknown action, negative length, bad weight
├── EngineError        an engine cannot express a domain, and says why
│   └── LimitReached   a limit on memory or time ended the work; has what was found until then
├── SceneError         the scene or a body of it cannot be built
├── MissingError       a package that is needed is not installed; the message says how to install it
│   ├── PhysicsMissingError
│   ├── PicturesMissingError
│   ├── DatasetsMissingError
│   ├── LearningMissingError
│   ├── PddlMissingError
│   └── RayMissingError
├── NotFound           less was found than was asked for
├── WorkerError        the processes that validate tasks died again and again, or could not be started
└── OutputError        a result could not be written
"""

from __future__ import annotations

LONGEST = 500
"""Characters of a line of a message, whatever it quotes."""

CUT = " ... "
HEAD = 300
"""Characters that stay at the beginning of a longer one: where it is and what is wrong; its end says what to do."""


def plain(text: str) -> str:
    """Return a text as one line that a terminal prints and does not obey.

    What does not print, line ends and signs that turn what is around them included, is written as in a string of
    Python.
    """
    if text.isprintable():
        return text
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in text)


def one_line(text: str) -> str:
    """Return a text as one line of a message: `plain`, and its middle left out where it is too long."""
    line = plain(text)
    return line if len(line) <= LONGEST else f"{line[:HEAD]}{CUT}{line[HEAD + len(CUT) - LONGEST :]}"


class PragError(Exception):
    """Something that the user can mend; the message says what, where and how.

    Each argument is a problem of its own, and becomes a line of the message.
    """

    @property
    def lines(self) -> tuple[str, ...]:
        """The lines of the message: each is fit for a terminal, whatever it quotes."""
        return tuple(one_line(str(problem)) for problem in self.args)

    def __str__(self) -> str:
        return "\n".join(self.lines)


class DomainError(PragError):
    """The files of a domain are wrong; one line of the message for each problem found."""


class QueryError(PragError):
    """A question does not fit the domain that it is asked of."""


class EngineError(PragError):
    """An engine cannot express the domain."""


class LimitReached(EngineError):
    """A limit on memory or time was reached; there are at least `at_least` of what was counted."""

    def __init__(self, message: str, at_least: int) -> None:
        super().__init__(message)
        self.at_least = at_least


class SceneError(PragError):
    """A scene cannot be built from its description."""


class MissingError(PragError):
    """A package that is needed is not installed."""


class PhysicsMissingError(MissingError):
    """Physics needs PyBullet, and the panda also frankik."""


class PicturesMissingError(MissingError):
    """Pictures need Pillow."""


class DatasetsMissingError(MissingError):
    """Data sets need pyarrow, and their other forms some more."""


class LearningMissingError(MissingError):
    """Reinforcement learning needs Gymnasium."""


class RayMissingError(MissingError):
    """Work on several machines needs Ray."""


class PddlMissingError(MissingError):
    """Files of PDDL need the package pddl to be read."""


class NotFound(PragError):
    """Less was found than was asked for."""


class WorkerError(PragError):
    """The processes that validate tasks died again and again, or could not be started."""


class OutputError(PragError):
    """A result could not be written."""
