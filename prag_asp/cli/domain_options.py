"""What a command line asks for: a domain, and a task space of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import exit_control
from prag_asp.cli.terminal import tell_line
from prag_asp.errors import DomainError, QueryError
from prag_asp.safe_reading import STANDARD_INPUT
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.domain.load import Domain
    from prag_asp.program.sources import Source
    from prag_asp.space.limits import Limits
    from prag_asp.space.task_space import TaskSpace


@dataclass(frozen=True)
class Asked:
    """The domain and the task space that a command line asks for.

    `recorded` is a task of a file, made with constants of the domain; those of the command line go before its own.
    """

    names: tuple[str, ...] = ()
    constants: tuple[str, ...] = ()
    settings: str | None = None
    rules: tuple[str, ...] = ()
    encodings: str | None = None
    flat: bool = False
    learned: bool = True
    length: int | range = 0
    engine: str = "auto"
    where: tuple[str, ...] = ()
    cached: bool = True
    trust: bool = False
    strict: bool = False
    recorded: Record | None = None

    def of(self, record: Record, folder: Path) -> Asked:
        """Return the same for the task of a file in a folder: its domain where none is asked for, and its constants."""
        from prag_asp.dataset.task_origin import named_domain

        recorded = record if record.task.constants else None
        return replace(self, names=self.names or (named_domain(record, folder),), recorded=recorded)

    def domain(self, *, tell: bool = True) -> Domain:
        """Load the domain; with `tell`, say how many warnings there are about it.

        Raises:
            DomainError: something is wrong with it, or with the constants that a task of a file names.
        """
        try:
            domain = self._load({} if self.recorded is None else self.recorded.task.constants)
        except DomainError as error:
            if self.recorded is None:
                raise
            raise DomainError(*(f"{self.recorded.place}: {line}" for line in error.lines)) from None
        if domain.warnings and tell:
            told = plural(len(domain.warnings), "warning")
            tell_line(f"{told} about {domain.label}; see prag-asp check {' '.join(self.names)}")
        return domain

    def _load(self, recorded: Mapping[str, str]) -> Domain:
        from prag_asp.domain.load import load_domain

        if self.settings is None:
            _note_unread(self.names)
        return load_domain(
            *map(given, self.names),
            constants={**recorded, **parse_constant_options(self.constants)},
            settings=self.settings,
            rules=self.rules,
            encodings=self.encodings,
            flat=self.flat,
            trust=self.trust,
            learned=self.learned,
            strict=self.strict,
        )

    def space(self, tell: Callable[[str], None] | None = None, domain: Domain | None = None) -> TaskSpace:
        """Return the task space of the domain, or of another one, which tells its progress to `tell`."""
        return self._space(self.one_length, tell, domain)

    def spaces(self, tell: Callable[[str], None] | None = None) -> TaskSpace:
        """Return the task space of the length, or of all lengths of a range."""
        return self._space(self.length, tell, None)

    def _space(self, length: int | range, tell: Callable[[str], None] | None, domain: Domain | None) -> TaskSpace:
        from prag_asp.space.task_space import TaskSpace

        limits = self._limits()
        space = TaskSpace(domain or self.domain(), length, engine=self.engine, progress=tell, limits=limits)
        return space.where(*self.where)

    @property
    def one_length(self) -> int:
        """The length, where a command takes no range."""
        assert isinstance(self.length, int), "a range is refused where the option is read"
        return self.length

    def conditions(self) -> tuple[str, ...]:
        """Return the conditions asked for.

        Raises:
            QueryError: one is empty.
        """
        if not all(map(str.strip, self.where)):
            raise QueryError("condition '': write one, such as 'uses apple' or 'has at least 2 grasp'")
        return self.where

    def _limits(self) -> Limits:
        """Return the limits; what is asked is checked on the way, before anything is loaded.

        Raises:
            QueryError: a condition is empty.
        """
        from prag_asp.space.limits import Limits

        self.conditions()
        seconds, memory, begun = exit_control.limits()
        return Limits(memory, seconds, self.cached, begun)


def _note_unread(names: Sequence[str]) -> None:
    """Say once that a folder's settings stay unread where its domain.lp is given as a file."""
    for name in names:
        settings = Path(name).parent / "domain.toml"
        if Path(name).name == "domain.lp" and settings.is_file():
            said: dict[str, Any] = click.get_current_context().meta
            if said.setdefault(name, settings) is settings:
                told = f"note: {settings} is not read with a file; give its folder, or --settings {settings}"
                tell_line(told)


def given(name: str) -> str | Source:
    """Return what a domain is given as; standard input is read once, however often its domain is loaded."""
    if name != STANDARD_INPUT:
        return name
    from prag_asp.program.sources import standard_input

    kept: dict[str, Any] = click.get_current_context().meta
    if STANDARD_INPUT not in kept:
        kept[STANDARD_INPUT] = standard_input()
    source: Source = kept[STANDARD_INPUT]
    return source


def parse_constant_options(options: Sequence[str]) -> dict[str, str]:
    """Return the constants that options of the form NAME=VALUE set.

    Raises:
        QueryError: an option is of another form, or a constant is set twice.
    """
    found: dict[str, str] = {}
    for option in options:
        name, equals, value = option.partition("=")
        if not equals or not name.strip():
            raise QueryError(f"--const {option}: write NAME=VALUE, such as discs=4")
        if name.strip() in found:
            raise QueryError(f"--const {name.strip()}: it is set twice; give it once")
        found[name.strip()] = value.strip()
    return found
