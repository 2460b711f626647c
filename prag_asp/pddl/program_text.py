"""How a program is laid out: rules, titles, and facts in lines that are not too long."""

from __future__ import annotations

from collections.abc import Iterable, Iterator


def statement(head: str, body: Iterable[str]) -> str:
    """Return a rule, or a fact where there is no body."""
    told = ", ".join(dict.fromkeys(body))
    return f"{head} :- {told}." if told else f"{head}."


def heading(title: str) -> list[str]:
    """Return a title as lines of a comment."""
    return ["", f"% {title} ".ljust(110, "-")]


def filled(facts: Iterable[str], width: int = 110) -> Iterator[str]:
    """Yield facts, several in a line."""
    line = ""
    for fact in facts:
        if line and len(line) + len(fact) >= width:
            yield line
            line = ""
        line = f"{line} {fact}".strip()
    if line:
        yield line


def wrapped(text: str, width: int = 110) -> Iterator[str]:
    """Yield a statement in lines that are not too long, broken after blanks."""
    line = ""
    for word in text.split(" "):
        if line and len(line) + len(word) >= width:
            yield line
            line = "   "
        line = f"{line} {word}" if line else word
    yield line
