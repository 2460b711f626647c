"""The command ``prag-asp``, run in this process or in one of its own.

In this process it starts at once; what a fresh process alone shows (imports, signals, pipes, workers) is run apart.
"""

from __future__ import annotations

import io
import os
import subprocess
import sys
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.cli import cli

if TYPE_CHECKING:
    from collections.abc import Iterator

PRAG = [sys.executable, "-c", "from prag_asp.cli import main; main()"]


class Done(NamedTuple):
    """What a command returned and said."""

    returncode: int
    stdout: str
    stderr: str


def run(*arguments: str, cwd: Path | None = None) -> Done:
    """Run a command in this process."""
    out, err = io.StringIO(), io.StringIO()
    with _left_as_it_was(cwd), redirect_stdout(out), redirect_stderr(err):
        code = cli.main(args=list(arguments), prog_name="prag-asp")
    return Done(code, out.getvalue(), err.getvalue())


def run_apart(*arguments: str, cwd: Path | None = None) -> Done:
    """Run a command in a process of its own."""
    done = subprocess.run([*PRAG, *arguments], capture_output=True, text=True, cwd=cwd, timeout=300, check=False)
    return Done(done.returncode, done.stdout, done.stderr)


def ok(*arguments: str, cwd: Path | None = None) -> str:
    """Run a command in this process, which succeeds, and return what it prints."""
    return _printed(run(*arguments, cwd=cwd))


def ok_apart(*arguments: str, cwd: Path | None = None) -> str:
    """Run a command in a process of its own, which succeeds, and return what it prints."""
    return _printed(run_apart(*arguments, cwd=cwd))


def _printed(done: Done) -> str:
    assert done.returncode == 0, done.stderr
    return done.stdout


@contextmanager
def _left_as_it_was(cwd: Path | None) -> Iterator[None]:
    """Undo what a command sets for its process: the folder, and the digits of an integer."""
    folder, digits = Path.cwd(), getattr(sys, "get_int_max_str_digits", int)()
    os.chdir(cwd or folder)
    try:
        yield
    finally:
        os.chdir(folder)
        if hasattr(sys, "set_int_max_str_digits"):
            sys.set_int_max_str_digits(digits)
