"""Physics on a stream of tasks: which pass, and a tally of why the rest fail."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import groupby, islice, tee
from typing import TYPE_CHECKING

import click

from prag_asp.cli.options import Asked, scene_of
from prag_asp.dataset.jsonl import Record
from prag_asp.errors import OutputError, QueryError
from prag_asp.physics import Verdict, Witness, check_witness, validate_tasks

if TYPE_CHECKING:
    from prag_asp.domain.scene import Scene
    from prag_asp.space.task import Task
    from prag_asp.space.task_space import TaskSpace


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


def feasible(tasks: Iterator[Task], scene: Scene, seed: int, workers: int, tally: Tally) -> Iterator[Record]:
    """Yield the feasible tasks with verdict and witness, and count all of them."""
    asked, kept = tee(tasks)
    with closing(validate_tasks(asked, scene, seed=seed, workers=workers)) as verdicts:
        for task, verdict in zip(kept, verdicts, strict=False):
            tally.add(verdict)
            if verdict.feasible:
                told = verdict.to_json()
                witness = told.pop("witness")
                yield Record(task, told, witness)


def first_feasible(
    tasks: Iterator[Task], wanted: int, scene: Scene, seed: int, workers: int, limit: int, tell: Callable[[str], None]
) -> Generator[Record, None, None]:
    """Yield the first `wanted` feasible ones of at most `limit` tasks, and say on stderr how many it took.

    Raises:
        OutputError: they are fewer.
    """
    tally = Tally()
    try:
        for record in islice(feasible(islice(tasks, limit), scene, seed, workers, tally), wanted):
            yield record
            tell(str(tally))
    finally:
        click.echo(str(tally), err=True)
    if tally.passed < wanted:
        raise OutputError(f"only {tally.passed} of {wanted} tasks were found in {limit} draws; raise --max-draws")


def check_again(
    records: Sequence[Record], asked: Asked, *, seed: int, workers: int, witness_only: bool
) -> Iterator[tuple[str, str]]:
    """Yield for each record its verdict and the reason: whether its plan is valid, and whether physics agrees.

    Where `asked` has no domain, each names its own.
    """
    for own, group in groupby(records, key=lambda record: record.task.domain):
        space = replace(asked, name=asked.name or own).space()
        scene = scene_of(space.domain)
        found = [(record, _fault(record.task, space)) for record in group]
        valid = (record.task for record, fault in found if not fault and not witness_only)
        with closing(validate_tasks(valid, scene, seed=seed, workers=workers)) as verdicts:
            for record, fault in found:
                if fault:
                    yield "invalid", fault
                elif witness_only:
                    yield _check_witness(record, scene)
                else:
                    verdict = next(verdicts)
                    yield verdict.status, verdict.reason


def _fault(task: Task, space: TaskSpace) -> str:
    """Return what is wrong with a task as a value, or nothing."""
    if task not in space.at(len(task)):
        return "the plan does not belong to the domain"
    expected = next(space.narrate(iter([tuple(map(str, task.actions))])))
    parts = ("entities", "initial", "states", "subgoals", "goal")
    wrong = [part for part in parts if getattr(task, part) != getattr(expected, part)]
    return f"its {', '.join(wrong)} are not what its actions make" if wrong else ""


def _check_witness(record: Record, scene: Scene) -> tuple[str, str]:
    if record.witness is None:
        return "not_found", "the file has no witness for it"
    try:
        witness = Witness.from_json(record.witness)
    except QueryError as error:
        return "witness_fails", str(error)
    problems = check_witness(record.task, witness, scene)
    return ("witness_fails", problems[0]) if problems else ("feasible", "")
