"""Tasks from datasets of prag_asp: initial states, goals and instructions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from prag_asp.atom import Atom
from prag_asp.audit.audited_problem import AuditedProblem
from prag_asp.audit.sources.problem_source import FailedRead
from prag_asp.bddl.ground_goals import FactValue, every
from prag_asp.bddl.ground_problems import GroundProblem
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.manifest import NAME
from prag_asp.domain.load import Domain
from prag_asp.task import State, Task


def recognizes(folder: Path) -> bool:
    """Return whether a folder is a dataset of prag_asp."""
    return (folder / NAME).is_file()


def read(folders: Mapping[str, Path]) -> Iterator[AuditedProblem | FailedRead]:
    """Yield the tasks in datasets; the goal of a task is what its plan changes."""
    for suite, folder in folders.items():
        dataset = Dataset.open(folder)

        def load(dataset: Dataset = dataset) -> Domain:
            return dataset.domain

        for entry in dataset.entries():
            label = f"{entry.part}-{entry.number}"
            language = next(iter(entry.instruction.values()), "")
            yield AuditedProblem(
                suite, label, f"{folder}: task {label}", task_problem(entry.task, label, language), load
            )


def task_problem(task: Task, name: str, language: str = "") -> GroundProblem:
    """Return a task as a problem: its goal or, if it has none, the facts that its plan changes.

    These are the facts that differ between its initial and final states.
    """

    def changed(facts: State) -> dict[Atom, bool]:
        return {fact: value for fact, value in facts.items() if task.initial.get(fact) != value}

    goal = changed(task.goal) or changed(task.states[-1] if task.states else {})
    return GroundProblem(
        name,
        task.entities,
        tuple(FactValue(fact, value) for fact, value in task.initial.items()),
        every(*(FactValue(Atom(*fact), value) for fact, value in goal.items())),
        language,
    )
