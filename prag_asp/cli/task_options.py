"""Options that select tasks (by plan, by rank, or from a file), and options for the format of printed tasks."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from prag_asp.atom import split_actions
from prag_asp.cli import shell_completion
from prag_asp.cli.arguments import parse_length
from prag_asp.cli.options import Decorator, grouped
from prag_asp.errors import QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.physics import Staging
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

RANKS = re.compile(r"(?P<first>\d{1,4000})(\.\.(?P<last>\d{1,4000}))?")

MOST_TASKS = 1_000_000
"""The maximum number of tasks in a request, because each one is written to its own files."""


@dataclass(frozen=True)
class TaskSelection:
    """The tasks selected by a command line, if any."""

    plan: str | None = None
    of_length: int | None = None
    index: str | None = None
    tasks: str | None = None

    @property
    def any(self) -> bool:
        """Whether tasks are selected; otherwise the request is for the whole domain."""
        return (self.plan, self.index, self.tasks) != (None, None, None)

    def check(self, where: Sequence[str] = ()) -> None:
        """Check that the options and the conditions are consistent, before anything is loaded.

        Raises:
            QueryError: two options exclude each other, or one needs another.
        """
        options = {"--plan": self.plan, "--index": self.index, "--tasks": self.tasks}
        selectors = [option for option, value in options.items() if value is not None]
        if len(selectors) > 1:
            raise QueryError(f"{selectors[0]} and {selectors[1]} both select tasks; leave one of them out")
        if (self.index is None) != (self.of_length is None):
            raise QueryError("--length and --index go together: the rank of a task of length N; give both")
        if self.index is not None:
            _parse_ranks(self.index)
        if where and not selectors:
            raise QueryError("--where is for tasks; select some with --plan, --index or --tasks")

    def of(self, space: TaskSpace) -> tuple[list[str], Iterator[Task]]:
        """Return suffixes for the files of the tasks, and a lazy iterator over the tasks, which may differ in length.

        Raises:
            OSError: the file of tasks cannot be read.
            QueryError: there are too many tasks, or a line of the file is not a task of the domain.
        """
        if self.plan is not None:
            plan = split_actions(self.plan)
            plan_space = space.at(len(plan))
            return [""], iter([plan_space[plan_space.index(plan)]])
        if self.index is not None and self.of_length is not None:
            ranks, ranked = _parse_ranks(self.index), space.at(self.of_length)
            suffixes = [f"_{rank}" for rank in ranks] if ".." in self.index else [""]
            return suffixes, (task_at(ranked, rank, f"--index {rank}") for rank in ranks)
        plans = _read_plans(self.tasks or "", space)
        suffixes = [f"_{number}" for number in range(1, len(plans) + 1)]
        return suffixes, (_task(space.at(len(plan)), plan, place) for place, plan in plans.items())


task_selection = grouped(
    "selection", TaskSelection,
    (
        click.option(
            "--plan", metavar="'A B ...'", shell_complete=shell_completion.plan,
            help="Actions of the task to write; its goal is the known part of its final state.",
        ),
        click.option(
            "-n", "--length", "of_length", type=parse_length, metavar="N", help="Number of actions, for --index."
        ),
        click.option("--index", metavar="I|A..B",
        help="Rank of the task of length N to write, or all ranks from A to B."),
        click.option(
            "--tasks", metavar="FILE", shell_complete=shell_completion.files,
            help="Write all tasks in a file from sample --format jsonl; - is standard input.",
        ),
    ),
)  # fmt: skip
"""The decorator that gives a command the options that select tasks, as a single value `selection`."""


def _parse_ranks(text: str) -> range:
    """Parse the ranks in a text.

    Raises:
        QueryError: the text does not have the form of ranks, or contains too many.
    """
    match = RANKS.fullmatch(text.strip())
    if match is None:
        raise QueryError(f"--index {text}: write a rank from 0, such as 7, or A..B for all from A to B")
    first, last = int(match["first"]), int(match["last"] or match["first"])
    if last < first:
        raise QueryError(f"--index {text}: the first is above the last; write {last}..{first}")
    if last - first >= MOST_TASKS:
        raise QueryError(f"--index {text}: more than {MOST_TASKS:,} tasks; export fewer at once")
    return range(first, last + 1)


def task_at(space: TaskSpace, rank: int, place: str) -> Task:
    """Return the task with a given rank; errors name `place`, where the rank was given.

    Raises:
        QueryError: there is no such task.
    """
    try:
        return space[rank]
    except IndexError:
        raise QueryError(f"{place}: the space has {plural(space.count(), 'task')}, ranked from 0") from None


def _read_plans(file: str, space: TaskSpace) -> Mapping[str, tuple[str, ...]]:
    """Read the plans in a file, by line number.

    Raises:
        QueryError: a line is not a task, or is a task of a different domain, or there are too many tasks.
    """
    from prag_asp.dataset.jsonl import read_tasks
    from prag_asp.dataset.task_origin import foreign

    plans: dict[str, tuple[str, ...]] = {}
    for record in read_tasks(file):
        problem = foreign(record, space.domain)
        if not problem and dict(record.task.constants) != dict(space.domain.constants):
            constants = ", ".join(f"{name}={value}" for name, value in record.task.constants.items())
            problem = f"it was made with {constants or 'no constants'}; give the same with -c"
        if problem:
            raise QueryError(f"{record.place}: {problem}")
        plans[record.place] = tuple(map(str, record.task.actions))
        if len(plans) > MOST_TASKS:
            raise QueryError(f"{file}: more than {MOST_TASKS:,} tasks; export fewer at once")
    if not plans:
        raise QueryError(f"{file}: no task; write some with prag-asp sample --format jsonl")
    return plans


def _task(space: TaskSpace, plan: tuple[str, ...], place: str) -> Task:
    if plan not in space:
        raise QueryError(f"{place}: no task of {space.title}: {' '.join(plan)}; see prag-asp explain")
    return next(space.tasks_of_plans([plan]))


FORMS = ("text", "sentences", "instructions", "jsonl", "scenario")
INSTRUCTIONS, SCENARIO = "instructions", "scenario"
ENGLISH, USUAL = "en", "default"
LEVELS = ("vague", USUAL, "exact")


@dataclass(frozen=True)
class TaskFormat:
    """The format of printed tasks, and the language and the level of instructions."""

    form: str
    language: str | None
    level: str | None

    def line(self, space: TaskSpace, seed: int = 0, staging: Staging | None = None) -> Callable[[Record], str]:
        """Return a function that formats the record of a task in a space as one line.

        The seed selects the phrasing of instructions; `staging` is the staging of demonstrations.

        Raises:
            QueryError: the domain does not have the language, or the options contradict each other.
        """
        from prag_asp.dataset.jsonl import write_line
        from prag_asp.dataset.language import instruction, instruction_writer_of

        self.check()
        domain = space.domain
        if self.form == SCENARIO:
            from prag_asp.dataset.scenarios import Scenarios, start_of

            scenarios = Scenarios(domain, space)
            return lambda record: str(scenarios.of(space, record.task, start_of(record, staging)))
        if self.form == INSTRUCTIONS:
            writer, level = instruction_writer_of(domain, self.language or ENGLISH), self.level or USUAL
            return lambda record: str(getattr(writer.instructions(record.task, seed), level))
        forms: dict[str, Callable[[Record], str]] = {
            "text": lambda record: str(record.task),
            "sentences": lambda record: instruction(record.task, domain.settings.language),
            "jsonl": write_line,
        }
        return forms[self.form]

    def check(self, by: str = "task") -> None:
        """Check that options for instructions are given only with that format, and scenario ids only for tasks.

        Raises:
            QueryError: an option for instructions is given with another format, or ids of plans are requested.
        """
        if self.form == SCENARIO and by != "task":
            raise QueryError(f"a scenario id is that of a task, not of a {by}; leave --by {by} out")
        for option, value in {"--language": self.language, "--level": self.level}.items():
            if value is not None and self.form != INSTRUCTIONS:
                raise QueryError(f"{option} {value} goes with --format instructions; got --format {self.form}")


def format_options(form: Decorator) -> Decorator:
    """Return a decorator that adds `form`, the option --format, and the options for instructions to a command."""
    return grouped(
        "task_format", TaskFormat,
        (
            form,
            click.option(
                "--language", metavar="LANGUAGE", shell_complete=shell_completion.languages,
                help="Language of instructions: en, or another language for which the domain has words, such as de.  "
                "[default: en]",
            ),
            click.option(
                "--level", type=click.Choice(LEVELS),
                help="Detail of instructions: only the final state, the actions, or also the purpose of each action.",
            ),
        ),
    )  # fmt: skip


LINE_FORMAT = click.option(
    "--format", "form", type=click.Choice(FORMS), default="text", show_default=True,
    help="Actions; sentences from the domain's [language] table; instructions for a person who sees the scene; all "
    "known data of a task; or its scenario id, from which prag-asp scenario reproduces the task.",
)  # fmt: skip
