"""Names of PDDL never become names that clingo, the contract or an encoding has."""

from __future__ import annotations

import pytest

from prag_asp.pddl.clingo_names import RESERVED, clingo_names
from prag_asp.program.parse import parse_sources
from prag_asp.program.paths import data_folder
from prag_asp.program.sources import read_sources


def test_only_what_the_contract_documents_is_reserved() -> None:
    encodings = data_folder("encodings")
    files = {file for path in encodings.rglob("*.lp") for file in read_sources(path, encodings)}
    statements, problems = parse_sources((file, False) for file in files)
    names = {atom.name for statement in statements for atom in (*statement.heads, *statement.body)}
    assert not problems
    assert {name for name in names if not name.startswith("_")} <= RESERVED


@pytest.mark.parametrize("name", ["changed", "holds", "not"])
def test_a_reserved_name_gets_a_word_before_it(name: str) -> None:
    assert clingo_names([name, "ball"], "is") == {name: f"is_{name}", "ball": "ball"}
