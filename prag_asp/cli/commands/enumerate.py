"""``prag-asp enumerate``: all tasks, in rank order."""

from __future__ import annotations

from itertools import islice
from typing import Any

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options
from prag_asp.cli.bundles.task_format import Telling, tells
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.options import asks
from prag_asp.cli.run_fingerprint import run_of
from prag_asp.cli.terminal import progress
from prag_asp.errors import QueryError


@click.command()
@asks(options.SPACES)
@options.by_level
@options.prefix
@click.option("--limit", type=options.whole(0), metavar="K", help="Stop after K lines.")
@tells
@options.output
def enumerate(
    *, asked: Asked, by: Any, prefix: str | None, limit: int | None, telling: Telling, output: str | None
) -> None:
    """Print all tasks of length N, each once, in rank order; of several lengths, the shortest first.

    FILE is replaced as a whole at the end; a run that was broken off goes on where it was when it is started again.
    """
    form = telling.form
    telling.check()
    if form != "text" and by == "skeleton":
        raise QueryError(f"skeletons have no form {form}; choose --format text, or --by task")
    from prag_asp.dataset.jsonl import Record

    first = split_actions(prefix or "")
    require_writable(output)
    with progress() as tell:
        space = asked.spaces(tell)
        run = run_of(space.domain) if output else None
        with writer(output, run, lambda lines, _: limit is None or lines <= limit) as out:
            words = islice(space.enumerate(by, first), out.lines, limit)
            if form == "text":
                for word in words:
                    out.write(" ".join(word))
            else:
                line = telling.line(space.domain)
                for task in space.tasks_of_plans(words):
                    out.write(line(Record(task)))
