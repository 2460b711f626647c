"""The parser of programs, which parses each file separately, so that a syntax error is reported in its own file."""

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
"""The maximum nesting depth of parentheses; deeper terms exhaust the stack of clingo or of functions on its terms."""

IN_CALLBACK = "error in callback"
"""clingo's message after a failure in a Python callback."""

STAND_IN = "$"
"""A character that clingo accepts only in strings and comments."""


def parse_sources(sources: Iterable[tuple[Source, bool]]) -> tuple[list[Statement], list[Problem]]:
    """Return the statements and syntax errors of sources, each given with a flag that is true for a domain's files."""
    statements: list[Statement] = []
    problems: list[Problem] = []
    for source, own in sources:
        parsed, problem = _parsed(source, own)
        statements += parsed
        problems += [problem] if problem else []
    return statements, problems


@lru_cache(maxsize=64)
def _parsed(source: Source, own: bool) -> tuple[tuple[Statement, ...], Problem | None]:
    """Return the statements of a source, or its first problem."""
    problem = _character_problem(source)
    if problem:
        return (), problem
    messages: list[str] = []
    nodes: list[AST] = []
    text = source.text
    try:
        if not text.isascii():
            parse_string(
                re.sub(r"[^\x00-\x7f]", STAND_IN, text),
                lambda _: None,
                logger=lambda _, message: messages.append(message),
            )
        parse_string(text, nodes.append, logger=lambda _, message: messages.append(message))
    except RuntimeError as error:
        require_memory(error)
        return (), _syntax_problem(source, messages)
    statements: list[Statement] = []
    part, parameters = "base", tuple[str, ...]()
    for node in nodes:
        kind = node.ast_type
        if kind == ASTType.Program:
            part, parameters = node.name, tuple(each.name for each in node.parameters)
        if kind != ASTType.Comment:
            line = node.location.begin.line
            statements.append(Statement(node, kind, source.path, line, own, part, parameters))
    problem = number_problem(source)
    return (() if problem else tuple(statements)), problem


def _character_problem(source: Source) -> Problem | None:
    """Return the problem with the first unreadable character, or with parentheses that are nested too deeply.

    Some of these would crash the process.
    """
    text = source.text
    readable = text.isascii() and "\0" not in text
    if readable and text.count("(") <= DEEPEST:
        return None
    lines = blanked(text).split("\n")
    for number, line in enumerate(lines, 1):
        for character in line:
            if not character.isascii() or character == "\0":
                problem = f"the character {character!r} is not allowed here"
                remedy = 'use a-z, A-Z, 0-9 and _ in names, and put other text into "quotes" or a comment'
                return Problem(source.path, number, f"{problem}; {remedy}")
    depth = 0
    for number, line in enumerate(lines, 1):
        for character in re.findall("[()]", line):
            depth = max(depth + (1 if character == "(" else -1), 0)
            if depth > DEEPEST:
                text = f"parentheses are nested more than {DEEPEST} deep; flatten the term"
                return Problem(source.path, number, text)
    return None


@lru_cache(maxsize=64)
def number_problem(source: Source) -> Problem | None:
    """Return the problem with the first number in a source that clingo would silently wrap around."""
    for position, digits in too_large(blanked(source.text)):
        line = source.text.count("\n", 0, position) + 1
        return Problem(source.path, line, f"the number {shortened(digits)} is out of range: {TOLD}")
    return None


def require_memory(error: RuntimeError) -> None:
    """Raise a MemoryError if clingo failed in a Python callback, because callbacks here fail for no other reason.

    Raises:
        MemoryError: a callback failed.
    """
    if IN_CALLBACK in str(error):
        raise MemoryError(IN_CALLBACK) from None


def _syntax_problem(source: Source, messages: list[str]) -> Problem:
    """Return only the first syntax error as a problem, because the others may follow from it."""
    error = re.match(MESSAGE, messages[0]) if messages else None
    if not error:
        text = f"clingo cannot read this file: {' '.join(messages) or 'no reason given'}; fix it"
        return Problem(source.path, 1, text)
    line, words = int(error["line"]), " ".join(error["words"].split())
    if "EOF" in words:
        comment = open_comment(source.text)
        if comment is not None:
            line = source.text.count("\n", 0, comment) + 1
            return Problem(source.path, line, "this comment is never closed; close it with *%")
        line = blanked(source.text).rstrip().count("\n") + 1
        return Problem(source.path, line, "the file ends within a statement; end the statement with a period")
    column = int(error["column"])
    code = source.text.split("\n")[line - 1]
    token = re.match(TOKEN, code.encode()[column - 1 :].decode(errors="replace"))
    problem = f"unexpected {token[0] if token else 'end of line'} at column {column}"
    if "lexer error" in words:
        remedy = "close the string on the line it begins on" if token and token[0] == '"' else "remove it"
    elif not code.encode()[: column - 1].strip():
        remedy = "end the statement before it with a period"
    else:
        expected = re.search(EXPECTED, words)
        remedy = f"clingo expects {expected[1]} here" if expected else "fix the statement before it"
    return Problem(source.path, line, f"{problem}; {remedy}")
