"""A PDDL file being read: its names, numbers and typed lists, and the messages about its mistakes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import zip_longest
from pathlib import Path
from typing import NoReturn

from prag_asp.errors import DomainError
from prag_asp.pddl.definitions import OBJECT, Declaration
from prag_asp.pddl.syntax.expressions import Expression, Word
from prag_asp.pddl.syntax.sections import unexpected
from prag_asp.program.problem import Problem
from prag_asp.wording import did_you_mean, nearest, plural

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)")
LIKE_NUMBER = re.compile(r"[-+]?[\d.]+")
ATTACHED = re.compile(r"-([^\W\d][^?:]*)?")
"""The sign that precedes a type; some files omit the blank after it."""


@dataclass
class PddlSource:
    """A file whose mistakes are reported with path and line; `warnings` are about irregularities that are accepted."""

    path: Path
    warnings: list[Problem] = field(default_factory=list)

    def refuse(self, line: int, text: str) -> NoReturn:
        """Raise a DomainError that gives a line."""
        raise DomainError(f"{self.path}:{line}: {text}")

    def warn(self, line: int, text: str, name: str) -> None:
        """Add a warning."""
        self.warnings.append(Problem(self.path, line, text, name))

    def check_known(self, kind: str, name: Word, declared: Iterable[str], section: str) -> None:
        """Refuse a name that is not declared."""
        if name not in declared:
            hint = did_you_mean(name, declared, f"declare it in {section}")
            self.refuse(name.line, f"unknown {kind} {name}; {hint}")

    def check_new(self, kind: str, name: Word, declared: Iterable[str]) -> None:
        """Refuse a second declaration of a name."""
        if name in declared:
            self.refuse(name.line, f"the {kind} {name} is declared twice; remove one, or rename it")

    def signature(self, kind: str, name: Word, arity: int, declared: Mapping[str, Declaration]) -> Declaration:
        """Return the declaration of a predicate or a function used with `arity` arguments."""
        self.check_known(kind, name, declared, f":{kind}s")
        expected = len(declared[name].types)
        if expected != arity:
            self.refuse(name.line, f"{name} takes {plural(expected, 'argument')}, not {arity}; fix them")
        return declared[name]

    def list_of(self, parts: Iterable[Expression | Word], line: int) -> Expression:
        """Return the next part, which must be a list."""
        part = next(iter(parts), None)
        if isinstance(part, Expression):
            return part
        self.refuse(part.line if part else line, unexpected(part) if part else "something is missing here; write it")

    def name_of(self, part: Expression | Word) -> Word:
        """Return a part, which must be a name."""
        if isinstance(part, Expression):
            self.refuse(part.line, unexpected(part.head or "("))
        if part[0] in ":?" or part == "-":
            self.refuse(part.line, unexpected(part))
        return part

    def number(self, text: Word) -> Fraction:
        """Return a number."""
        if not NUMBER.fullmatch(text):
            self.refuse(text.line, f"{text} is not a number; write one such as 2 or 0.5")
        return Fraction(text)

    def typed_words(
        self, parts: Iterable[Expression | Word], types: dict[str, tuple[str, ...]] | None, *, variables: bool = False
    ) -> Iterator[tuple[Word, tuple[str, ...]]]:
        """Yield the words of a typed list, each with its alternative types, of which there may be none.

        An unknown type is added to `types` with a warning, unless it seems to be misspelt; if `types` is None, any type
        is valid. A word such as ``-a`` is the type of the names before it, or a name if there are none or if another
        sign follows.

        Raises:
            DomainError: a sign has no name before it or no type after it, or such a word is not certainly a type.
        """
        waiting: list[Word] = []
        given = tuple(parts)
        pairs = iter(zip_longest(given, given[1:]))
        for part, following in pairs:
            if isinstance(part, Word) and ATTACHED.fullmatch(part):
                if part != "-" and not variables and (not waiting or following == "-"):
                    waiting.append(self.name_of(part))
                    continue
                kind = Word(part[1:], part.line) if part != "-" else next(pairs, (None,))[0]
                if not waiting and kind is not None:
                    self.refuse(part.line, f"no name precedes {str(part)!r}; write names before it, or remove it")
                if part != "-" and not variables and self._is_unknown(kind, types):
                    text = f"{part} after {waiting[-1]} is neither a type that is declared nor the name before a type"
                    self.refuse(
                        part.line, f"{text}; write '- {kind}' for a type, or put the name elsewhere in the list"
                    )
                kinds = self.kinds(kind, part.line, types)
                yield from ((name, kinds) for name in waiting)
                waiting = []
            elif variables and isinstance(part, Word) and part[0] == "?" and len(part) > 1:
                waiting.append(Word(part[1:], part.line))
            elif variables:
                line, text = (part.line, str(part)) if isinstance(part, Word) else (part.line, "(")
                self.refuse(line, f"{text!r} is not expected here; write a variable such as ?x")
            else:
                waiting.append(self.name_of(part))
        yield from ((name, ()) for name in waiting)

    def kinds(
        self, kind: Expression | Word | None, line: int, types: dict[str, tuple[str, ...]] | None
    ) -> tuple[str, ...]:
        """Return the alternative types that follow a sign, and check them as `typed_words` does."""
        if kind is None:
            self.refuse(line, "a type is missing after '-'; write it")
        if isinstance(kind, Expression) and (kind.head != "either" or not kind.rest):
            self.refuse(kind.line, f"{str(kind.head) or '('!r} is not expected here; write a type, or (either a b)")
        names = [self.name_of(each) for each in ([kind] if isinstance(kind, Word) else kind.rest)]
        for each in names if types is not None else ():
            self._check_type(each, types)
        return tuple(dict.fromkeys(map(str, names)))

    @staticmethod
    def _is_unknown(kind: Expression | Word | None, types: dict[str, tuple[str, ...]] | None) -> bool:
        """Return whether a word neither is a type nor resembles one."""
        known = isinstance(kind, Word) and (types is None or kind in types or nearest(kind, set(types) - {OBJECT}))
        return not known

    def _check_type(self, kind: Word, types: dict[str, tuple[str, ...]] | None) -> None:
        if types is not None and kind not in types:
            if nearest(kind, set(types) - {OBJECT}):
                self.check_known("type", kind, types, ":types")
            self.warn(kind.line, f"the type {kind} is not declared; declare it in :types", "undeclared")
            types[str(kind)] = ()
