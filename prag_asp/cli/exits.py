"""The exit codes of the command."""

from __future__ import annotations

from enum import IntEnum

from prag_asp.errors import LimitReached, NotFound, OutputError, WorkerError


class Exit(IntEnum):
    """An exit code."""

    DONE = 0
    NOT_FOUND = 1
    BAD_INPUT = 2
    LIMIT = 3
    OUTPUT = 4
    WORKERS = 5
    USAGE = 64
    INTERRUPTED = 130
    TERMINATED = 143


MEANINGS = {
    Exit.DONE: "done",
    Exit.NOT_FOUND: "incomplete result: validate found invalid tasks; sample, generate, suite or evaluate found too "
    "few tasks; or explain or verify found a problem",
    Exit.BAD_INPUT: "invalid input: the domain, a file, or the request",
    Exit.LIMIT: "a limit on time or memory was reached",
    Exit.OUTPUT: "the output could not be written (if a pipe was closed, no message is printed)",
    Exit.WORKERS: "physics workers died repeatedly",
    Exit.USAGE: "usage error: an unknown command or option, a missing or an invalid value",
    Exit.INTERRUPTED: "interrupted by Ctrl-C",
    Exit.TERMINATED: "ended by SIGTERM",
}
"""The meaning of each code, for the help."""

OF_ERRORS = {NotFound: Exit.NOT_FOUND, LimitReached: Exit.LIMIT, OutputError: Exit.OUTPUT, WorkerError: Exit.WORKERS}


def exit_of(error: BaseException) -> Exit:
    """Return the exit code for an error of this package; errors that are not in `OF_ERRORS` are errors in the input."""
    return next((code for kind, code in OF_ERRORS.items() if isinstance(error, kind)), Exit.BAD_INPUT)
