"""Imported domains have just the plans that a forward search over PDDL finds."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import DomainError, TaskSpace, load_domain
from prag_asp.pddl import read
from tests.chance import examples
from tests.pddl.forward import Search
from tests.pddl.random_tasks import random_task
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


@settings(max_examples=examples(30))
@given(seed=integers(0, 10**6))
def test_random_tasks_have_the_plans_of_a_forward_search(seed: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    domain, problem = random_task(seed)
    counts = Search(domain, problem).count(3)
    paths = written(tmp_path_factory.mktemp("random"), domain, problem)
    try:
        loaded = load_domain(*paths)
    except DomainError as error:  # the check tells of a goal that no action ever reaches
        assert "the goal is never reached" in str(error) and not any(counts)
        return
    for engine, most in (("automaton", 3), ("clingo", 2)):
        found = [TaskSpace(loaded, n, engine=engine).count(by="plan") for n in range(most + 1)]
        assert found == counts[: most + 1], f"{seed}\n{domain}\n{problem}\n{read(*paths).text}"


@pytest.mark.parametrize(
    "goal",
    [
        "(and (forall (?x - room) (p ?x)) (not (exists (?x - room) (p ?x))))",
        "(and (forall (?x - room) (p ?x)) (not (p a)))",
        "(and (forall (?x - room) (imply (static ?x) (not (p ?x)))) (p a) (not (static b)) (not (= a b)))",
        "(and (p a) (static a))",
    ],
)
def test_goals_that_contradict_themselves_or_facts_are_no_mistakes(goal: str, tmp_path: Path) -> None:
    domain, problem = TASKS["never"]
    problem = f"{problem[: problem.index('(:goal')]}(:goal {goal}))"
    loaded = load_domain(*written(tmp_path, domain, problem))
    assert [TaskSpace(loaded, n).count(by="plan") for n in range(4)] == Search(domain, problem).count(3)
