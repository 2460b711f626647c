"""The errors of prag_asp, all of them values a program can catch.

PragError
├── DomainError        a domain's files are wrong: every message is ``file:line: what; what to do``
├── QueryError         a question does not fit the domain: unknown action, negative length, bad weight
├── EngineError        an engine cannot express a domain, and says why
│   └── LimitReached   a limit on memory or time ended the work; has what was found until then
├── SceneError         the scene or a body of it cannot be built
├── MissingError       a package that is needed is not installed; the message says how to install it
│   ├── PhysicsMissingError
│   └── PicturesMissingError
├── NotFound           less was found than was asked for
├── WorkerError        the processes that validate tasks died again and again, or could not be started
└── OutputError        a result could not be written
"""

from __future__ import annotations


class PragError(Exception):
    """Something that the user can mend; the message says what, where and how."""


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


class NotFound(PragError):
    """Less was found than was asked for."""


class WorkerError(PragError):
    """The processes that validate tasks died again and again, or could not be started."""


class OutputError(PragError):
    """A result could not be written."""
