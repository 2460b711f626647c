"""Parse every file of a program on its own, so that a mistake in one is not blamed on the next."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache

from clingo.ast import AST, ASTType, parse_string

from prag_asp.integers import TOLD, shortened, too_large
from prag_asp.program.problem import Problem
from prag_asp.program.sources import Source
from prag_asp.program.syntax import Statement
from prag_asp.program.tokens import blanked, open_comment

MESSAGE = r"<string>:(?P<line>\d+):(?P<column>\d+)[-\d:]*: error: (?P<words>(?s:.*))"
TOKEN = r"#?[\w']+|:-|\S"
EXPECTED = r"expecting (.*)"
DEEPEST = 300
"""The deepest nesting of parentheses: deeper terms exhaust the stack of clingo or of readers of its terms."""

IN_CALLBACK = "error in callback"
"""clingo's message after a Python function that it calls has failed."""

STAND_IN = "$"
"""A character that clingo reads in strings and comments only."""


def parse_sources(sources: Iterable[tuple[Source, bool]]) -> tuple[list[Statement], list[Problem]]:
    """Return the statements and the syntax errors of sources, each with whether it is the domain's own."""
    statements: list[Statement] = []
    problems: list[Problem] = []
    for source, own in sources:
        found, broken = _parsed(source, own)
        statements += found
        problems += [broken] if broken else []
    return statements, problems


@lru_cache(maxsize=64)
def _parsed(source: Source, own: bool) -> tuple[tuple[Statement, ...], Problem | None]:
    """Return the statements of a source, or its first problem."""
    statements: list[Statement] = []
    broken = _character_problem(source) or _depth_problem(source)
    broken = broken or _parse(source, own, statements) or number_problem(source)
    return (() if broken else tuple(statements)), broken


def _depth_problem(source: Source) -> Problem | None:
    """Return where parentheses are nested deeper than clingo, or what reads its terms, can follow."""
    if source.text.count("(") <= DEEPEST:
        return None
    depth = 0
    for number, line in enumerate(blanked(source.text).split("\n"), 1):
        for character in line:
            depth = max(depth + (character == "(") - (character == ")"), 0)
            if depth > DEEPEST:
                told = f"parentheses are nested more than {DEEPEST} deep; flatten the term"
                return Problem(source.path, number, told)
    return None


@lru_cache(maxsize=64)
def number_problem(source: Source) -> Problem | None:
    """Return the first number of a source that clingo would change without a word."""
    for position, digits in too_large(blanked(source.text)):
        line = source.text.count("\n", 0, position) + 1
        return Problem(source.path, line, f"the number {shortened(digits)} is out of range: {TOLD}")
    return None


def _character_problem(source: Source) -> Problem | None:
    """Return the first character that clingo cannot read there; some of them would end the process."""
    if source.text.isascii() and "\0" not in source.text:
        return None
    for number, line in enumerate(blanked(source.text).split("\n"), 1):
        for character in line:
            if not character.isascii() or character == "\0":
                return Problem(
                    source.path,
                    number,
                    f"the character {character!r} cannot stand here; "
                    'use a-z, A-Z, 0-9 and _ in names, and put other text into "quotes" or a comment',
                )
    return None


def _parse(source: Source, own: bool, statements: list[Statement]) -> Problem | None:
    """Append the statements of a source; return its first syntax error, for the others follow from it."""
    messages: list[str] = []
    nodes: list[AST] = []
    text = source.text
    try:
        if not text.isascii():
            parse_string(
                re.sub(r"[^\x00-\x7f]", STAND_IN, text),
                lambda _: None,
                logger=lambda _, said: messages.append(said),
            )
        parse_string(text, nodes.append, logger=lambda _, said: messages.append(said))
    except RuntimeError as error:
        require_memory(error)
        return _syntax_problem(source, messages)
    part, parameters = "base", tuple[str, ...]()
    for node in nodes:
        kind = node.ast_type
        if kind == ASTType.Program:
            part, parameters = node.name, tuple(each.name for each in node.parameters)
        if kind != ASTType.Comment:
            line = node.location.begin.line
            statements.append(Statement(node, kind, source.path, line, own, part, parameters))
    return None


def require_memory(error: RuntimeError) -> None:
    """Raise a MemoryError if clingo failed in a Python function: nothing else makes those fail.

    Raises:
        MemoryError: a function has failed.
    """
    if IN_CALLBACK in str(error):
        raise MemoryError(IN_CALLBACK) from None


def _syntax_problem(source: Source, messages: list[str]) -> Problem:
    said = re.match(MESSAGE, messages[0]) if messages else None
    if not said:
        return Problem(
            source.path,
            1,
            f"clingo cannot read this file: {' '.join(messages) or 'no reason given'}; fix it",
        )
    line, words = int(said["line"]), " ".join(said["words"].split())
    if "EOF" in words:
        return _unfinished(source)
    column = int(said["column"])
    code = source.text.split("\n")[line - 1]
    found = re.match(TOKEN, code.encode()[column - 1 :].decode(errors="replace"))
    problem = f"unexpected {found[0] if found else 'end of line'} at column {column}"
    if "lexer error" in words:
        todo = "close the string on the line it begins on" if found and found[0] == '"' else "remove it"
    elif not code.encode()[: column - 1].strip():
        todo = "end the statement before it with a period"
    else:
        expected = re.search(EXPECTED, words)
        todo = f"clingo expects {expected[1]} here" if expected else "fix the statement before it"
    return Problem(source.path, line, f"{problem}; {todo}")


def _unfinished(source: Source) -> Problem:
    """Return the problem of a file that ends within a comment or a statement."""
    comment = open_comment(source.text)
    if comment is not None:
        line = source.text.count("\n", 0, comment) + 1
        return Problem(source.path, line, "this comment is never closed; close it with *%")
    line = blanked(source.text).rstrip().count("\n") + 1
    return Problem(source.path, line, "the file ends within a statement; end the statement with a period")
