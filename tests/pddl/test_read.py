"""Imported domains have just the plans that a forward search over PDDL finds."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.pddl import read
from tests.pddl.forward import Search
from tests.pddl.tasks import TASKS

LENGTH = 4


def written(folder: Path, domain: str, problem: str) -> tuple[Path, Path]:
    paths = folder / "domain.pddl", folder / "problem.pddl"
    for path, text in zip(paths, (domain, problem), strict=True):
        path.write_text(text)
    return paths


@pytest.mark.parametrize("name", TASKS)
def test_all_plans_of_a_problem_are_those_of_a_forward_search(name: str, tmp_path: Path) -> None:
    domain, problem = TASKS[name]
    goalless = f"{problem[: problem.index('(:goal')]}(:goal (and)))"
    for text in (problem, goalless):
        counts = Search(domain, text).count(LENGTH)
        loaded = load_domain(*written(tmp_path, domain, text))
        for engine, most in (("automaton", LENGTH), ("clingo", 3)):
            found = [TaskSpace(loaded, n, engine=engine).count(by="plan") for n in range(most + 1)]
            assert found == counts[: most + 1], read(*written(tmp_path, domain, text)).text
