"""The tasks that a command compares, given as ranks, scenario ids, JSON lines, files of JSON lines, or datasets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.cli.domain_options import DomainOptions
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.domain.load import Domain
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task


@dataclass(frozen=True)
class GivenTask:
    """A task from a file or dataset, and its group: a part of a dataset, or a length."""

    record: Record
    group: str


@dataclass(frozen=True)
class ComparedTasks:
    """Tasks, the group of each task (a part of a dataset, or a length), and the space of their domain, if known."""

    tasks: list[Task]
    groups: list[str]
    space: TaskSpace | None


def read_pair(words: Sequence[str], request: DomainOptions, up_to: str) -> ComparedTasks:
    """Return the two tasks that two words of a command line name.

    Raises:
        QueryError: a word names no task, or the tasks belong to different domains.
    """
    if request.where and not any(word.isdecimal() for word in words):
        raise QueryError(f"--where {request.where[0]!r} is for ranks and datasets; leave it out")
    tasks: list[Task] = []
    domains: list[Domain] = []
    for word in words:
        task, domain = _named_task(word, request)
        tasks.append(task)
        domains += [] if domain is None else [domain]
    space = None if up_to != "domain" else _space_of(tasks, request, domains[0] if domains else None)
    return ComparedTasks(tasks, [""] * len(tasks), space)


def _named_task(word: str, request: DomainOptions) -> tuple[Task, Domain | None]:
    """Return the task that a rank, scenario id, JSON line or file names, and its domain if it was loaded."""
    from prag_asp.dataset.jsonl import read_lines, read_tasks

    if word.isdecimal():
        if not request.names or not request.length:
            raise QueryError(f"{word}: a rank needs --domain and --length, or give a scenario id or a file")
        from prag_asp.cli.task_options import task_at

        space = request.space()
        return task_at(space, int(word), f"rank {word}"), space.domain
    if word.lstrip().startswith("{"):
        return next(read_lines([word], "argument")).task, None
    if Path(word).is_file() or word == "-":
        records = list(read_tasks(word))
        if len(records) != 1:
            raise QueryError(f"{word}: has {len(records)} tasks; give it alone to compare all, or a file with one task")
        return records[0].task, None
    from prag_asp.dataset.scenario import Scenario
    from prag_asp.dataset.scenarios import Scenarios

    if ":" not in word:
        raise QueryError(f"{word}: no such file, and neither a rank nor a scenario id; see prag-asp similarity --help")
    scenario = Scenario.parse(word)
    domain = request.of_scenario(scenario).domain()
    return Scenarios(domain).task(scenario), domain


def records_in(word: str, *, trust: bool = False, where: Sequence[str] = ()) -> tuple[list[GivenTask], Dataset | None]:
    """Return the tasks in a dataset or in a file of JSON lines, and the dataset.

    Raises:
        OSError: the file cannot be read.
        QueryError: there is no task, or conditions are given for a file.
    """
    from prag_asp.dataset.jsonl import Record, read_tasks

    dataset: Dataset | None = None
    if Path(word).is_dir():
        from prag_asp.dataset.store.dataset import Dataset as Stored

        dataset = Stored.open(word, trust=trust).where(*where) if where else Stored.open(word, trust=trust)
        given = [
            GivenTask(
                Record(each.task, None if each.verdict is None else each.verdict.to_json(), place=word), each.part
            )
            for each in dataset.entries()
        ]
    elif where:
        raise QueryError(f"--where {where[0]!r} is for ranks and datasets; leave it out")
    else:
        given = [GivenTask(record, f"{len(record.task)} actions") for record in read_tasks(word)]
    if not given:
        raise QueryError(f"{word}: has no task")
    return given, dataset


def read_all(word: str, request: DomainOptions, up_to: str) -> ComparedTasks:
    """Return the tasks in a dataset or in a file of JSON lines.

    Raises:
        QueryError: there is no task, or the tasks belong to different domains.
    """
    given, dataset = records_in(word, trust=request.trust, where=request.where)
    tasks, groups = [each.record.task for each in given], [each.group for each in given]
    domain = dataset.domain if dataset is not None and up_to == "domain" and not request.names else None
    return ComparedTasks(tasks, groups, _space_of(tasks, request, domain) if up_to == "domain" else None)


def _space_of(tasks: Sequence[Task], request: DomainOptions, domain: Domain | None) -> TaskSpace:
    """Return a space for the domain of tasks: the loaded domain, the requested one, or the one that the tasks name.

    Raises:
        QueryError: the tasks belong to several domains, or to a different one than requested.
    """
    from prag_asp.dataset.task_origin import named_domain
    from prag_asp.space.task_space import TaskSpace

    named = {(task.domain, tuple(task.constants.items())) for task in tasks}
    if len(named) > 1:
        (one, _), (other, _), *_ = sorted(named)
        raise QueryError(f"tasks of {one!r} and of {other!r}, or with other constants; compare them with --up-to names")
    ((name, constants),) = named
    if domain is None:
        names = request.names or (named_domain(name, "the tasks", Path()),)
        recorded = tuple(f"{key}={value}" for key, value in constants if not request.constants)
        domain = replace(request, names=names, constants=(*request.constants, *recorded)).domain()
    if domain.name != name:
        raise QueryError(f"the tasks are of {name!r}, not of {domain.name!r}; give another --domain")
    return TaskSpace(domain, max(map(len, tasks)))
