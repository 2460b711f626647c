"""Check tasks of a file again: whether their plans are valid, and whether physics agrees."""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import ExitStack, closing
from dataclasses import replace
from itertools import chain, groupby, islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.cli.options import Asked, Checking, scene_of
from prag_asp.dataset.feasible import Recordings
from prag_asp.dataset.jsonl import Record
from prag_asp.dataset.origin import foreign, index_of, named_domain, read_witness, told_with_place
from prag_asp.errors import QueryError
from prag_asp.physics import (
    Demonstration,
    Verdict,
    demonstrate,
    open_settling,
    open_witness_check,
    physical_task,
    travel,
    validate_numbered,
)
from prag_asp.physics.search.attempt import NO_PATH

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.scene.model import Scene
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

TOLD_TOGETHER = 128
"""Tasks of which the states are worked out together; that many are read ahead."""

Told = tuple[Record, str]
"""A record, and what is wrong with its task as a value, or nothing."""


class Outcome(NamedTuple):
    """What became of a task: feasible, not_found, infeasible, invalid or witness_fails; why, and failed attempts."""

    status: str
    reason: str = ""
    causes: Mapping[str, int] = {}
    demonstration: Demonstration | None = None


def check_again(
    records: Iterable[Record], asked: Asked, *, folder: Path, seed: int, checking: Checking, witness_only: bool
) -> Generator[Outcome, None, None]:
    """Yield what becomes of each record; records are read a little ahead.

    Where `asked` has no domain, each record names its own: a shipped one, or a folder, here or in `folder`.
    """
    number, recordings = 0, Recordings(checking.demonstrate)
    for _, several in groupby(records, key=lambda record: record.task.domain):
        group = iter(several)
        first = next(group)
        space = replace(asked, name=asked.name or named_domain(first, folder)).space()
        told, scene = _told(chain([first], group), space), scene_of(space.domain)
        check = _witnesses(told, scene, checking) if witness_only else _anew(told, scene, seed, checking)
        for outcome in check:
            number += 1
            recordings.write(number, outcome.demonstration)
            yield outcome


def _told(records: Iterable[Record], space: TaskSpace) -> Iterator[Told]:
    """Yield records with what is wrong with their tasks as values."""
    iterator, size = iter(records), 1
    while batch := list(islice(iterator, size)):
        valid = [record.task in space.at(len(record.task)) for record in batch]
        plans = (tuple(map(str, r.task.actions)) for r, known in zip(batch, valid, strict=True) if known)
        expected = space.narrate(plans)
        for record, known in zip(batch, valid, strict=True):
            yield record, _fault(record.task, next(expected)) if known else _stranger(record, space.domain)
        size = min(2 * size, TOLD_TOGETHER)


def _stranger(record: Record, domain: Domain) -> str:
    """Return that a plan is none of a domain, and which domain the file says that it is of."""
    other = foreign(record, domain)
    return f"its plan is none of {domain.name}{f'; {other}' if other else ''}"


def _fault(task: Task, expected: Task) -> str:
    """Return what is wrong with a task as a value, or nothing."""
    names = {
        "entities": "entities",
        "initial": "initial state",
        "states": "states",
        "subgoals": "subgoals",
        "goal": "goal",
    }
    wrong = [name for part, name in names.items() if getattr(task, part) != getattr(expected, part)]
    verb = "is" if wrong in (["initial state"], ["goal"]) else "are"
    return f"its {', '.join(wrong)} {verb} not what its actions make" if wrong else ""


def _anew(told: Iterator[Told], scene: Scene, seed: int, checking: Checking) -> Iterator[Outcome]:
    """Yield what a new search says of each task, wherever it stands in the file."""
    waiting: deque[str] = deque()

    def valid() -> Iterator[tuple[int, Task]]:
        for record, fault in told:
            waiting.append(fault)
            if not fault:
                yield index_of(record), record.task

    budget = checking.limits()
    with closing(validate_numbered(valid(), scene, seed=seed, workers=checking.workers, budget=budget)) as verdicts:
        for verdict in verdicts:
            yield from _invalid(waiting)
            waiting.popleft()
            yield _outcome(verdict)
    yield from _invalid(waiting)


def _invalid(waiting: deque[str]) -> Iterator[Outcome]:
    """Take the invalid tasks that come first, up to one that is valid."""
    while waiting and waiting[0]:
        yield Outcome("invalid", waiting.popleft())


def _outcome(verdict: Verdict) -> Outcome:
    """Return a verdict as an outcome."""
    return Outcome(verdict.status, verdict.reason, verdict.causes, verdict.demonstration)


def _witnesses(told: Iterator[Told], scene: Scene, checking: Checking) -> Iterator[Outcome]:
    """Yield what the witness of each record is worth, by the tiers of a budget."""
    budget = checking.limits()
    with ExitStack() as resources:
        check = resources.enter_context(open_witness_check(scene))
        settling = resources.enter_context(open_settling(scene)) if budget.includes("settling") else None
        for record, fault in told:
            if fault:
                yield Outcome("invalid", fault)
                continue
            if record.witness is None:
                yield Outcome("not_found", "the file has no witness for it")
                continue
            try:
                with told_with_place(record):
                    witness = read_witness(record, scene)
            except QueryError as error:
                yield Outcome("witness_fails", str(error))
                continue
            faults: list[str | None] = [*check(record.task, witness)[:1]]
            if not faults and settling is not None:
                faults.append(settling.failure(physical_task(record.task, scene), witness))
            if not any(faults) and budget.includes("transit") and not witness.travels:
                travelled = travel(record.task, witness, scene)
                witness = travelled or witness
                faults.append(NO_PATH if travelled is None else None)
            demonstration = None
            if not any(faults) and budget.includes("demonstration"):
                demonstration = demonstrate(record.task, witness, scene)
                faults.append(demonstration.detail if not demonstration.success else None)
            reason = next(filter(None, faults), "")
            yield Outcome("witness_fails", reason) if reason else Outcome("feasible", demonstration=demonstration)
