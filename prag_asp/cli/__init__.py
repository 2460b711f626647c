"""The command ``prag-asp``."""

from __future__ import annotations

import gc
import os
import signal
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prag_asp.cli.registry import Commands

    cli: Commands

__all__ = ["cli", "main"]

GARBAGE = (100_000, 50, 100)
"""Thresholds with which Python's garbage collector runs rarely, because ground programs consist of many small values
without cycles.
"""


def main() -> None:
    """Run the command, and exit with its code."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # without a traceback until the command handles signals
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices here are small, and each thread takes memory
    gc.set_threshold(*GARBAGE)  # set before the imports, which take a third of the time of a short command
    code = 1
    try:
        from prag_asp.cli.exit_control import reopen_closed_streams
        from prag_asp.cli.supervision import supervise

        reopen_closed_streams()
        supervise()
        from prag_asp.cli.registry import cli

        code = cli.main()
    except BaseException as error:
        from prag_asp.cli.exit_control import ERRORS, report_end

        if not isinstance(error, ERRORS):
            raise
        code = report_end(error)
    finally:
        from prag_asp.cli.exit_control import finish

        finish(code)
        gc.freeze()  # the collection at exit would visit each object, although the system frees all memory at once
    sys.exit(code)


def __getattr__(name: str) -> Commands:
    if name == "cli":
        from prag_asp.cli.registry import cli

        return cli
    raise AttributeError(f"module 'prag_asp.cli' has no attribute {name!r}")
