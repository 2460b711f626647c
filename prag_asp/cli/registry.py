"""The commands of ``prag-asp``; each one is imported on first use."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib import import_module
from keyword import iskeyword
from typing import Any

import click

from prag_asp.cli import exit_control
from prag_asp.cli.exits import MEANINGS, Exit
from prag_asp.cli.terminal import say, shown_progress, tell_line
from prag_asp.integers import with_short_numbers

PROGRAM, COMPLETION = "prag-asp", "_PRAG_ASP_COMPLETE"
"""The name of the program, and the environment variable through which a shell requests completions."""

COMMANDS = {
    "audit": "audit",
    "check": "check",
    "compare": "evaluate",
    "completion": "completion",
    "count": "count",
    "diversity": "diversity",
    "domains": "domains",
    "enumerate": "enumerate",
    "evaluate": "evaluate",
    "explain": "explain",
    "explore": "explore",
    "export": "export",
    "generate": "generate",
    "import": "importing",
    "learn": "learn",
    "merge": "merge",
    "models": "models",
    "new": "domains",
    "power": "power",
    "render": "render",
    "report": "reporting",
    "sample": "sample",
    "scenario": "scenario",
    "similarity": "similarity",
    "split": "split",
    "stats": "stats",
    "suite": "suite",
    "task": "task",
    "validate": "validate",
    "verify": "verify",
}
"""The commands, each with the module in `prag_asp.cli.commands` that defines it."""

GROUPS = {
    "Define": ("domains", "new", "check", "import", "explain"),
    "Count and sample": ("count", "explore", "task", "sample", "enumerate", "scenario", "split", "stats"),
    "Check with physics": ("validate", "learn", "render"),
    "Data": ("generate", "merge", "verify", "report", "suite", "export"),
    "Compare": ("similarity", "diversity", "audit"),
    "Learn and evaluate": ("evaluate", "compare", "power"),
    "Any program": ("models",),
    "Shell": ("completion",),
}
"""The commands, grouped, in the order in which help lists them."""


SHORT_HELP = 88
"""The maximum number of characters of a command's help in the list of commands."""


class WholeSentences(click.Group):
    """A group whose help lists its commands with whole sentences, each of which may take several lines."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands, each with the first sentence of its help text."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, each.get_short_help_str(SHORT_HELP)) for name, each in self.commands.items()])


class Commands(click.Group):
    """A group that imports a command on first use, and turns errors into one line and an exit code."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return sorted(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command with a given name, or None if there is none."""
        if cmd_name not in COMMANDS:
            return None
        from prag_asp.cli.options import add_limits

        name = f"{cmd_name}_" if iskeyword(cmd_name) else cmd_name
        command = getattr(import_module(f"prag_asp.cli.commands.{COMMANDS[cmd_name]}"), name)
        assert isinstance(command, click.Command)
        add_limits(command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands in groups, each with the first sentence of its help text."""
        for title, names in GROUPS.items():
            commands = {name: self.get_command(ctx, name) for name in names}
            with formatter.section(title):
                formatter.write_dl(
                    [(name, each.get_short_help_str(SHORT_HELP)) for name, each in commands.items() if each]
                )

    def main(self, args: Sequence[str] | None = None, prog_name: str | None = None, *_: Any, **__: Any) -> Any:
        """Run a command line, or print the completions that a shell requests, and return the exit code."""
        name = prog_name or PROGRAM
        if os.environ.get(COMPLETION):
            from prag_asp.cli.shell_completion import complete

            return complete(self, name, COMPLETION)
        if hasattr(sys, "set_int_max_str_digits"):
            sys.set_int_max_str_digits(0)
        with exit_control.running(), shown_progress():
            try:
                with self.make_context(name, list(sys.argv[1:] if args is None else args)) as context:
                    self.invoke(context)
                return Exit.DONE
            except click.exceptions.Exit as stop:
                return stop.exit_code
            except click.ClickException as error:
                where = error.ctx if isinstance(error, click.UsageError) else None
                if where is None or isinstance(error, getattr(click.exceptions, "NoArgsIsHelpError", ())):
                    error.show()  # without a command, a group prints its help
                else:
                    message = " ".join(with_short_numbers(error.format_message()).split()).rstrip(".")
                    tell_line(f"{where.command_path}: {message}; see {where.command_path} --help")
                return Exit.USAGE if isinstance(error, click.UsageError) else Exit.BAD_INPUT
            except exit_control.ERRORS as error:
                return exit_control.report_end(error)


def _print_versions(context: click.Context, parameter: click.Parameter, requested: bool) -> None:
    if requested and not context.resilient_parsing:
        from prag_asp.versions import versions

        say(versions())
        context.exit()


CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 110}
CODES = "\n".join(["\b", "Exit codes:", *(f"{int(code):5}  {meaning}" for code, meaning in MEANINGS.items())])


@click.group(cls=Commands, epilog=CODES, context_settings=CONTEXT)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_print_versions,
    help="Show the versions of prag_asp, clingo and PyBullet, and exit.",
)  # fmt: skip
def cli() -> None:
    """Robot manipulation tasks from logic programs: counted exactly, sampled exactly, checked with physics.

    DOMAIN is a shipped domain (see `prag-asp domains`), a folder with a domain.lp, or files: one or more .lp files, or
    - for standard input, or a domain and a problem in PDDL (two .pddl files). The domain.toml and learned.lp of a
    folder are read too; domain files have no settings unless --settings names a file.
    """
