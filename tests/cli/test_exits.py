"""One table of exit codes: in the code, in the help, and on the page."""

from __future__ import annotations

import re

import pytest

from prag_asp import errors
from prag_asp.cli.exits import MEANINGS, Exit, exit_of
from prag_asp.stop_reason import StopKind, StopReason
from tests.commands import ok
from tests.docs.pages import DOCS


def test_help_lists_commands_with_whole_sentences() -> None:
    for group, first in (("export", "Commands:"), ("models", "Commands:"), ("", "Define:")):
        listed = ok(*group.split(), "--help").partition(first)[2].partition("Exit codes")[0]
        assert "." in listed and "..." not in listed


def test_help_and_page_have_the_table_of_exit_codes() -> None:
    table = {int(code): meaning for code, meaning in MEANINGS.items()}
    page = (DOCS / "reference" / "exit_codes.md").read_text()
    assert {int(code): told for code, told in re.findall(r"^\| (\d+) \| (.+) \|$", page, re.MULTILINE)} == table
    _, _, told = ok("--help").partition("Exit codes:\n")
    assert {int(code): each for code, each in re.findall(r"^ +(\d+)  (.+)$", told, re.MULTILINE)} == table
    assert set(Exit) == set(MEANINGS)


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (errors.DomainError("d"), 2),
        (errors.QueryError("q"), 2),
        (errors.SceneError("s"), 2),
        (errors.EngineError("e"), 2),
        (errors.PhysicsMissingError("p"), 2),
        (errors.LimitReached("l", 7, StopReason(StopKind.TIME, 1.0)), 3),
        (errors.NotFound("n"), 1),
        (errors.OutputError("o"), 4),
        (errors.WorkerError("w"), 5),
    ],
)
def test_each_kind_of_error_has_its_code(error: errors.PragError, code: int) -> None:
    assert exit_of(error) == code
