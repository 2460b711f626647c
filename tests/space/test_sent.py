"""Task spaces, domains and data about them are sent to other processes, where clingo's symbols lie elsewhere."""

from __future__ import annotations

import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import clingo
import pytest

from prag_asp import TaskSpace, load_domain

ANSWERS = "import pickle, sys; found = pickle.load(open(sys.argv[1], 'rb')); {}; pickle.dump(answer, sys.stdout.buffer)"


def elsewhere(path: Path, given: Any, code: str) -> Any:
    """Return what a statement makes of something in a process of its own, which has it as `found`."""
    path.write_bytes(pickle.dumps(given))
    command = [sys.executable, "-c", ANSWERS.format(code), str(path)]
    return pickle.loads(subprocess.run(command, capture_output=True, check=True).stdout)


@pytest.mark.parametrize("name", ["tabletop", "hanoi"])
def test_a_space_counts_and_draws_the_same_in_another_process(name: str, tmp_path: Path) -> None:
    space = TaskSpace(load_domain(name), length=3)
    code = "answer = found.count(), [str(task) for task in found.sample(3, seed=1)]"
    expected = space.count(), [str(task) for task in space.sample(3, seed=1)]
    assert elsewhere(tmp_path / "fresh", TaskSpace(load_domain(name), length=3), code) == expected
    assert elsewhere(tmp_path / "used", space, code) == expected


def test_conditions_and_lengths_go_with_it(tmp_path: Path) -> None:
    space = TaskSpace(load_domain("tabletop"), range(1, 4)).where("uses can_1", "ends inside(can_1,bin_1)")
    expected = space.count()
    assert 0 < expected == elsewhere(tmp_path / "spaces", space, "answer = found.count()")
    single = TaskSpace(load_domain("tabletop"), length=2).where("uses can_1").at(3)
    assert elsewhere(tmp_path / "space", single, "answer = found.length, found.count()") == (3, single.count())


def test_terms_of_all_kinds_get_there(tmp_path: Path) -> None:
    terms = [clingo.parse_term(text) for text in ('f(a,-2,"b c\\"d\\n")', "#sup", "-g(1)", "(x,)", "h")]
    assert TaskSpace  # what knows how symbols are sent
    assert elsewhere(tmp_path / "terms", terms, "answer = list(map(str, found))") == list(map(str, terms))
