"""Ctrl-C and SIGTERM end the command with one line, at whatever moment of its life they come."""

from __future__ import annotations

import subprocess
import sys

import pytest

COMMAND = """
import signal, sys, time, click
from prag_asp.cli.terminal import Command, whole_lines

class Freed:
    def __del__(self):
        signal.raise_signal(signal.{signal})

@click.group(cls=Command)
def cli():
    pass

@cli.command()
def work():
    with whole_lines():
        {work}
        time.sleep(600)

sys.exit(cli.main(["work"]))
"""
WRAPPED = "raise RuntimeError('Error calling __set_name__') from KeyboardInterrupt()"
INTERRUPTED, TERMINATED = (130, "interrupted"), (143, "terminated")


def ends(code: str, *arguments: str) -> tuple[int, str]:
    """Return with which code a program ends and what it says, without the empty line after a terminal's ^C."""
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=300, check=False
    )
    return done.returncode, done.stderr.strip()


@pytest.mark.parametrize(
    ("signal", "work", "end"),
    [
        ("SIGINT", "Freed()", INTERRUPTED),
        ("SIGTERM", "Freed()", TERMINATED),
        ("SIGINT", WRAPPED, INTERRUPTED),
    ],
)
def test_what_python_would_drop_or_wrap_is_heard(signal: str, work: str, end: tuple[int, str]) -> None:
    assert ends(COMMAND.format(signal=signal, work=work)) == end


def test_what_else_goes_wrong_while_a_value_is_freed_is_told_as_ever() -> None:
    code = COMMAND.format(signal="SIGINT", work="Freed.__del__ = lambda value: 1 / 0; Freed(); raise KeyboardInterrupt")
    status, told = ends(code)
    assert status == 130 and "ZeroDivisionError" in told and told.endswith("interrupted")


def test_an_interruption_while_the_command_is_loaded_is_one_line() -> None:
    code = """
import signal, sys
class Finder:
    def find_spec(name, path=None, target=None):
        if name == "prag_asp.cli.registry":
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Finder)
from prag_asp.cli import main
main()
"""
    assert ends(code, "domains") == INTERRUPTED


def test_an_interruption_when_all_is_told_is_not_heard() -> None:
    code = """
import atexit, signal
from prag_asp.cli import main
atexit.register(signal.raise_signal, signal.SIGINT)
main()
"""
    assert ends(code, "--help") == (0, "")
