"""Files of PDDL, and the counts of their plans beside those of a forward search."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.pddl import read
from tests.pddl.forward import Search
from tests.spaces import with_engine


def written(folder: Path, domain: str, problem: str) -> tuple[Path, Path]:
    paths = folder / "domain.pddl", folder / "problem.pddl"
    for path, text in zip(paths, (domain, problem), strict=True):
        path.write_text(text)
    return paths


def with_goal(problem: str, goal: str) -> str:
    """Return a problem with another goal."""
    return f"{problem[: problem.index('(:goal')]}(:goal {goal}))"


@lru_cache(maxsize=200)
def searched(domain: str, problem: str, length: int) -> list[int]:
    """Return the numbers of plans of each length from 0 on that a forward search finds."""
    return Search(domain, problem).count(length)


def counts(domain: Domain, length: int, engine: str = "auto") -> list[int]:
    """Return the numbers of plans of each length from 0 on."""
    space = with_engine(TaskSpace(domain, 0), engine)
    return [space.at(n).count(by="plan") for n in range(length + 1)]


def check_plans(folder: Path, domain: str, problem: str, **lengths: int) -> Domain:
    """Return an imported task that has the plans of a forward search, by each engine up to its length."""
    paths = written(folder, domain, problem)
    loaded = load_domain(*paths)
    space, plans = TaskSpace(loaded, 0), searched(domain, problem, max(lengths.values()))
    for engine, length in lengths.items():
        one = with_engine(space, engine)
        found = [one.at(n).count(by="plan") for n in range(length + 1)]
        assert found == plans[: length + 1], f"{engine}\n{domain}\n{problem}\n{read(*paths).text}"
    return loaded
