"""The layout of a program: rules, headings, and facts in lines of limited width."""

from __future__ import annotations

from collections.abc import Iterable, Iterator


def statement(head: str, body: Iterable[str]) -> str:
    """Return a rule, or a fact if the body is empty."""
    conditions = ", ".join(dict.fromkeys(body))
    return f"{head} :- {conditions}." if conditions else f"{head}."


def heading(title: str) -> list[str]:
    """Return a title as comment lines."""
    return ["", f"% {title} ".ljust(110, "-")]


def filled(facts: Iterable[str], width: int = 110) -> Iterator[str]:
    """Yield lines of facts, several facts per line."""
    line = ""
    for fact in facts:
        if line and len(line) + len(fact) >= width:
            yield line
            line = ""
        line = f"{line} {fact}".strip()
    if line:
        yield line


def wrapped(text: str, width: int = 110) -> Iterator[str]:
    """Yield a statement in lines of limited width, broken at blanks."""
    line = ""
    for word in text.split(" "):
        if line and len(line) + len(word) >= width:
            yield line
            line = "   "
        line = f"{line} {word}" if line else word
    yield line
