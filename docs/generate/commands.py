"""Write the reference of commands, generated from their ``--help``, into the page with the placeholder."""

from __future__ import annotations

from collections.abc import Iterator
from inspect import cleandoc
from typing import Any

import click

from prag_asp.cli import cli

MARK = "<!-- commands -->"
WIDTH = 10_000
"""The width of a usage line in columns, so that it is never wrapped."""


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Replace the placeholder of a page by the commands."""
    return markdown.replace(MARK, "\n".join(command_lines())) if MARK in markdown else markdown


def command_lines() -> Iterator[str]:
    """Yield the lines of the page for all commands, in the order of ``prag-asp --help``."""
    top = click.Context(cli, info_name="prag-asp", **cli.context_settings)
    yield from _command(top, "prag-asp")
    for name in cli.list_commands(top):
        command = cli.get_command(top, name)
        assert command is not None
        yield from _command(click.Context(command, info_name=name, parent=top), name)


def _command(context: click.Context, heading: str) -> Iterator[str]:
    """Yield the lines for one command: usage, description and options."""
    command = context.command
    usage = click.HelpFormatter(width=WIDTH)
    command.format_usage(context, usage)
    yield f"## {heading}\n"
    yield f"```text\n{usage.getvalue().strip().removeprefix('Usage: ')}\n```\n"
    yield f"{cleandoc(command.help or '')}\n"
    records = [record for parameter in command.get_params(context) if (record := parameter.get_help_record(context))]
    yield "| option | description |\n|---|---|"
    for names, description in filter(all, records):
        yield f"| {_cell(f'`{names}`')} | {_cell(description)} |"
    yield ""
    if isinstance(command, click.Group) and context.parent is not None:
        for name in command.list_commands(context):
            inner = command.commands[name]
            yield from _command(click.Context(inner, info_name=name, parent=context), f"{heading} {name}")


def _cell(text: str) -> str:
    """Return a text as one cell of a table."""
    return " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;").replace("[", "\\[")
