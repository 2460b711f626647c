"""Each malformed domain of bad_domains/ gets exactly the lines that its case expects: errors, or else warnings.

A case is a table of a file in bad_domains/. It patches the good domain bad_domains/base and says what is
`reported`, a line for each problem. For each file that it changes it has one or more of

    "domain.lp".add = 'heavy(cube_1).'                  lines after the last (base/domain.lp has 17)
    "domain.lp".replace = ['robot)', 'robto)']          a text, wherever it stands, by another
    "domain.toml".whole = 'title = 3'                   all lines of the file

and `encoding` where its files are not UTF-8. The table [base] patches the base before each case of its file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from prag_asp.domain.load import load_domain
from prag_asp.errors import DomainError
from tests.toml import tomllib

FOLDER = Path(__file__).parent / "bad_domains"
FAMILIES: dict[str, dict[str, Any]] = {
    path.stem: tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(FOLDER.glob("*.toml"))
}
CASES = [(family, name) for family, cases in FAMILIES.items() for name in cases if name != "base"]


def patched(texts: Mapping[str, str], patches: Mapping[str, Any]) -> dict[str, str]:
    """Return the texts of the files of a domain after patches, each under the name of its file."""
    changed = dict(texts)
    for file, patch in patches.items():
        text = changed.get(file, "")
        assert patch.keys() <= {"add", "replace", "whole"}, f"{file}: {patch}"
        if "whole" in patch:
            text = lines(patch["whole"])
        if "replace" in patch:
            old, new = patch["replace"]
            assert old in text, f"{file} has no {old!r}"
            text = text.replace(old, new)
        changed[file] = text + lines(patch.get("add", ""))
    return changed


def lines(text: str) -> str:
    """Return a text that ends with the end of a line, unless it is empty."""
    return text if text.endswith("\n") or not text else f"{text}\n"


def base(family: str) -> dict[str, str]:
    """Return the texts of the files that the cases of a family patch."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in (FOLDER / "base").iterdir()}
    return patched(texts, FAMILIES[family].get("base", {}))


def write(folder: Path, texts: Mapping[str, str], encoding: str = "utf-8") -> None:
    """Write the files of a domain into an empty folder."""
    for file, text in texts.items():
        (folder / file).write_bytes(text.encode(encoding))


def reported(folder: Path) -> list[str]:
    """Return the errors of a domain, or else its warnings."""
    try:
        return list(map(str, load_domain(folder).warnings))
    except DomainError as error:
        return str(error).split("\n")


def test_every_mistake_has_a_case_of_its_own_name() -> None:
    assert len({name for _, name in CASES}) == len(CASES) >= 127


@pytest.mark.parametrize("family", FAMILIES)
def test_what_the_cases_patch_has_no_mistake(tmp_path: Path, family: str) -> None:
    write(tmp_path, base(family))
    assert load_domain(tmp_path).warnings == ()


@pytest.mark.parametrize(("family", "name"), CASES, ids=[name for _, name in CASES])
def test_one_mistake_is_reported_in_one_line_with_its_place_and_what_to_do(
    tmp_path: Path, family: str, name: str
) -> None:
    case = FAMILIES[family][name]
    patches = {key: value for key, value in case.items() if key not in {"reported", "encoding"}}
    write(tmp_path, patched(base(family), patches), case.get("encoding", "utf-8"))
    expected = case["reported"].strip("\n").split("\n")
    assert reported(tmp_path) == [f"{tmp_path}/{line}" for line in expected]
    assert all(";" in line for line in expected)
