"""``prag-asp export``: task spaces and datasets as files for other tools."""

from __future__ import annotations

from collections.abc import Callable
from itertools import repeat
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import DOMAIN, LENGTH, WHERE, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.registry import WholeSentences
from prag_asp.cli.task_options import TaskSelection, task_selection
from prag_asp.cli.terminal import progress, say
from prag_asp.errors import OutputError
from prag_asp.physics.control.names import RECORDED, STATES
from prag_asp.program.paths import shipped_domains
from prag_asp.wording import nearest

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

USUAL = "dimacs"
"""The default form, for a command line that names no form."""


class Forms(WholeSentences):
    """The commands for each form; ``export DOMAIN ...`` is the same as ``export dimacs DOMAIN ...``."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Insert the default form if none is named, unless the first word is a misspelt form."""
        if args and args[0] not in (*self.commands, *ctx.help_option_names):
            domain = args[0].startswith("-") or args[0] in shipped_domains() or Path(args[0]).exists()
            near = None if domain else nearest(args[0], self.commands)
            if near is not None and not ctx.resilient_parsing:
                ctx.fail(f"no format {args[0]!r}; did you mean {near}?")
            args = [USUAL, *args]
        return super().parse_args(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem[Any]]:
        """Complete forms, and domains for the default form."""
        return [
            *super().shell_complete(ctx, incomplete),
            *shell_completion.domains(ctx, self.commands[USUAL].params[0], incomplete),
        ]


@click.group(cls=Forms, subcommand_metavar="FORM ...")
def export() -> None:
    """Write tasks or datasets in the formats of other tools.

    FORM is dimacs (the default) for the task space of DOMAIN as a formula; pddl for DOMAIN or some of its tasks; or
    lerobot, minari, robomimic, bddl or rerun for the dataset in DIR.
    """


@export.command()
@domain_options(*DOMAIN, LENGTH, WHERE)
@options.by_level
@click.option(
    "--format", type=click.Choice(["dimacs"]), default="dimacs", show_default=True, help="Format of the file."
)
@options.output
def dimacs(*, request: DomainOptions, by: Any, format: str, output: str | None) -> None:
    """Write all tasks of length N as a formula for SAT solvers and model counters.

    Projected onto the projection variables that the file declares, the formula has one model for each task.
    """
    require_writable(output)
    lines = request.space().dimacs(by)
    with writer(output) as out:
        for line in lines:
            out.write(line)


@export.command()
@domain_options(*DOMAIN, WHERE)
@task_selection
@click.option("--positive", is_flag=True, help="Avoid negative conditions: predicates such as not-on replace them.")
@click.option(
    "--unconditional",
    is_flag=True,
    help="Avoid conditional effects and disjunctions: write a copy of an action for each case.",
)
@click.option(
    "-o", "--output", metavar="DIR", required=True, shell_complete=shell_completion.files,
    help="New folder, written completely or not at all: domain.pddl, problem.pddl, the view, and plan.txt for a task; "
    "for several tasks domain_1.pddl, ..., numbered by rank or by position in the file.",
)  # fmt: skip
def pddl(*, request: DomainOptions, selection: TaskSelection, positive: bool, unconditional: bool, output: str) -> None:
    """Write a domain, or some of its tasks, as PDDL domains and problems.

    The PDDL files have the same plans as the domain. Fluents that are unknown in the initial state of a task are false
    in PDDL; a comment in the problem gives their number. The files domain.planviz.json and state_view.js make the PDDL
    extension of VS Code show the final states of plans.
    """
    from prag_asp.output import new_folder, replace_file
    from prag_asp.planners import write
    from prag_asp.planners.state_view import SETTINGS_SUFFIX, view_script, view_settings

    folder = Path(output)
    if folder.exists():
        raise OutputError(f"{folder}: exists already; choose another name, or remove it first")
    selection.check(request.where)
    with progress() as tell:
        domain = request.domain()
        selected = selection.of(request.space(tell, domain)) if selection.any else None
        script, settings = "state_view{}.js", f"domain{{}}{SETTINGS_SUFFIX}"
        files = ("domain{}.pddl", "problem{}.pddl", script, settings, "plan{}.txt")[: 5 if selected else 4]
        suffixes, tasks = selected if selected is not None else ([""], repeat(None, 1))
        with new_folder(folder) as part:
            for number, (suffix, task) in enumerate(zip(suffixes, tasks, strict=True)):
                tell("tasks written", number, len(suffixes))
                found = write(domain, task, negative=not positive, conditional=not unconditional)
                view = view_script(found.fluents), view_settings(script.format(suffix))
                texts = (found.domain, found.problem, *view, "".join(f"{step}\n" for step in found.plan))
                for file, text in zip(files, texts, strict=False):
                    replace_file(part / file.format(suffix), text.encode(), follow=False)
    say(folder)


