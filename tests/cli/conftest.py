"""Commands that run in the process of the tests."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from prag_asp.cli import cli
from tests.sharing import logic_shared, small_pictures


@pytest.fixture(scope="package", autouse=True)
def logic() -> Iterator[None]:
    """Compute once what logic says of a domain, and draw small pictures; commands in other processes do as ever."""
    with logic_shared(), small_pictures():
        yield


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
