"""``prag-asp task``: the task of a rank, or the rank of a task."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import SPACE, DomainOptions, domain_options
from prag_asp.cli.task_options import ENGLISH, FORMS, INSTRUCTIONS, LEVELS, TaskFormat, format_options
from prag_asp.cli.terminal import progress, say
from prag_asp.errors import QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import State, Task

READINGS_SHOWN = 5
FORM = click.option(
    "--format", "form", type=click.Choice(["full", *FORMS]), default="full", show_default=True,
    help="All states; or a format of sample, with all levels of instructions.",
)  # fmt: skip


@click.command()
@domain_options(*SPACE)
@click.option("--index", type=int, metavar="I", help="Rank of the task, from 0; negative ranks count from the end.")
@click.option(
    "--rank-of", "plan", metavar="'A B ...'", shell_complete=shell_completion.plan,
    help="Print the rank of the task with these actions; blanks or commas separate them.",
)  # fmt: skip
@format_options(FORM)
@options.seed
def task(*, request: DomainOptions, index: int | None, plan: str | None, task_format: TaskFormat, seed: int) -> None:
    """Print the task of a rank, or the rank of a task.

    Tasks are ranked in lexicographic order of their actions, and actions in clingo's order of terms; the ranks depend
    on the domain only.
    """
    from prag_asp.dataset.jsonl import Record

    task_format.check()
    if (index is None) == (plan is None):
        raise QueryError("give --index or --rank-of")
    with progress() as tell:
        space = request.space(tell)
        if index is None:
            say(space.index(split_actions(plan or "")))
            return
        try:
            found = space[index]
        except IndexError:
            raise QueryError(f"--index {index}: the space has {plural(space.count(), 'task')}, ranked from 0") from None
        if task_format.form == "full":
            say("\n".join(_described(found, space)))
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
            say(task_format.line(space.domain, seed)(Record(found)))


def _described(found: Task, space: TaskSpace) -> list[str]:
    """Return lines with the rank of a task, its initial state, the effects of its actions, its goal, its readings."""
    fluents = len(space.domain.facts.fluents)
    lines = [f"task {space.index(found)} of {space.count()}", f"start  {_state(found.initial, fluents)}"]
    width = max((len(str(action)) for action in found.actions), default=0)
    for number, (action, subgoal) in enumerate(zip(found.actions, found.subgoals, strict=True), 1):
        lines.append(f"{number:>5}  {action!s:<{width}}  {_facts_text(subgoal)}".rstrip())
    lines.append(f"goal   {_state(found.goal, fluents)}")
    readings = space.readings(found) if space.domain.facts.composites else None
    if readings is not None:
        lines += [f"read   {' '.join(map(str, reading))}" for reading in islice(readings, READINGS_SHOWN)]
        if readings.count() > READINGS_SHOWN:
            lines.append(f"       and {plural(readings.count() - READINGS_SHOWN, 'more reading')}")
    return lines


def _state(state: State, fluents: int) -> str:
    """Return the known facts of a state as text; if all facts are known, only the true ones."""
    return _facts_text({fluent: value for fluent, value in state.items() if value or len(state) < fluents})


def _facts_text(state: State) -> str:
    return ", ".join(f"{'' if value else 'not '}{fluent}" for fluent, value in state.items())