def _conventions(form: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return the options for the actions and observations that a dataset format exports."""
    action = click.option(
        "--action", type=click.Choice(RECORDED), default="joint_position", show_default=True,
        help="Control convention of the actions.",
    )  # fmt: skip
    state = click.option(
        "--state", type=click.Choice(STATES), multiple=True, default=("joint_position",), show_default=True,
        help="Convention of observation.state; may be repeated.",
    )  # fmt: skip
    objects = click.option(
        "--objects/--no-objects", default=None,
        help="Add the poses of objects as observation.environment_state.  [default: without cameras]",
    )  # fmt: skip
    depth = click.option("--depth", is_flag=True, help="Add depth images in millimetres as depth.CAMERA.")
    chosen = {"lerobot": (depth, objects, state, action), "bddl": (), "rerun": ()}.get(form, (action,))

    def decorated(command: Callable[..., None]) -> Callable[..., None]:
        for option in chosen:
            command = option(command)
        return command

    return decorated


def _add_dataset_form(form: str, text: str, place: str) -> None:
    """Add the command for a dataset format, with its help text."""

    @export.command(form, help=text)
    @click.argument("folder", metavar="DIR", shell_complete=shell_completion.files)
    @click.option("--part", metavar="PART", help="Part of the dataset to write, such as train.  [default: all]")
    @WHERE
    @_conventions(form)
    @click.option(
        "--level", type=click.Choice(["vague", "default", "exact"]), default="default", show_default=True,
        help="Detail of the instructions.",
    )  # fmt: skip
    @click.option(
        "-o", "--output", metavar=place, required=True, shell_complete=shell_completion.files,
        help=("New folder" if place == "DIR" else "File") + ", written completely or not at all.",
    )  # fmt: skip
    def command(*, folder: str, part: str | None, where: tuple[str, ...], output: str, **kinds: Any) -> None:
        from prag_asp import Dataset
        from prag_asp.dataset.formats.exporting import export as write

        with progress() as tell:
            data = Dataset.open(folder)
            data = data if part is None else data.part(part)
            conditions = DomainOptions(where=where).conditions()
            say(write(data.where(*conditions) if conditions else data, form, output, progress=tell, **kinds))


_add_dataset_form(
    "lerobot",
    "Write a dataset's episodes as a LeRobotDataset v3.0.\n\n"
    "It contains tables of frames and subtasks, and AV1 videos. Segmentation images are not exported.",
    "DIR",
)
_add_dataset_form(
    "minari",
    "Write a dataset's episodes for Minari.\n\n"
    "Minari finds them with MINARI_DATASETS_PATH=DIR. It recovers an environment with the same actions, for tasks "
    "of the same space.",
    "DIR",
)
_add_dataset_form(
    "robomimic",
    "Write a dataset's episodes as an HDF5 file for robomimic.\n\n"
    "Actions are scaled to -1..1 by their bounds, which env_args holds; the parts of the dataset become masks.",
    "FILE",
)
_add_dataset_form(
    "bddl",
    "Write each task of a dataset as a BDDL problem for LIBERO.\n\n"
    "A problem contains the objects, the initial state, the goal and the instruction.",
    "DIR",
)
_add_dataset_form(
    "rerun",
    "Write a dataset's episodes as Rerun recordings.\n\n"
    "Each episode is one .rrd file with the 3D scene, subgoals, contacts with their forces, joints and camera images "
    "on one timeline.",
    "DIR",
)
