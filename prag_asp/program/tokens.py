"""The comments and strings of a logic program, separated from its code."""

from __future__ import annotations

import re
from collections.abc import Iterator

from prag_asp.atom import STRING

COMMENT_EDGE = re.compile(r"%\*|\*%")


def blanked(text: str) -> str:
    """Return a logic program with its comments and strings replaced by blanks; positions do not change."""
    pieces: list[str] = []
    position = 0
    while position < len(text):
        end = _token_end(text, position)
        token = text[position:end]
        hidden = token[0] == "%" or (len(token) > 1 and token[0] == '"')
        pieces.append(re.sub(r"[^\n\0]", " ", token) if hidden else token)
        position = end
    return "".join(pieces)


def comments(text: str) -> Iterator[tuple[int, str]]:
    """Yield the comments of a logic program, each with its first line number."""
    position, line = 0, 1
    while position < len(text):
        end = _token_end(text, position)
        if text[position] == "%":
            yield line, text[position:end]
        line += text.count("\n", position, end)
        position = end


def open_comment(text: str) -> int | None:
    """Return the position of an unclosed block comment, or None."""
    position = 0
    while position < len(text):
        end = _token_end(text, position)
        edges = COMMENT_EDGE.findall(text, position, end)
        if text.startswith("%*", position) and edges.count("%*") > edges.count("*%"):
            return position
        position = end
    return None


def _token_end(text: str, start: int) -> int:
    """Return the end of the comment, the string or the piece of code that begins at `start`."""
    if text.startswith("%*", start):
        depth = 0
        for edge in COMMENT_EDGE.finditer(text, start):  # clingo nests block comments
            depth += 1 if edge[0] == "%*" else -1
            if depth == 0:
                return edge.end()
        return len(text)
    if text[start] == "%":
        end = text.find("\n", start)
        return end if end >= 0 else len(text)
    if text[start] == '"':
        string = STRING.match(text, start)
        return string.end() if string else start + 1
    ends = [end for end in (text.find("%", start), text.find('"', start)) if end >= 0]
    return min(ends, default=len(text))
