"""A terminal shows what a command does, and what it prints goes where it should."""

from __future__ import annotations

import io
import sys
import time
from collections.abc import Callable

import pytest

from prag_asp.cli import terminal
from prag_asp.cli.line_output import writer
from prag_asp.processes.progress_events import note, stage


class Screen(io.StringIO):
    """A terminal that keeps what is written to it."""

    def isatty(self) -> bool:
        return True


def terminal_of(monkeypatch: pytest.MonkeyPatch) -> Screen:
    """Return a terminal as stderr, on which progress appears soon."""
    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr(terminal, "PATIENCE", 0.02)
    monkeypatch.setattr(terminal, "WATCH", 0.01)
    for name, value in {"COLUMNS": "100", "TERM": "xterm"}.items():
        monkeypatch.setenv(name, value)
    return screen


def eventually(holds: Callable[[], bool]) -> bool:
    until = time.monotonic() + 60
    while not holds() and time.monotonic() < until:
        time.sleep(0.01)
    return holds()


def test_a_stage_that_reports_nothing_is_shown_after_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = terminal_of(monkeypatch)
    with terminal.shown_progress(), terminal.progress():
        stage("grounding [this]")
        assert eventually(lambda: "grounding [this]" in screen.getvalue())
    shown = screen.getvalue()
    stage("after the end")
    time.sleep(0.05)
    assert screen.getvalue() == shown


def test_a_log_gets_a_line_of_progress_from_time_to_time(monkeypatch: pytest.MonkeyPatch) -> None:
    log = io.StringIO()
    monkeypatch.setattr(sys, "stderr", log)
    monkeypatch.setattr(terminal, "LOG_EVERY", 0.02)
    monkeypatch.setattr(terminal, "WATCH", 0.01)
    with terminal.progress() as tell:
        tell("exploring", 3, 10)
        assert eventually(lambda: log.getvalue().count("... exploring (3 of 10)\n") >= 2)
        terminal.say("a result")
        stage("counting")
        assert eventually(lambda: "... counting" in log.getvalue())


def test_lines_go_to_stdout_while_progress_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = terminal_of(monkeypatch)
    stdout = io.StringIO()
    monkeypatch.setattr(sys, "stdout", stdout)
    with terminal.progress() as tell:
        tell("exploring")
        assert eventually(lambda: "exploring" in screen.getvalue())
        with writer(None) as out:
            out.write("a " * 200)
        terminal.say("b")
    assert stdout.getvalue() == f"{'a ' * 200}\nb\n"
    assert "a a" not in screen.getvalue()


def test_a_line_on_the_terminal_replaces_progress_until_it_is_due_again(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = terminal_of(monkeypatch)
    monkeypatch.setattr(sys, "stdout", screen)
    with terminal.progress() as tell, writer(None) as out:
        tell("exploring", 3, 10)
        assert eventually(lambda: "exploring" in screen.getvalue())
        out.write("a line")
        note("a note")
        assert "\x1b[2Ka line\na note\n" in screen.getvalue()
        before = len(screen.getvalue())
        assert eventually(lambda: "exploring" in screen.getvalue()[before:])
