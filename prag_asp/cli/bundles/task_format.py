"""How a command prints tasks: the forms of a line, and the language that instructions are in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.options import Function, bundled
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.domain.load import Domain

FORMS = ("text", "sentences", "instructions", "jsonl")
INSTRUCTIONS = "instructions"
ENGLISH, USUAL = "en", "default"
LEVELS = ("vague", USUAL, "exact")

FORM = click.option(
    "--format", "form", type=click.Choice(FORMS), default="text", show_default=True,
    help="Actions; sentences by the domain's [language]; what to tell who sees the scene; or all that is known of a "
    "task.",
)  # fmt: skip
SPOKEN = (
    click.option(
        "--language", metavar="LANGUAGE", shell_complete=shell_completion.languages,
        help="Language of instructions: en, or one that the domain has words for, such as de.  [default: en]",
    ),
    click.option(
        "--level", type=click.Choice(LEVELS),
        help="Instructions that say what is to be so at the end; what is to be done; or also what each action is for.",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Telling:
    """How a command line wants tasks told."""

    form: str
    language: str | None
    level: str | None

    def line(self, domain: Domain, seed: int = 0) -> Callable[[Record], str]:
        """Return how a record is written as one line; the seed draws the phrasing of instructions.

        Raises:
            QueryError: the domain does not speak the language, or the options do not go together.
        """
        from prag_asp.dataset.jsonl import write_line
        from prag_asp.dataset.language import instruction, instruction_writer_of

        self.check()
        if self.form == INSTRUCTIONS:
            teller, level = instruction_writer_of(domain, self.language or ENGLISH), self.level or USUAL
            return lambda record: str(getattr(teller.instructions(record.task, seed), level))
        forms: dict[str, Callable[[Record], str]] = {
            "text": lambda record: str(record.task),
            "sentences": lambda record: instruction(record.task, domain.settings.language),
            "jsonl": write_line,
        }
        return forms[self.form]

    def check(self) -> None:
        """Refuse options that go with instructions alone.

        Raises:
            QueryError: one is given for another form.
        """
        for option, given in {"--language": self.language, "--level": self.level}.items():
            if given is not None and self.form != INSTRUCTIONS:
                raise QueryError(f"{option} {given} goes with --format instructions; got --format {self.form}")


def tells(function: Function) -> Function:
    """Give a command the options of how tasks are told, as one value `telling`."""
    return bundled(function, "telling", Telling, (FORM, *SPOKEN))


def tells_in(form: Callable[[Function], Function]) -> Callable[[Function], Function]:
    """Give a command the same with forms of its own."""
    options: Sequence[Any] = (form, *SPOKEN)
    return lambda function: bundled(function, "telling", Telling, options)
