"""``prag-asp enumerate``: all tasks, in rank order."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options
from prag_asp.cli.domain_options import SPACES, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.options import whole
from prag_asp.cli.task_options import LINE_FORMAT, TaskFormat, format_options
from prag_asp.cli.terminal import progress, tell_line
from prag_asp.errors import QueryError
from prag_asp.wording import plural


@click.command()
@domain_options(*SPACES)
@options.by_level
@options.prefix
@click.option("--limit", type=whole(0), metavar="K", help="Stop after K lines.")
@format_options(LINE_FORMAT)
@options.output
def enumerate(
    *,
    request: DomainOptions,
    by: Any,
    prefix: str | None,
    limit: int | None,
    task_format: TaskFormat,
    output: str | None,
) -> None:
    """List all tasks of length N in rank order.

    Each task is printed once; for several lengths, the shortest tasks come first.
    """
    form = task_format.form
    task_format.check(by)
    if form != "text" and by == "skeleton":
        raise QueryError(f"skeletons cannot be printed as {form}; use --format text, or --by task")
    from prag_asp.dataset.jsonl import Record

    first = split_actions(prefix or "")
    require_writable(output)
    with progress() as tell:
        space = request.spaces(tell)
        written = 0
        with writer(output) as out:
            words = islice(space.enumerate(by, first), limit)
            lines: Iterator[str]
            if form == "text":
                lines = map(" ".join, words)
            else:
                line = task_format.line(space)
                lines = (line(Record(task)) for task in space.tasks_of_plans(words))
            for text in lines:
                out.write(text)
                written += 1
    if limit is not None and written < limit:
        tell_line(f"only {plural(written, by)}, fewer than --limit {limit}")
