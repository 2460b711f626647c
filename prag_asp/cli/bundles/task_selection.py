"""Tasks that a command line names: by their actions, by their ranks, or as lines of a file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from prag_asp.atom import split_actions
from prag_asp.cli import shell_completion
from prag_asp.cli.arguments import MOST_LENGTHS, one_length
from prag_asp.cli.options import Function, bundled
from prag_asp.errors import QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

RANKS = re.compile(r"(?P<first>\d{1,4000})(\.\.(?P<last>\d{1,4000}))?")
MOST_TASKS = MOST_LENGTHS
"""How many tasks may be named at once."""

NAMED = (
    click.option(
        "--plan", metavar="'A B ...'", shell_complete=shell_completion.plan,
        help="Actions of a task to write: its initial state, and as the goal what is known of its last state.",
    ),
    click.option("-n", "--length", "of_length", type=one_length, metavar="N", help="Number of actions, for --index."),
    click.option("--index", metavar="I|A..B", help="Rank of the task of length N to write, or all from A to B."),
    click.option(
        "--tasks", metavar="FILE", shell_complete=shell_completion.files,
        help="Write all tasks of a file of sample --format jsonl; - is standard input.",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Chosen:
    """Which tasks a command line names."""

    plan: str | None = None
    of_length: int | None = None
    index: str | None = None
    tasks: str | None = None

    @property
    def any(self) -> bool:
        """Whether it names any: otherwise it means the whole domain."""
        return (self.plan, self.index, self.tasks) != (None, None, None)

    def check(self, where: Sequence[str] = ()) -> None:
        """Check that the options fit each other and conditions, before anything is loaded.

        Raises:
            QueryError: they do not.
        """
        options = {"--plan": self.plan, "--index": self.index, "--tasks": self.tasks}
        given = [option for option, value in options.items() if value is not None]
        if len(given) > 1:
            raise QueryError(f"{given[0]} and {given[1]} each name tasks; leave one of them out")
        if (self.index is None) != (self.of_length is None):
            raise QueryError("--length and --index go together: the rank of a task of length N; give both")
        if self.index is not None:
            _ranks(self.index)
        if where and not given:
            raise QueryError("--where is for tasks; name some with --plan, --index or --tasks")

    def of(self, space: TaskSpace) -> tuple[list[str], Iterator[Task]]:
        """Return what to put behind a name for each of the tasks, and lazily the tasks, in spaces of any length.

        Raises:
            OSError: the file of tasks cannot be read.
            QueryError: there are too many, or a line of the file is no task of the domain.
        """
        if self.plan is not None:
            plan = split_actions(self.plan)
            found = space.at(len(plan))
            return [""], iter([found[found.index(plan)]])
        if self.index is not None and self.of_length is not None:
            ranks, ranked = _ranks(self.index), space.at(self.of_length)
            marks = [f"_{rank}" for rank in ranks] if ".." in self.index else [""]
            return marks, (_at(ranked, rank) for rank in ranks)
        plans = _read(self.tasks or "", space)
        marks = [f"_{number}" for number in range(1, len(plans) + 1)]
        return marks, (_task(space.at(len(plan)), plan, place) for place, plan in plans.items())


def names_tasks(function: Function) -> Function:
    """Give a command the options that name tasks, as one value `chosen`."""
    return bundled(function, "chosen", Chosen, NAMED)


def _ranks(text: str) -> range:
    """Return the ranks that a text states.

    Raises:
        QueryError: it states none, or too many.
    """
    found = RANKS.fullmatch(text.strip())
    if found is None:
        raise QueryError(f"--index {text}: write a rank from 0, such as 7, or A..B for all from A to B")
    first, last = int(found["first"]), int(found["last"] or found["first"])
    if last < first:
        raise QueryError(f"--index {text}: the first is above the last; write {last}..{first}")
    if last - first >= MOST_TASKS:
        raise QueryError(f"--index {text}: more than {MOST_TASKS:,} tasks; export fewer at once")
    return range(first, last + 1)


def _at(space: TaskSpace, rank: int) -> Task:
    try:
        return space[rank]
    except IndexError:
        raise QueryError(f"--index {rank}: the space has {plural(space.count(), 'task')}, ranked from 0") from None


def _read(file: str, space: TaskSpace) -> Mapping[str, tuple[str, ...]]:
    """Return the plans of a file by the places where they stand.

    Raises:
        QueryError: a line is no task, or one of another domain, or there are too many.
    """
    from prag_asp.dataset.jsonl import read_tasks
    from prag_asp.dataset.task_origin import foreign

    found: dict[str, tuple[str, ...]] = {}
    for record in read_tasks(file):
        told = foreign(record, space.domain)
        if not told and dict(record.task.constants) != dict(space.domain.constants):
            made = ", ".join(f"{name}={value}" for name, value in record.task.constants.items())
            told = f"it was made with {made or 'no constants'}; give the same with -c"
        if told:
            raise QueryError(f"{record.place}: {told}")
        found[record.place] = tuple(map(str, record.task.actions))
        if len(found) > MOST_TASKS:
            raise QueryError(f"{file}: more than {MOST_TASKS:,} tasks; export fewer at once")
    if not found:
        raise QueryError(f"{file}: no task; write some with prag-asp sample --format jsonl")
    return found


def _task(space: TaskSpace, plan: tuple[str, ...], place: str) -> Task:
    if plan not in space:
        raise QueryError(f"{place}: no task of {space.title}: {' '.join(plan)}; prag-asp explain says why")
    return next(space.tasks_of_plans([plan]))
