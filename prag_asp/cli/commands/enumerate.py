"""``prag-asp enumerate``: all tasks, in rank order."""

from __future__ import annotations

from itertools import islice
from typing import Any

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options
from prag_asp.cli.asked import Asked
from prag_asp.cli.options import asks
from prag_asp.cli.terminal import progress, require_writable, writer
from prag_asp.errors import QueryError


@click.command()
@asks(options.SPACES)
@options.by_level
@options.prefix
@click.option("--limit", type=click.IntRange(min=0), metavar="K", help="Stop after K lines.")
@options.form
@options.output
def enumerate(*, asked: Asked, by: Any, prefix: str | None, limit: int | None, form: str, output: str | None) -> None:
    """Print all tasks of length N, each once, in rank order; of several lengths, the shortest first."""
    if form != "text" and by == "skeleton":
        raise QueryError(f"skeletons have no form {form}; choose --format text, or --by task")
    from prag_asp.dataset.jsonl import Record

    first = split_actions(prefix or "")
    require_writable(output)
    with progress() as tell:
        space = asked.spaces(tell)
        words = islice(space.words(by, first), limit)
        with writer(output) as write:
            if form == "text":
                for word in words:
                    write(" ".join(word))
            else:
                line = options.line_form(form, space.domain)
                for task in space.narrate(words):
                    write(line(Record(task)))
