"""The command that writes a task space for other tools."""

from __future__ import annotations

from typing import Any

import click

from prag_asp.cli import options
from prag_asp.cli.commands import cli
from prag_asp.cli.options import Asked, asks
from prag_asp.cli.terminal import require_writable, writer


@cli.command()
@asks(options.DOMAIN)
@click.option("-n", "--length", type=click.IntRange(min=0), required=True, metavar="N", help="Number of actions.")
@options.by_level
@click.option("--format", type=click.Choice(["dimacs"]), default="dimacs", show_default=True, help="Form of the file.")
@options.output
def export(*, asked: Asked, by: Any, format: str, output: str | None) -> None:
    """Write all tasks of length N as one formula, for SAT solvers and model counters.

    Projected on the variables that the file shows, the formula has one model for each task.
    """
    from prag_asp.logic.formula.cnf import dimacs
    from prag_asp.logic.model import Model
    from prag_asp.space.engines.formula import word_formula

    require_writable(output)
    domain = asked.domain()
    formula = word_formula(Model(domain), by, asked.length)
    with writer(output) as write:
        for line in dimacs(formula.cnf, [f"the {by}s of {domain.name} of length {asked.length}, by prag_asp"]):
            write(line)
