"""Every malformed domain of tests/bad_domains is told exactly what expected.toml says."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from prag_asp.domain.load import load_domain
from prag_asp.errors import DomainError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BAD_DOMAINS = Path(__file__).parent.parent / "bad_domains"
EXPECTED: dict[str, dict[str, Any]] = tomllib.loads((BAD_DOMAINS / "expected.toml").read_text(encoding="utf-8"))


def test_every_folder_has_an_expectation_and_every_expectation_a_folder() -> None:
    assert {path.name for path in BAD_DOMAINS.iterdir() if path.is_dir()} == set(EXPECTED)
    assert len(EXPECTED) >= 30


@pytest.mark.parametrize("name", EXPECTED)
def test_one_mistake_is_told_in_one_line_with_its_place_and_what_to_do(name: str) -> None:
    expected = EXPECTED[name]
    place = f"{BAD_DOMAINS / name / expected['file']}:{expected['line']}: "
    assert told(BAD_DOMAINS / name) == [
        f"{place}warning: {expected['text']} [{expected['warning']}]"
        if "warning" in expected
        else place + expected["text"]
    ]
    assert ";" in expected["text"]


def told(folder: Path) -> list[str]:
    """Return the lines that a domain is told: its errors, or else its warnings."""
    try:
        return list(map(str, load_domain(folder).warnings))
    except DomainError as error:
        return str(error).splitlines()
