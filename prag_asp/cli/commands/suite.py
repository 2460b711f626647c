"""``prag-asp suite``: the parts of a benchmark, counted exactly or written as datasets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from prag_asp.cli import exit_control, options, shell_completion
from prag_asp.cli.commands.generate import warnings_as_lines
from prag_asp.cli.options import whole
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import NotFound, QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.suites.counting import Figures
    from prag_asp.dataset.suites.suite_spec import Suite


@click.command()
@click.argument("name", metavar="SUITE", shell_complete=shell_completion.suites)
@click.option(
    "--count",
    "counts",
    is_flag=True,
    help="Print the numbers of tasks, of shared tasks and of held-out tasks in the parts; write nothing.",
)
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    shell_complete=shell_completion.files,
    help="Folder for one dataset per part, and the card.",
)
@click.option(
    "--at-most", "most", type=whole(1), metavar="K",
    help="Write at most K tasks per part, for a trial; the same command without this option continues.",
)  # fmt: skip
@click.option("--workers", type=whole(1), default=1, show_default=True, help="Number of processes for physics.")
@options.trust
def suite(*, name: str, counts: bool, output: str | None, most: int | None, workers: int, trust: bool) -> None:
    """Count or write the datasets of a benchmark.

    SUITE is a shipped suite, such as tabletop-generalisation, or a TOML file. Its parts are sets of tasks of one
    domain. Parts that share tasks are refused unless the file allows it. If the command is interrupted, run it again:
    it continues.
    """
    from prag_asp.dataset.suites.counting import count_suite, refuse_leaks
    from prag_asp.dataset.suites.suite_reader import load_suite

    if counts == (output is not None):
        raise QueryError("give --count, or --output DIR to write it")
    limits = exit_control.limits()
    with progress() as tell, warnings_as_lines():
        found = load_suite(name, trust=trust)
        found = found if most is None else found.at_most(most)
        if output is None:
            figures = count_suite(found, limits=limits, progress=tell)
            _show(found, figures)
            refuse_leaks(found, figures)
            return
        from prag_asp.dataset.suites.suite_builder import generate_suite

        try:
            made = generate_suite(found, output, workers=workers, limits=limits, progress=tell)
        except NotFound:
            tell_line(f"{output}: holds the tasks that were found")
            raise
    width = max(len(part.name) for part in made.parts)
    for part in made.parts:
        say(f"{part.name:<{width}}  {part.tasks} of {part.size}")


def _show(suite: Suite, figures: Figures) -> None:
    """Print the exact sizes of the parts, and the exact numbers of shared and held-out tasks."""
    width = max(map(len, suite.parts))
    for name, part in suite.parts.items():
        lengths = f"{part.lengths[0]}" if len(part.lengths) == 1 else f"{part.lengths[0]}..{part.lengths[-1]}"
        say(f"{name:<{width}}  {lengths:>6}  {part.tasks} of {figures.size(name)}")
    for each in figures.shared:
        if each.tasks:
            note = "as declared" if each.declared else "not declared"
            say(f"shared: {each.one}, {each.other}  {each.digits}, {note}")
    none = sum(not each.tasks for each in figures.shared)
    say(f"shared: 0 in {none} of {len(figures.shared)} pairs of parts")
    for name, part in suite.parts.items():
        for other, distance in part.distance.items() if part.of is None else ():
            say(f"distance: {name}  at least {plural(distance, 'edit')} from all tasks of {other}")
    for held in suite.held:
        away = [each for each in figures.unseen if each.what == held.what]
        tasks = sum(each.tasks for each in away)
        say(f"held out: {held.what}  {tasks} in {', '.join(each.part for each in away)}")
