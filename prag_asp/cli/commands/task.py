"""``prag-asp task``: one task by its rank, and the rank of a task."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options, shell_completion
from prag_asp.cli.bundles.task_format import ENGLISH, FORMS, INSTRUCTIONS, LEVELS, Telling, tells_in
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.options import asks
from prag_asp.cli.terminal import progress, say
from prag_asp.errors import QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import State, Task

READINGS_SHOWN = 5
FORM = click.option(
    "--format", "form", type=click.Choice(["full", *FORMS]), default="full", show_default=True,
    help="All states in words; or as in sample, instructions with all their levels.",
)  # fmt: skip


@click.command()
@asks(options.SPACE)
@click.option("--index", type=int, metavar="I", help="Rank of the task, from 0; a negative one counts from the end.")
@click.option(
    "--rank-of", "plan", metavar="'A B ...'", shell_complete=shell_completion.plan,
    help="Actions of a task, whose rank to find; blanks or commas separate them.",
)  # fmt: skip
@tells_in(FORM)
@options.seed
def task(*, asked: Asked, index: int | None, plan: str | None, telling: Telling, seed: int) -> None:
    """Show the task of a rank, or print the rank of a task.

    Tasks are ranked in lexicographic order of their actions, and actions in clingo's order of terms: the order depends
    on the domain alone.
    """
    from prag_asp.dataset.jsonl import Record

    telling.check()
    if (index is None) == (plan is None):
        raise QueryError("give either --index or --rank-of")
    with progress() as tell:
        space = asked.space(tell)
        if index is None:
            say(space.index(split_actions(plan or "")))
            return
        try:
            found = space[index]
        except IndexError:
            raise QueryError(f"--index {index}: the space has {plural(space.count(), 'task')}, ranked from 0") from None
        if telling.form == "full":
            say("\n".join(_described(found, space)))
        elif telling.form == INSTRUCTIONS and telling.level is None:
            say("\n".join(_told_to_somebody(found, space, telling.language or ENGLISH, seed)))
        else:
            say(telling.line(space.domain, seed)(Record(found)))


def _described(found: Task, space: TaskSpace) -> list[str]:
    """Return the lines that tell a task: its rank, its start, what each action makes true, its goal, its readings."""
    fluents = len(space.domain.facts.fluents)
    lines = [f"task {space.index(found)} of {space.count()}", f"start  {_state(found.initial, fluents)}"]
    width = max((len(str(action)) for action in found.actions), default=0)
    for number, (action, subgoal) in enumerate(zip(found.actions, found.subgoals, strict=True), 1):
        lines.append(f"{number:>5}  {action!s:<{width}}  {_told(subgoal)}".rstrip())
    lines.append(f"goal   {_state(found.goal, fluents)}")
    readings = space.readings(found) if space.domain.facts.composites else None
    if readings is not None:
        lines += [f"read   {' '.join(map(str, reading))}" for reading in islice(readings, READINGS_SHOWN)]
        if readings.count() > READINGS_SHOWN:
            lines.append(f"       and {plural(readings.count() - READINGS_SHOWN, 'more reading')}")
    return lines


def _told_to_somebody(found: Task, space: TaskSpace, language: str, seed: int) -> list[str]:
    """Return the lines that tell a task to somebody who sees the scene: its levels, and its subgoals one by one."""
    from prag_asp.dataset.language import instruction_writer_of

    told = instruction_writer_of(space.domain, language).instructions(found, seed)
    lines = [f"{level:<9}{getattr(told, level)}".rstrip() for level in LEVELS]
    lines += [f"{number:>5}    {sentence}" for number, sentence in enumerate(told.subgoals, 1)]
    if told.named:
        lines.append(f"named    {', '.join(told.named)}: nothing that can be seen tells them from others")
    return lines


def _state(state: State, fluents: int) -> str:
    """Return what is known of a state in words; of one that is known whole, what is true."""
    return _told({fluent: value for fluent, value in state.items() if value or len(state) < fluents})


def _told(state: State) -> str:
    return ", ".join(f"{'' if value else 'not '}{fluent}" for fluent, value in state.items())
