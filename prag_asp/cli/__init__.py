"""The command ``prag-asp``."""

from __future__ import annotations

import os
import signal
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prag_asp.cli.terminal import Command

    cli: Command

__all__ = ["cli", "main"]


def main() -> None:
    """Run the command and exit; while it is being loaded, an interruption ends it as quietly as later."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # our matrices are small, and each thread takes memory
    try:
        from prag_asp.cli.supervision import supervise

        supervise()
        code = _command().main()
    except KeyboardInterrupt as asked:
        from prag_asp.cli.exit_control import Terminated
        from prag_asp.cli.exits import Exit

        line, code = (
            ("terminated", Exit.TERMINATED) if isinstance(asked, Terminated) else ("interrupted", Exit.INTERRUPTED)
        )
        sys.stderr.write(f"{line}\n")
    except Exception as error:
        from prag_asp.cli.exit_control import memory_refused, out_of_memory, write_line
        from prag_asp.cli.exits import Exit

        if not memory_refused(error):
            raise
        write_line(out_of_memory())
        code = Exit.LIMIT
    finally:  # All is told, and Python would tell of what it is torn from.
        _hear_nothing()
    sys.exit(code)


def _hear_nothing() -> None:
    """Ignore signals from here on; a command that has told all tells nothing of memory that is refused now."""
    try:
        from prag_asp.cli.exit_control import deafen, done, ignore

        done()
        ignore(signal.SIGINT)
        deafen()
    except (MemoryError, SystemError, ImportError):
        return


def _command() -> Command:
    """Load the command."""
    from prag_asp.cli.registry import cli

    return cli


def __getattr__(name: str) -> Command:
    if name == "cli":
        return _command()
    raise AttributeError(f"module 'prag_asp.cli' has no attribute {name!r}")
