"""The commands of ``prag-asp``: the one list of them, each imported when it is asked for."""

from __future__ import annotations

import os
from importlib import import_module
from keyword import iskeyword
from typing import Any

import click

from prag_asp.cli.exits import MEANINGS
from prag_asp.cli.terminal import Command, say

PROGRAM, COMPLETION = "prag-asp", "_PRAG_ASP_COMPLETE"
"""The name of the program, and the variable by which a shell asks it for completions."""

COMMANDS = {
    "check": "check",
    "completion": "completion",
    "count": "count",
    "domains": "domains",
    "enumerate": "enumerate",
    "explain": "explain",
    "export": "export",
    "generate": "generate",
    "import": "importing",
    "learn": "learn",
    "merge": "merge",
    "models": "models",
    "new": "domains",
    "render": "render",
    "sample": "sample",
    "split": "split",
    "stats": "stats",
    "suite": "suite",
    "task": "task",
    "validate": "validate",
    "verify": "verify",
}
"""The commands, each with the module of `prag_asp.cli.commands` that has it under the command's name."""


class Commands(Command):
    """A group that imports a command when it is asked for; help asks for all."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return sorted(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command of a name, None where there is none."""
        if cmd_name not in COMMANDS:
            return None
        from prag_asp.cli.options import with_limits

        name = f"{cmd_name}_" if iskeyword(cmd_name) else cmd_name
        found = getattr(import_module(f"prag_asp.cli.commands.{COMMANDS[cmd_name]}"), name)
        assert isinstance(found, click.Command)
        return with_limits(found)

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command, or answer a shell that asks for completions, and return the exit code."""
        if COMPLETION in os.environ:
            from prag_asp.cli.shells import add_shells

            add_shells()
        return super().main(*args, **{"prog_name": PROGRAM, "complete_var": COMPLETION, **kwargs})


def _show_versions(context: click.Context, parameter: click.Parameter, asked: bool) -> None:
    if asked and not context.resilient_parsing:
        from prag_asp.versions import versions

        say(versions())
        context.exit()


CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 110}
CODES = "\n".join(["\b", "Exit codes:", *(f"{int(code):5}  {meaning}" for code, meaning in MEANINGS.items())])


@click.group(cls=Commands, epilog=CODES, context_settings=CONTEXT)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_show_versions,
    help="Show the versions of prag_asp, clingo and PyBullet, and exit.",
)  # fmt: skip
def cli() -> None:
    """Robot manipulation tasks from logic programs: counted exactly, drawn exactly, checked by physics.

    DOMAIN is a shipped domain (see `prag-asp domains`), a folder with a domain.lp, or files: one or more that end in
    .lp, or - for standard input, or a domain and its problem in PDDL, two files that end in .pddl. Of a folder, its
    domain.toml and learned.lp are read too; files come without, unless --settings names a file.
    """
