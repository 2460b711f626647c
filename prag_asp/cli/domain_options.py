"""Options that define a domain and a task space."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import exit_control, shell_completion
from prag_asp.cli.arguments import parse_constant_options, parse_length, parse_lengths
from prag_asp.cli.options import Decorator, grouped
from prag_asp.cli.terminal import tell_line
from prag_asp.errors import DomainError, QueryError
from prag_asp.safe_reading import STANDARD_INPUT
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.dataset.scenario import Scenario
    from prag_asp.domain.load import Domain
    from prag_asp.program.sources import Source
    from prag_asp.space.task_space import TaskSpace


@dataclass(frozen=True)
class DomainOptions:
    """The domain and the task space defined by a command line.

    `recorded` is a task read from a file, which has constants for the domain; constants on the command line override
    them.
    """

    names: tuple[str, ...] = ()
    constants: tuple[str, ...] = ()
    settings: str | None = None
    rules: tuple[str, ...] = ()
    encodings: str | None = None
    flat: bool = False
    learned: bool = True
    length: int | Sequence[int] = 0
    engine: str = "auto"
    where: tuple[str, ...] = ()
    cached: bool = True
    trust: bool = False
    strict: bool = False
    untimed: bool = False
    recorded: Record | None = None

    def of(self, record: Record, folder: Path) -> DomainOptions:
        """Return the options for a task read from a file, with its constants; its domain is the default."""
        from prag_asp.dataset.task_origin import named_domain

        recorded = record if record.task.constants else None
        names = self.names or (named_domain(record.task.domain, record.place, folder),)
        return replace(self, names=names, recorded=recorded)

    def of_scenario(self, scenario: Scenario) -> DomainOptions:
        """Return the options for a scenario, with its constants; its domain is the default."""
        from prag_asp.dataset.task_origin import named_domain

        names = self.names or (named_domain(scenario.domain, f"scenario {scenario}", Path()),)
        constants = tuple(f"{name}={value}" for name, value in scenario.constants.items())
        return replace(self, names=names, constants=(*constants, *self.constants))

    def domain(self, *, tell: bool = True) -> Domain:
        """Load the domain and, with `tell`, print the number of warnings about it.

        Raises:
            DomainError: the domain has errors, or a task read from a file has wrong constants.
        """
        from prag_asp.domain.load import load_domain

        recorded = {} if self.recorded is None else self.recorded.task.constants
        if self.settings is None:
            _note_unread_settings(self.names)
        try:
            domain = load_domain(
                *map(source_of, self.names),
                constants={**recorded, **parse_constant_options(self.constants)},
                settings=self.settings,
                rules=self.rules,
                encodings=self.encodings,
                flat=self.flat,
                trust=self.trust,
                learned=self.learned,
                strict=self.strict,
                untimed=self.untimed,
            )
        except DomainError as error:
            if self.recorded is None:
                raise
            raise DomainError(*(f"{self.recorded.place}: {line}" for line in error.lines)) from None
        if domain.warnings and tell:
            warnings = plural(len(domain.warnings), "warning")
            tell_line(f"{warnings} about {domain.label}; see prag-asp check {' '.join(self.names)}")
        return domain

    def space(self, tell: Callable[[str], None] | None = None, domain: Domain | None = None) -> TaskSpace:
        """Return the task space of the requested domain, or of a given one; `tell` receives progress reports."""
        return self._space_of(domain or self.domain(), self.one_length, tell)

    def spaces(self, tell: Callable[[str], None] | None = None) -> TaskSpace:
        """Return the task space of all requested lengths."""
        return self._space_of(self.domain(), self.length, tell)

    def _space_of(self, domain: Domain, length: int | Sequence[int], tell: Callable[[str], None] | None) -> TaskSpace:
        from prag_asp.space.task_space import TaskSpace

        limits = exit_control.limits(cached=self.cached)
        space = TaskSpace(domain, length, engine=self.engine, progress=tell, limits=limits)
        return space.where(*self.conditions())

    @property
    def one_length(self) -> int:
        """The length, for a command that takes only one length."""
        assert isinstance(self.length, int), "several lengths are refused where the option is read"
        return self.length

    def conditions(self) -> tuple[str, ...]:
        """Return the conditions on tasks.

        Raises:
            QueryError: a condition is empty.
        """
        if not all(map(str.strip, self.where)):
            raise QueryError("condition '': write one, such as 'uses apple' or 'has at least 2 grasp'")
        return self.where


def domain_options(*options: Decorator) -> Decorator:
    """Return a decorator that adds options to a command, which receives them as a single argument `request`."""
    return grouped("request", DomainOptions, options)


def _note_unread_settings(names: Sequence[str]) -> None:
    """Print a note, once, that the settings of a folder are not read if its domain.lp is given as a file."""
    for name in names:
        settings = Path(name).parent / "domain.toml"
        if Path(name).name == "domain.lp" and settings.is_file():
            printed: dict[str, Any] = click.get_current_context().meta
            if printed.setdefault(name, settings) is settings:
                tell_line(f"note: {settings} is not read with a file; give its folder, or --settings {settings}")


def source_of(name: str) -> str | Source:
    """Return the name of a program, or standard input as a source, which is read only once per command."""
    if name != STANDARD_INPUT:
        return name
    from prag_asp.program.sources import standard_input

    cache: dict[str, Any] = click.get_current_context().meta
    if STANDARD_INPUT not in cache:
        cache[STANDARD_INPUT] = standard_input()
    source: Source = cache[STANDARD_INPUT]
    return source


PROGRAM = (
    click.option(
        "-c", "--const", "constants", metavar="NAME=VALUE", multiple=True,
        help="Value for a #const of the domain, such as discs=4.",
    ),
    click.option(
        "--settings", metavar="FILE", shell_complete=shell_completion.files,
        help="File to read instead of the folder's domain.toml; by default, a domain given as files has no settings.",
    ),
    click.option(
        "--rule", "rules", metavar="RULE", multiple=True, shell_complete=shell_completion.rules,
        help="Rule to add, such as no_undo or 'at_most(grasp,2)'.",
    ),
    click.option(
        "--encodings", metavar="DIR", shell_complete=shell_completion.files,
        help="Folder of encodings to use instead of the shipped ones.",
    ),
    click.option("--flat", is_flag=True, help="Ignore the composites: any sequence of actions may be a plan."),
    click.option(
        "--learned/--no-learned", default=True, help="Read learned.lp if the domain has one.  [default: learned]"
    ),
    click.option("--strict", is_flag=True, help="Treat warnings of `prag-asp check` as errors."),
    click.option("--untimed", is_flag=True, help="Read durative actions of PDDL as instantaneous ones."),
)  # fmt: skip
"""Options for loading a domain."""

DOMAIN = (
    click.argument(
        "names", metavar="DOMAIN...", nargs=-1, required=True, shell_complete=shell_completion.domains
    ),
    *PROGRAM,
)  # fmt: skip
OF_FILE = (
    click.option(
        "--domain", "names", metavar="DOMAIN", multiple=True, shell_complete=shell_completion.domains,
        help="Domain of the tasks; repeat the option for a domain of several files.  [default: that of each task]",
    ),
    *PROGRAM,
)  # fmt: skip
"""Options for the domain of the tasks in a file, and for loading it."""

WHERE = click.option(
    "--where", metavar="CONDITION", multiple=True, shell_complete=shell_completion.conditions,
    help="Condition on tasks, such as 'uses apple', 'has at least 2 grasp' or 'loop-free'; may be repeated.",
)  # fmt: skip
LENGTH = click.option(
    "-n", "--length", type=parse_length, required=True, metavar="N", help="Number of actions in a task."
)
LENGTHS = click.option(
    "-n", "--length", type=parse_lengths, required=True, metavar="N|A..B|N,M",
    help="Number of actions in a task, all numbers from A to B, or several.",
)  # fmt: skip
ENGINE = (
    WHERE,
    click.option(
        "--engine", default="auto", show_default=True, metavar="ENGINE", shell_complete=shell_completion.engines,
        help="Counting engine: auto, automaton, clingo, sat, sharp or symbolic.",
    ),
    click.option(
        "--cache/--no-cache", "cached", default=True,
        help="Cache results that took a long time to compute, for later runs.  [default: cache]",
    ),
)  # fmt: skip
"""Options for conditions on tasks, and for the engine that counts them."""

SPACE = (*DOMAIN, LENGTH, *ENGINE)
SPACES = (*DOMAIN, LENGTHS, *ENGINE)
