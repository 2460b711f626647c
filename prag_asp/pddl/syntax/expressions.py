"""The parser of a PDDL file, which returns nested expressions whose words carry their line numbers.

PDDL is a language of nested lists, but the files of many projects deviate from its grammar: names that begin with a
digit, arbitrarily nested effects, and requirements of other dialects. This parser only reads lists, and leaves all
further checks to `file_reader`, which reports problems with their lines.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from prag_asp.errors import DomainError
from prag_asp.wording import plural

DEEPEST = 100
"""The maximum nesting depth of parentheses."""

TOKEN = re.compile(r"[()]|\n|(?:;|//)[^\n]*|\??[^\s();?]+|\?")
"""A parenthesis, a line end, a comment, or a word; a variable may follow another word without a blank."""

COMMENT = (";", "//")


class Word(str):
    """A word in a file, with its line number."""

    line: int

    def __new__(cls, text: str, line: int) -> Word:
        """Return a word."""
        word = super().__new__(cls, text)
        word.line = line
        return word


@dataclass(frozen=True)
class Expression:
    """A parenthesized list: its words and lists in order, and the lines of its parentheses."""

    parts: tuple[Expression | Word, ...]
    line: int
    end: int

    @property
    def head(self) -> Word:
        """The first word, or an empty word if the list is empty or begins with a list."""
        return self.parts[0] if self.parts and isinstance(self.parts[0], Word) else Word("", self.line)

    @property
    def rest(self) -> tuple[Expression | Word, ...]:
        """The words and lists after the first one."""
        return self.parts[1:]

    @property
    def all_words(self) -> Iterator[Word]:
        """All words in this list and the lists in it, in order."""
        for each in self.parts:
            if isinstance(each, Word):
                yield each
            else:
                yield from each.all_words


def parse_expressions(path: Path, text: str, *, keep_case: bool = False) -> tuple[Expression, ...]:
    """Return the lists in a text without its comments, in lower case unless `keep_case` is true.

    Raises:
        DomainError: parentheses do not match or are nested more than `DEEPEST` deep, or a word is outside of them.
    """
    open_lists: list[tuple[int, list[Expression | Word]]] = []
    found: list[Expression] = []
    line = 1
    for token in TOKEN.findall(text if keep_case else text.lower()):
        if token == "\n":
            line += 1
        elif token == "(":
            open_lists.append((line, []))
            if len(open_lists) > DEEPEST:
                raise DomainError(
                    f"{path}:{line}: parentheses are nested more than {DEEPEST} deep; flatten the expression"
                )
        elif token == ")":
            if not open_lists:
                raise DomainError(
                    f"{path}:{line}: this ')' closes nothing; remove it, or look for a '(' that is missing"
                )
            begin, parts = open_lists.pop()
            done = Expression(tuple(parts), begin, line)
            if open_lists:
                open_lists[-1][1].append(done)
            else:
                found.append(done)
        elif not token.startswith(COMMENT):
            if not open_lists:
                raise DomainError(
                    f"{path}:{line}: {token!r} is not expected here; look for a missing parenthesis before it"
                )
            open_lists[-1][1].append(Word(token, line))
    if open_lists:
        open_ones = plural(len(open_lists), "'('", "'('")
        last = text.rstrip().count("\n") + 1
        raise DomainError(f"{path}:{last}: the file ends while {open_ones} is open; close each with a ')'")
    return tuple(found)
