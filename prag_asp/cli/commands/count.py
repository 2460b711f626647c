"""``prag-asp count``: exact numbers of tasks."""

from __future__ import annotations

from typing import Any

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.exits import Exit
from prag_asp.cli.options import Approximation, asks
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import LimitReached, QueryError
from prag_asp.integers import digits_of


@click.command()
@asks(options.SPACES)
@options.by_level
@options.prefix
@click.option("--upto", is_flag=True, help="Print a table for the lengths 1 to N, as --length 1..N does.")
@options.approximation
def count(*, asked: Asked, by: Any, prefix: str | None, upto: bool, approximation: Approximation) -> None:
    """Print the exact number of tasks of length N, or a table of them for the lengths from A to B.

    With --approximate, prints about how many there are, with bounds that hold with a probability that is told.
    Where --memory or --time ends the count, prints "at least K" for the K that were found, and exits with code 3.
    """
    first = split_actions(prefix or "")
    estimate = approximation.asked(asked.engine)
    lengths = _lengths(asked.length, upto)
    table = upto or isinstance(asked.length, range)
    width = max(len(str(lengths[-1])), len("length")) if table and lengths else 0
    label = ""
    try:
        with progress() as tell:
            space = asked.spaces(tell)
            if table:
                say(f"{'length':>{width}}  {by}s")
            for length in lengths:
                label = f"{length:>{width}}  " if table else ""
                here = space.at(length)
                told = digits_of(here.count(by, first)) if estimate is None else here.estimate(by, first, **estimate)
                say(f"{label}{told}")
    except LimitReached as limit:
        say(f"{label}at least {digits_of(limit.at_least)}")
        tell_line(str(limit))
        raise click.exceptions.Exit(Exit.LIMIT) from None


def _lengths(asked: int | range, upto: bool) -> range:
    """Return the lengths to count.

    Raises:
        QueryError: they are given twice.
    """
    if isinstance(asked, int):
        return range(1 if upto else asked, asked + 1)
    if upto:
        raise QueryError(f"--upto counts the lengths from 1 on; leave it out with --length {asked[0]}..{asked[-1]}")
    return asked
