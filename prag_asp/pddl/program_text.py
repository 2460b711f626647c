"""The layout of a program: rules, headings, and facts, in lines of limited width."""

from __future__ import annotations

from collections.abc import Iterable, Iterator


def statement(head: str, body: Iterable[str]) -> str:
    """Return a rule, or a fact if the body is empty."""
    conditions = ", ".join(dict.fromkeys(body))
    return f"{head} :- {conditions}." if conditions else f"{head}."


def heading(title: str) -> list[str]:
    """Return a title as comment lines."""
    return ["", f"% {title} ".ljust(110, "-")]


def filled(parts: Iterable[str], indent: str = "", width: int = 110) -> Iterator[str]:
    """Yield lines of limited width, with blanks between texts; all but the first begin with `indent` and a blank."""
    line = ""
    for part in parts:
        if line and len(line) + len(part) >= width:
            yield line
            line = indent
        line = f"{line} {part}" if line else part
    if line:
        yield line
