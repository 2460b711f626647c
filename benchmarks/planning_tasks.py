"""The public collection of planning tasks: its families, the tasks of each in their order, and what is asked of one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

COMMENT = re.compile(r";[^\n]*")
METRIC = re.compile(r"\(\s*:metric\b", re.IGNORECASE)
OTHER_TRACKS = re.compile(r"-(sat|agl|mco)\d")
"""Families of tracks whose tasks are not meant to be solved by shortest plans."""


@dataclass(frozen=True)
class PlanningTask:
    """A task of the collection: its name, and its two files."""

    name: str
    domain: Path
    problem: Path


def first_tasks(checkout: Path, families: Sequence[str], first: int) -> Iterator[PlanningTask]:
    """Yield the first tasks of some families, or of all of the optimal tracks: the first of each, then the second."""
    names = families or sorted(path.name for path in checkout.iterdir() if not OTHER_TRACKS.search(path.name))
    found = {name: list(tasks(checkout / name)) for name in names}
    for place in range(first):
        yield from (each[place] for each in found.values() if place < len(each))


def tasks(family: Path) -> Iterator[PlanningTask]:
    """Yield the tasks of a family, in the order of their numbers."""
    files = sorted(family.glob("*.pddl"), key=lambda path: (list(map(int, re.findall(r"\d+", path.stem))), path.name))
    for problem in files:
        own = (
            f"domain_{problem.name}",
            f"domain-{problem.name}",
            f"{problem.stem}-domain.pddl",
            f"{problem.stem[:3]}-domain.pddl",
            "domain.pddl",
        )
        found = next((family / name for name in own if (family / name).is_file()), None)
        if found and "domain" not in problem.name:
            yield PlanningTask(f"{family.name}/{problem.stem}", found, problem)


def with_unit_costs(task: PlanningTask, folder: Path) -> PlanningTask:
    """Return a task without its metric, so that each action costs 1, written into a folder."""
    path = folder / f"{task.name.replace('/', '-')}.pddl"
    path.write_text(without_metric(task.problem.read_text(errors="replace")))
    return PlanningTask(task.name, task.domain, path)


def without_metric(text: str) -> str:
    """Return a problem without its metric."""
    text = COMMENT.sub("", text)
    found = METRIC.search(text)
    if not found:
        return text
    depth, end = 1, found.end()
    while depth:
        depth += {"(": 1, ")": -1}.get(text[end], 0)
        end += 1
    return text[: found.start()] + text[end:]
