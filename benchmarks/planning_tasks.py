"""The public collection of planning tasks: its families, and the tasks of each in order."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

COMMENT = re.compile(r";[^\n]*")
METRIC = re.compile(r"\(\s*:metric\b", re.IGNORECASE)
OTHER_TRACKS = re.compile(r"-(sat|agl|mco)\d")
"""The families of tracks other than the optimal ones."""


@dataclass(frozen=True)
class PlanningTask:
    """A task of the collection: its name and its two files."""

    name: str
    domain: Path
    problem: Path


def first_tasks(checkout: Path, families: Sequence[str], first: int) -> Iterator[PlanningTask]:
    """Yield the first tasks of some families, by default of the optimal tracks: the first of each, then the second."""
    names = families or sorted(path.name for path in checkout.iterdir() if not OTHER_TRACKS.search(path.name))
    tasks_of = {name: list(tasks(checkout / name)) for name in names}
    for place in range(first):
        yield from (each[place] for each in tasks_of.values() if place < len(each))


def tasks(family: Path) -> Iterator[PlanningTask]:
    """Yield the tasks of a family, in the order of their numbers."""
    files = sorted(family.glob("*.pddl"), key=lambda path: (list(map(int, re.findall(r"\d+", path.stem))), path.name))
    for problem in files:
        candidates = (
            f"domain_{problem.name}",
            f"domain-{problem.name}",
            f"{problem.stem}-domain.pddl",
            f"{problem.stem[:3]}-domain.pddl",
            "domain.pddl",
        )
        domain = next((family / name for name in candidates if (family / name).is_file()), None)
        if domain and "domain" not in problem.name:
            yield PlanningTask(f"{family.name}/{problem.stem}", domain, problem)


def with_unit_costs(task: PlanningTask, folder: Path) -> PlanningTask:
    """Return a task without its metric, so that each action costs 1; the problem is written into a folder."""
    path = folder / f"{task.name.replace('/', '-')}.pddl"
    path.write_text(without_metric(task.problem.read_text(errors="replace")))
    return PlanningTask(task.name, task.domain, path)


def without_metric(text: str) -> str:
    """Return a problem without its metric."""
    text = COMMENT.sub("", text)
    metric = METRIC.search(text)
    if not metric:
        return text
    depth, end = 1, metric.end()
    while depth:
        depth += {"(": 1, ")": -1}.get(text[end], 0)
        end += 1
    return text[: metric.start()] + text[end:]
