"""``prag-asp verify``: whether all that a data set says is so."""

from __future__ import annotations

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.commands.generate import warnings_as_lines
from prag_asp.cli.exits import Exit
from prag_asp.cli.terminal import progress, say
from prag_asp.wording import plural


@click.command()
@click.argument("folder", metavar="DIR", shell_complete=shell_completion.files)
@options.TRUST
@click.option("--physics/--no-physics", default=True, help="Look at witnesses and recordings too.  [default: yes]")
@click.option(
    "--workers", type=options.whole(1), default=1, show_default=True, help="Processes that look at witnesses."
)
def verify(*, folder: str, trust: bool, physics: bool, workers: int) -> None:
    """Verify a data set, or a suite of them: files, exact numbers, each plan, its words, its witnesses.

    Prints a line for each thing that is wrong, with its file and the row in it, from 0; code 1 if there is one. Draws
    are made again by their seed, plans are given to clingo, witnesses to a fresh simulator.
    """
    from prag_asp.dataset.suites.suite_manifest import count_tasks
    from prag_asp.dataset.suites.verifying import verify as wrong
    from prag_asp.missing import require_pyarrow

    require_pyarrow()
    found = 0
    with progress() as tell, warnings_as_lines():
        for finding in wrong(folder, trust=trust, physics=physics, workers=workers, progress=tell):
            say(str(finding))
            found += 1
        tasks = count_tasks(folder)
    if found:
        raise click.exceptions.Exit(Exit.NOT_FOUND)
    say(f"{folder}: ok; {plural(tasks, 'task')}")
