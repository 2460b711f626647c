"""``prag-asp count``: the exact number of tasks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options
from prag_asp.cli.domain_options import SPACES, DomainOptions, domain_options
from prag_asp.cli.options import Approximation
from prag_asp.cli.terminal import progress, say
from prag_asp.errors import LimitReached, QueryError
from prag_asp.integers import digits_of


@click.command()
@domain_options(*SPACES)
@options.by_level
@options.prefix
@click.option("--upto", is_flag=True, help="Print a table for the lengths 1 to N, like --length 1..N.")
@options.approximation
def count(*, request: DomainOptions, by: Any, prefix: str | None, upto: bool, approximation: Approximation) -> None:
    """Count the tasks of length N exactly.

    For several lengths, prints a table. With --approximate, prints an estimate with its bounds, and the probability
    with which these hold. If --memory or --time ends the count, prints "at least K" for the K tasks that were found,
    and exits with code 3.
    """
    first = split_actions(prefix or "")
    estimate = approximation.arguments(request.engine)
    lengths: Sequence[int]
    if isinstance(request.length, int):
        lengths, table = range(1 if upto else request.length, request.length + 1), upto
    elif upto:
        raise QueryError("--upto counts all lengths from 1; leave it out with several lengths")
    else:
        lengths, table = request.length, True
    width = max(len(str(lengths[-1])), len("length")) if table and lengths else 0
    label = ""
    try:
        with progress() as tell:
            space = request.spaces(tell)
            if table:
                say(f"{'length':>{width}}  {by}s")
            for length in lengths:
                label = f"{length:>{width}}  " if table else ""
                here = space.at(length)
                number = digits_of(here.count(by, first)) if estimate is None else here.estimate(by, first, **estimate)
                say(f"{label}{number}")
    except LimitReached as limit:
        say(f"{label}at least {digits_of(limit.at_least)}")
        raise
