"""Commands that run in the process of the tests."""

from __future__ import annotations

import pytest

from prag_asp.cli import cli
from tests.sharing import automata_are_cached, pictures_are_small, shared_logic  # noqa: F401 - fixtures


class Told:
    """Runs commands in this process."""

    def __init__(self, capture: pytest.CaptureFixture[str]) -> None:
        self._capture = capture

    def __call__(self, *arguments: str, code: int = 0) -> str:
        """Return what a command prints, on stdout where it succeeds, otherwise on stderr."""
        found = cli.main(list(arguments))
        out, err = self._capture.readouterr()
        assert found == code, err
        assert "Traceback" not in err
        return err if code else out


@pytest.fixture
def told(capsys: pytest.CaptureFixture[str]) -> Told:
    return Told(capsys)
