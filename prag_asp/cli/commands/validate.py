"""``prag-asp validate``: tasks of a file checked again."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import IO

import click

from prag_asp.cli import complete, options
from prag_asp.cli.asked import Asked
from prag_asp.cli.ending import FAILED
from prag_asp.cli.options import Checking, asks
from prag_asp.cli.terminal import progress, require_unrecorded, whole_lines
from prag_asp.errors import QueryError


@click.command()
@click.argument("file", metavar="TASKS.jsonl", shell_complete=complete.files)
@asks((*options.OF_FILE, options.WHERE, options.TRUST))
@options.seed
@options.checks
@click.option("--witness-only", is_flag=True, help="Check the witnesses in the file, and look for no new ones.")
def validate(*, asked: Asked, file: str, seed: int, checking: Checking, witness_only: bool) -> None:
    """Check tasks of a file again: that their plans are valid, and that a robot can do them.

    Prints a line for each task: its number, its verdict and the reason. Give the options of --rule, --encodings, --flat
    and --where that the tasks were made with.
    """
    from prag_asp.physics import require_physics

    require_unrecorded(checking.demonstrate)
    checking.tries()
    if witness_only and checking.budget != options.BUDGET:
        raise QueryError(
            f"--budget {checking.budget} is for a search; --witness-only makes none, so leave one of them out"
        )
    require_physics()
    with click.open_file(file, encoding="utf-8", errors="replace") as lines, progress() as tell:
        total = _tasks_in(lines)
        if total == 0:
            raise QueryError(f"{file}: no tasks in it; write some with prag-asp sample --format jsonl -o {file}")
        from prag_asp.cli.tally import show_tally, tally_line
        from prag_asp.dataset import Tally, read_lines, recheck

        budget = checking.limits()
        limits = f"witnesses only, {budget.tier}" if witness_only else f"budget {budget}"
        tally = Tally()
        outcomes = recheck(
            read_lines(lines, file), where=asked.conditions(), seed=seed, witness_only=witness_only,
            load=lambda record, folder: asked.of(record, folder).domain(), folder=Path(file).parent,
            **checking.arguments(),
        )  # fmt: skip
        try:
            with whole_lines(), closing(outcomes):
                for outcome in outcomes:
                    tally.count(outcome.status, outcome.reason, outcome.causes)
                    click.echo(f"{tally.seen}\t{outcome.status}\t{outcome.reason}".rstrip())
                    tell(tally_line(tally, ("task", "tasks"), limits), tally.seen, total)
        finally:
            show_tally(tally, tally_line(tally, ("task", "tasks"), limits))
    if tally.passed < tally.seen:
        raise click.exceptions.Exit(FAILED)


def _tasks_in(lines: IO[str]) -> int | None:
    """Return how many lines of a file hold something, None where it can be read only once."""
    if not lines.seekable():
        return None
    number = sum(1 for line in lines if line.strip())
    lines.seek(0)
    return number
