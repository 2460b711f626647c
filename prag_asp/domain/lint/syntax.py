"""Parse every file of a program on its own, so that a mistake in one is not blamed on the next."""

from __future__ import annotations

import re
from collections.abc import Iterable

from clingo.ast import AST, ASTType, parse_string

from prag_asp.domain.lint.problem import Problem
from prag_asp.domain.lint.statement import Statement
from prag_asp.domain.sources import Source

MESSAGE = re.compile(r"<string>:(?P<line>\d+):(?P<column>\d+)[-\d:]*: error: (?P<words>.*)", re.S)
STRING = re.compile(r'"(?:\\["\\n]|[^"\\\n])*"')
COMMENT_EDGE = re.compile(r"%\*|\*%")
STAND_IN = "$"
"""A character that clingo reads in strings and comments only."""


def parse_sources(sources: Iterable[tuple[Source, bool]]) -> tuple[list[Statement], list[Problem]]:
    """Return the statements and the syntax errors of sources, each with whether it is the domain's own."""
    statements: list[Statement] = []
    problems: list[Problem] = []
    for source, own in sources:
        broken = _character_problem(source)
        if broken is None:
            broken = _parse(source, own, statements)
        problems += [broken] if broken else []
    return statements, problems


def _character_problem(source: Source) -> Problem | None:
    """Return the first character that clingo cannot read where it stands; some of them would end the process."""
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


def blanked(text: str) -> str:
    """Return a logic program with its comments and strings blanked out, line by line as long as before."""
    pieces: list[str] = []
    position = 0
    while position < len(text):
        end = _token_end(text, position)
        token = text[position:end]
        pieces.append(re.sub(r"[^\n\0]", " ", token) if token[0] in '%"' and end > position + 1 else token)
        position = end
    return "".join(pieces)


def _token_end(text: str, start: int) -> int:
    """Return where the comment, the string or the piece of other text that begins at `start` ends."""
    if text.startswith("%*", start):
        return _comment_end(text, start)
    if text[start] == "%":
        end = text.find("\n", start)
        return end if end >= 0 else len(text)
    if text[start] == '"':
        string = STRING.match(text, start)
        return string.end() if string else start + 1
    ends = [end for end in (text.find("%", start), text.find('"', start)) if end >= 0]
    return min(ends, default=len(text))


def _comment_end(text: str, start: int) -> int:
    """Return the end of a block comment; clingo nests them."""
    depth = 0
    for edge in COMMENT_EDGE.finditer(text, start):
        depth += 1 if edge[0] == "%*" else -1
        if depth == 0:
            return edge.end()
    return len(text)


def _parse(source: Source, own: bool, statements: list[Statement]) -> Problem | None:
    """Append the statements of a source; return its first syntax error, for the others follow from it."""
    messages: list[str] = []
    nodes: list[AST] = []
    text = source.text
    try:
        if not text.isascii():
            parse_string(re.sub(r"[^\x00-\x7f]", STAND_IN, text), lambda _: None, logger=lambda _, said: messages.append(said))
        parse_string(text, nodes.append, logger=lambda _, said: messages.append(said))
    except RuntimeError:
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


def _syntax_problem(source: Source, messages: list[str]) -> Problem:
    said = MESSAGE.match(messages[0]) if messages else None
    if not said:
        return Problem(source.path, 1, f"clingo cannot read this file: {' '.join(messages) or 'no reason given'}; mend it")
    line, words = int(said["line"]), " ".join(said["words"].split())
    last = source.text.rstrip().count("\n") + 1
    if "EOF" in words:
        return _unfinished(source, min(line, last))
    unexpected = re.search(r"unexpected (\S+)", words)
    found = unexpected[1].removesuffix(",") if unexpected else ""
    place = f"at column {said['column']}"
    if "lexer error" in words:
        todo = "close the string on the line it begins on" if found == '"' else "remove it"
        return Problem(source.path, line, f"clingo cannot read {found!r} {place}; {todo}")
    expecting = re.search(r"expecting (.*)", words)
    todo = f"clingo expects {expecting[1]} there" if expecting else "mend the statement before it"
    return Problem(source.path, line, f"unexpected {found} {place}; {todo}")


def _unfinished(source: Source, line: int) -> Problem:
    """Return the problem of a file that ends within a comment or a statement, at the place where that begins."""
    text, position = source.text, 0
    while position < len(text):
        end = _token_end(text, position)
        if text.startswith("%*", position) and (end == len(text) and not _closed(text[position:])):
            return Problem(
                source.path, text.count("\n", 0, position) + 1, "this comment never ends; close it with *%"
            )
        position = end
    code = blanked(text).rstrip()
    line = code.count("\n") + 1 if code else line
    return Problem(source.path, line, "the file ends within a statement; end the statement with a period")


def _closed(comment: str) -> bool:
    """Return whether a text that begins a block comment ends it."""
    edges = COMMENT_EDGE.findall(comment)
    return edges.count("%*") <= edges.count("*%")
