"""Physics on a stream of tasks: which pass, and a tally of why the rest fail."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import groupby, islice, tee
from pathlib import Path
from typing import TYPE_CHECKING

import click

from prag_asp.cli.options import Asked, Checking, scene_of
from prag_asp.dataset.jsonl import Record
from prag_asp.errors import OutputError, QueryError
from prag_asp.physics import (
    Budget,
    Demonstration,
    Verdict,
    Witness,
    check_witness,
    demonstrate,
    settle,
    travel,
    validate_tasks,
)
from prag_asp.physics.search import NO_PATH

if TYPE_CHECKING:
    from prag_asp.domain.scene import Scene
    from prag_asp.space.task import Task
    from prag_asp.space.task_space import TaskSpace


class Recordings:
    """The folder of the demonstrations of some tasks, made when the first is written; no folder, no files."""

    def __init__(self, folder: str | None):
        self._folder = None if folder is None else Path(folder)

    def write(self, number: int, demonstration: Demonstration | None) -> str | None:
        """Write the demonstration of the task on a line, counted from 1, and return the name of its file.

        Raises:
            OutputError: it cannot be written.
        """
        if self._folder is None or demonstration is None:
            return None
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{self._folder}: the folder cannot be made: {error}") from error
        name = f"{number:06d}.npz"
        demonstration.save(self._folder / name)
        return name


class Tally:
    """How many tasks were drawn, how many passed, and why the rest failed."""

    def __init__(self) -> None:
        self.drawn, self.passed, self.budget = 0, 0, ""
        self._reasons: Counter[str] = Counter()

    def add(self, verdict: Verdict) -> None:
        """Count a verdict."""
        self.drawn += 1
        self.passed += verdict.feasible
        self.budget = str(verdict.budget)
        if not verdict.feasible:
            kind = "proved infeasible" if verdict.status == "infeasible" else "not found"
            self._reasons[f"{kind}: {verdict.reason}"] += 1

    def __str__(self) -> str:
        share = f" ({100 * self.passed / self.drawn:.1f} %, budget {self.budget})" if self.drawn else ""
        reasons = "".join(f"\n  {number} {reason}" for reason, number in self._reasons.most_common())
        return f"{self.drawn} drawn, {self.passed} passed{share}{reasons}"


def feasible(tasks: Iterator[Task], scene: Scene, seed: int, checking: Checking, tally: Tally) -> Iterator[Record]:
    """Yield the feasible tasks with verdict and witness, write their demonstrations, and count all of them."""
    asked, kept = tee(tasks)
    recordings, workers, budget = Recordings(checking.demonstrate), checking.workers, checking.limits()
    with closing(validate_tasks(asked, scene, seed=seed, workers=workers, budget=budget)) as verdicts:
        for task, verdict in zip(kept, verdicts, strict=False):
            tally.add(verdict)
            if verdict.feasible:
                told = verdict.to_json()
                witness = told.pop("witness")
                name = recordings.write(tally.passed, verdict.demonstration)
                if name is not None:
                    told["demonstration"] = name
                yield Record(task, told, witness)


def first_feasible(
    tasks: Iterator[Task],
    wanted: int,
    scene: Scene,
    seed: int,
    checking: Checking,
    limit: int,
    tell: Callable[[str], None],
) -> Generator[Record, None, None]:
    """Yield the first `wanted` feasible ones of at most `limit` tasks, and say on stderr how many it took.

    Raises:
        OutputError: they are fewer.
    """
    tally = Tally()
    try:
        for record in islice(feasible(islice(tasks, limit), scene, seed, checking, tally), wanted):
            yield record
            tell(str(tally))
    finally:
        click.echo(str(tally), err=True)
    if tally.passed < wanted:
        raise OutputError(f"only {tally.passed} of {wanted} tasks were found in {limit} draws; raise --max-draws")


def check_again(
    records: Sequence[Record], asked: Asked, *, seed: int, checking: Checking, witness_only: bool
) -> Iterator[tuple[str, str]]:
    """Yield for each record its verdict and the reason: whether its plan is valid, and whether physics agrees.

    Where `asked` has no domain, each names its own.
    """
    number, budget, recordings = 0, checking.limits(), Recordings(checking.demonstrate)
    for own, group in groupby(records, key=lambda record: record.task.domain):
        space = replace(asked, name=asked.name or own).space()
        scene = scene_of(space.domain)
        found = [(record, _fault(record.task, space)) for record in group]
        valid = (record.task for record, fault in found if not fault and not witness_only)
        with closing(validate_tasks(valid, scene, seed=seed, workers=checking.workers, budget=budget)) as verdicts:
            for record, fault in found:
                number += 1
                if fault:
                    yield "invalid", fault
                elif witness_only:
                    yield _check_witness(record, scene, budget, number, recordings)
                else:
                    verdict = next(verdicts)
                    recordings.write(number, verdict.demonstration)
                    yield verdict.status, verdict.reason


def _fault(task: Task, space: TaskSpace) -> str:
    """Return what is wrong with a task as a value, or nothing."""
    if task not in space.at(len(task)):
        return "the plan does not belong to the domain"
    expected = next(space.narrate(iter([tuple(map(str, task.actions))])))
    parts = ("entities", "initial", "states", "subgoals", "goal")
    wrong = [part for part in parts if getattr(task, part) != getattr(expected, part)]
    return f"its {', '.join(wrong)} are not what its actions make" if wrong else ""


def _check_witness(
    record: Record, scene: Scene, budget: Budget, number: int, recordings: Recordings
) -> tuple[str, str]:
    """Return the verdict on the witness of a record by the tiers of a budget, and the reason."""
    if record.witness is None:
        return "not_found", "the file has no witness for it"
    try:
        witness = Witness.from_json(record.witness)
    except QueryError as error:
        return "witness_fails", str(error)
    problems = check_witness(record.task, witness, scene)
    if problems:
        return "witness_fails", problems[0]
    fault, demonstration = _dearer_checks(record.task, witness, scene, budget)
    if fault:
        return "witness_fails", fault
    recordings.write(number, demonstration)
    return "feasible", ""


def _dearer_checks(
    task: Task, witness: Witness, scene: Scene, budget: Budget
) -> tuple[str | None, Demonstration | None]:
    """Return why a witness fails in the tiers after kinematics, nothing where it passes; and the demonstration."""
    if budget.includes("settling") and (failure := settle(task, witness, scene)):
        return failure, None
    if budget.includes("transit") and not witness.travels:
        travelled = travel(task, witness, scene)
        if travelled is None:
            return NO_PATH, None
        witness = travelled
    if not budget.includes("demonstration"):
        return None, None
    demonstration = demonstrate(task, witness, scene)
    return demonstration.detail, demonstration
