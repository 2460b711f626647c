"""``prag-asp task``: the task with a given rank, or the rank of a task."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import SPACE, DomainOptions, domain_options
from prag_asp.cli.summary import described
from prag_asp.cli.task_options import ENGLISH, FORMS, INSTRUCTIONS, LEVELS, TaskFormat, format_options, task_at
from prag_asp.cli.terminal import aligned, progress, say
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

FORM = click.option(
    "--format", "form", type=click.Choice(["full", *FORMS]), default="full", show_default=True,
    help="Format: all states, or a format of sample, with all levels of instructions.",
)  # fmt: skip


@click.command()
@domain_options(*SPACE)
@click.option("--index", type=int, metavar="I", help="Rank of the task, from 0; negative ranks count from the end.")
@click.option(
    "--rank-of", "plan", metavar="'A B ...'", shell_complete=shell_completion.plan,
    help="Print the rank of the task with these actions, separated by spaces or commas.",
)  # fmt: skip
@format_options(FORM)
@click.option("--all", "false_facts", is_flag=True, help="Also print the facts that are known to be false.")
@click.option(
    "--complexity", "with_complexity", is_flag=True,
    help="Also print how complex the task is: choices, changes undone, shortest plans to its goal.",
)  # fmt: skip
@options.seed
def task(
    *,
    request: DomainOptions,
    index: int | None,
    plan: str | None,
    task_format: TaskFormat,
    false_facts: bool,
    with_complexity: bool,
    seed: int,
) -> None:
    """Print the task with a given rank, or the rank of a task.

    Tasks are ranked in lexicographic order of their actions, and actions in clingo's order of terms; the ranks depend
    only on the domain.
    """
    from prag_asp.dataset.jsonl import Record

    task_format.check()
    if (index is None) == (plan is None):
        raise QueryError("give --index or --rank-of")
    if with_complexity and (index is None or task_format.form != "full"):
        raise QueryError("--complexity goes with --index and --format full")
    with progress() as tell:
        space = request.space(tell)
        if index is None:
            say(space.index(split_actions(plan or "")))
            return
        found = task_at(space, index, f"--index {index}")
        if task_format.form == "full":
            say("\n".join(described(found, space, false_facts=false_facts)))
            if with_complexity:
                say("\n".join(("", *_complexity_lines(found, space))))
        elif task_format.form == INSTRUCTIONS and task_format.level is None:
            from prag_asp.dataset.language import instruction_writer_of

            texts = instruction_writer_of(space.domain, task_format.language or ENGLISH).instructions(found, seed)
            for level in LEVELS:
                say(f"{level:<9}{getattr(texts, level)}".rstrip())
            for number, sentence in enumerate(texts.subgoals, 1):
                say(f"{number:>5}    {sentence}")
            if texts.named:
                say(f"named    {', '.join(texts.named)}: not visually distinguishable from other objects")
        else:
            say(task_format.line(space, seed)(Record(found)))


def _complexity_lines(found: Task, space: TaskSpace) -> Iterator[str]:
    from prag_asp.analysis.complexity import complexity_of

    own = complexity_of(found, space)
    yield from aligned(
        [
            ("actions", f"{own.length}"),
            ("entities used", f"{own.entities}"),
            ("changes undone", f"{own.undone}"),
            ("choices, bits", f"{own.bits:.2f}"),
            ("shortest plan", f"{own.shortest}"),
            ("shortest plans", f"{own.shortest_plans}"),
            ("detour", f"{own.detour}"),
        ]
    )
