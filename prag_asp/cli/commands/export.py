"""The command that writes a task space for other tools."""

from __future__ import annotations

from typing import Any

import click

from prag_asp.cli import options
from prag_asp.cli.asked import Asked
from prag_asp.cli.options import asks
from prag_asp.cli.writing import require_writable, writer


@click.command()
@asks((*options.DOMAIN, options.LENGTH, options.WHERE))
@options.by_level
@click.option("--format", type=click.Choice(["dimacs"]), default="dimacs", show_default=True, help="Form of the file.")
@options.output
def export(*, asked: Asked, by: Any, format: str, output: str | None) -> None:
    """Write all tasks of length N as one formula, for SAT solvers and model counters.

    Projected on the variables that the file shows, the formula has one model for each task.
    """
    require_writable(output)
    lines = asked.space().dimacs(by)
    with writer(output) as out:
        for line in lines:
            out.write(line)
