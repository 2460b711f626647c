"""New values for the ``#const`` statements of a domain, as with clingo's option ``-c``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import clingo
from clingo.ast import ASTType

from prag_asp.errors import DomainError
from prag_asp.integers import TOLD, shortened, too_large
from prag_asp.program.finite.checks import out_of_range
from prag_asp.program.finite.constants_in_range import operation_out_of_range, term_of
from prag_asp.program.parse import parse_sources
from prag_asp.program.problem import raise_problems
from prag_asp.program.sources import Source
from prag_asp.program.syntax import Statement, with_replaced
from prag_asp.program.tokens import blanked
from prag_asp.wording import did_you_mean

Constant = int | str | clingo.Symbol
"""A value: an integer, a term, or the text of a term."""

LONGEST = 1000
"""The maximum number of characters in a value; clingo crashes on terms that are nested too deeply."""


def parse_constants(constants: Mapping[str, Constant]) -> dict[str, str]:
    """Return the values of constants as text, in the alphabetical order of their names.

    Raises:
        DomainError: a value is not a clingo term, or contains a number out of range.
    """
    values: dict[str, str] = {}
    for name, value in sorted(constants.items()):
        text = str(value)
        readable = len(text) <= LONGEST and "\0" not in text and blanked(text).isascii() and not isinstance(value, bool)
        for _, digits in too_large(blanked(text)) if readable else ():
            raise DomainError(f"constant {name}: the number {shortened(digits)} is out of range: {TOLD}")
        try:
            wrong = operation_out_of_range(term_of(text), {}) if readable else None
            if wrong is not None:
                raise DomainError(f"constant {name}: {out_of_range(wrong)}")
            term = clingo.parse_term(text, logger=lambda *_: None) if readable else None
        except RuntimeError:
            term = None
        if term is None:
            shown = text if len(text) <= 40 else f"{text[:40]}..."
            problem = f"constant {name}: {shown!r} is not a term"
            raise DomainError(f"{problem}; write a number such as 8, or a term such as f(a)")
        values[name] = str(term)
    return values


def set_constants(sources: Sequence[Source], constants: Mapping[str, str], domain: str) -> tuple[Source, ...]:
    """Return the files of a domain with new values in their ``#const`` statements; line numbers do not change.

    All readers of the program (the linter, engines, the cache) therefore see the same value.

    Raises:
        DomainError: no file declares a constant, a constant must not be set, or a file cannot be parsed.
    """
    statements, problems = parse_sources((source, True) for source in sources)
    raise_problems(problems)
    declared: dict[str, list[Statement]] = {}
    for statement in statements:
        if statement.kind == ASTType.Definition:
            declared.setdefault(statement.node.name, []).append(statement)
    for name in constants:
        if name not in declared:
            there_are = f"there {'is' if len(declared) == 1 else 'are'} {', '.join(sorted(declared))}"
            otherwise = there_are if declared else f"declare it there with #const {name} = ..."
            raise DomainError(
                f"constant {name}: {domain} has no such #const; {did_you_mean(name, declared, otherwise)}"
            )
        raise_problems(
            each.problem(f"#const {name} says [override], so it cannot be set; remove [override]")
            for each in declared[name]
            if not each.node.is_default
        )
    values = {each: f"#const {name} = {constants[name]}." for name in constants for each in declared[name]}
    changed: list[Source] = []
    for source in sources:
        replaced = {each: text for each, text in values.items() if each.path == source.path}
        changed.append(replace(source, text=with_replaced(source.text, replaced)))
    return tuple(changed)
