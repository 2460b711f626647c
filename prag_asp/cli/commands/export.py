"""The commands that write task spaces and data sets for other tools."""

from __future__ import annotations

from itertools import repeat
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.bundles.task_selection import Chosen, names_tasks
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.options import asks
from prag_asp.cli.terminal import progress, say
from prag_asp.errors import OutputError
from prag_asp.program.paths import shipped_domains
from prag_asp.wording import nearest

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

USUAL = "dimacs"
"""The form of a line that names none."""


class Forms(click.Group):
    """The forms; ``export DOMAIN ...`` is ``export dimacs DOMAIN ...``."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Put the usual form where none is named, be it by a word that is like one and no domain."""
        if args and args[0] not in (*self.commands, *ctx.help_option_names):
            domain = args[0].startswith("-") or args[0] in shipped_domains() or Path(args[0]).exists()
            near = None if domain else nearest(args[0], self.commands)
            if near is not None and not ctx.resilient_parsing:
                ctx.fail(f"no form {args[0]!r}; did you mean {near}?")
            args = [USUAL, *args]
        return super().parse_args(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem[Any]]:
        """Offer the forms, and domains for the usual one."""
        return [
            *super().shell_complete(ctx, incomplete),
            *shell_completion.domains(ctx, self.commands[USUAL].params[0], incomplete),
        ]


@click.group(cls=Forms, subcommand_metavar="FORM ...")
def export() -> None:
    """Write a task space as a formula, a domain or a task as PDDL, or a data set as other programs read it.

    FORM is dimacs for all tasks of DOMAIN, and may then be left out; pddl for DOMAIN or one task of it; or, for a data
    set in DIR: lerobot, minari, robomimic, bddl.
    """


@export.command()
@asks((*options.DOMAIN, options.LENGTH, options.WHERE))
@options.by_level
@click.option("--format", type=click.Choice(["dimacs"]), default="dimacs", show_default=True, help="Form of the file.")
@options.output
def dimacs(*, asked: Asked, by: Any, format: str, output: str | None) -> None:
    """Write all tasks of length N as one formula, for SAT solvers and model counters.

    Projected on the variables that the file shows, the formula has one model for each task.
    """
    require_writable(output)
    lines = asked.space().dimacs(by)
    with writer(output) as out:
        for line in lines:
            out.write(line)


@export.command()
@asks((*options.DOMAIN, options.WHERE))
@names_tasks
@click.option("--positive", is_flag=True, help="No negative conditions: predicates such as not-on say what is not so.")
@click.option(
    "--unconditional",
    is_flag=True,
    help="No conditional effects and no disjunctions: a copy of an action for each case.",
)
@click.option(
    "-o", "--output", metavar="DIR", required=True, shell_complete=shell_completion.files,
    help="New folder, written whole or not at all: domain.pddl, problem.pddl, and plan.txt of a task; of several tasks "
    "domain_1.pddl, ..., numbered by rank or by their order in the file.",
)  # fmt: skip
def pddl(*, asked: Asked, chosen: Chosen, positive: bool, unconditional: bool, output: str) -> None:
    """Write a domain, or tasks of it, as domains and problems of PDDL.

    They have the same plans. What a task leaves open of its initial state is false in PDDL, and a comment says so.
    """
    from prag_asp.output import building, replace_file
    from prag_asp.planners import write

    folder = Path(output)
    if folder.exists():
        raise OutputError(f"{folder}: exists already; choose another name, or remove it first")
    chosen.check(asked.where)
    with progress() as tell:
        domain = asked.domain()
        named = chosen.of(asked.space(tell, domain)) if chosen.any else None
        files = ("domain{}.pddl", "problem{}.pddl", "plan{}.txt")[: 3 if named else 2]
        marks, tasks = named if named is not None else ([""], repeat(None, 1))
        with building(folder, [file.format(mark) for mark in marks for file in files]) as part:
            for number, (mark, task) in enumerate(zip(marks, tasks, strict=True)):
                tell("tasks written", number, len(marks))
                found = write(domain, task, negative=not positive, conditional=not unconditional)
                texts = (found.domain, found.problem, "".join(f"{step}\n" for step in found.plan))
                for file, text in zip(files, texts, strict=False):
                    replace_file(part / file.format(mark), text.encode(), follow=False)
    say(folder)


def _of_data(form: str, told: str, place: str) -> None:
    """Add the command of a form of data sets."""

    @export.command(form, help=told)
    @click.argument("folder", metavar="DIR", shell_complete=shell_completion.files)
    @click.option("--part", metavar="PART", help="One part of the data set, such as train.  [default: all]")
    @options.WHERE
    @click.option(
        "--level", type=click.Choice(["vague", "default", "exact"]), default="default", show_default=True,
        help="How much the instructions say.",
    )  # fmt: skip
    @click.option(
        "-o", "--output", metavar=place, required=True, shell_complete=shell_completion.files,
        help="New folder, written whole or not at all." if place == "DIR" else "File, written whole or not at all.",
    )  # fmt: skip
    def command(*, folder: str, part: str | None, where: tuple[str, ...], level: str, output: str) -> None:
        from prag_asp import Dataset
        from prag_asp.dataset.formats.exporting import export as write

        with progress() as tell:
            data = Dataset.open(folder)
            data = data if part is None else data.part(part)
            conditions = Asked(where=where).conditions()
            say(write(data.where(*conditions) if conditions else data, form, output, level=level, progress=tell))


_of_data(
    "lerobot",
    "Write the recordings of a data set as a LeRobotDataset v3.0: tables of frames, AV1 videos, subtasks.\n\n"
    "Without cameras there are states and actions alone. Depth and segmentation are left out.",
    "DIR",
)
_of_data(
    "minari",
    "Write the recordings of a data set for Minari, which finds them with MINARI_DATASETS_PATH=DIR.\n\n"
    "The data set has its spaces itself, for it has no environment.",
    "DIR",
)
_of_data(
    "robomimic",
    "Write the recordings of a data set as one HDF5 file in robomimic's layout.\n\n"
    "Actions are scaled to -1 to 1 by the limits of the joints; the parts of the data set are its masks.",
    "FILE",
)
_of_data(
    "bddl",
    "Write each task of a data set as a BDDL problem in LIBERO's text form: objects, first state, goal, words.",
    "DIR",
)
