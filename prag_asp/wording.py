"""Parts of messages: suggestions for misspelt names, and numbers with their nouns."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from prag_asp.errors import QueryError

SIMILAR = 0.6
"""Minimum similarity of two names (as measured by `difflib`) for one of them to be suggested for the other."""

ALIKE = 0.7
"""Minimum similarity for a name to count as a misspelling of another."""

LISTED = 8
"""The largest number of names that a message lists."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that is most similar to `name`, other than `name` itself, or None if none is similar."""
    import difflib  # noqa: PLC0415 - slow to import, and most names are right

    near = difflib.get_close_matches(name, sorted({*known} - {name}), n=1, cutoff=SIMILAR)
    return near[0] if near else None


def is_misspelt(name: str, known: Iterable[str]) -> bool:
    """Return whether a name misspells a known one: similar, with the same numbers, and not just more or fewer words."""
    near = nearest(name, known)
    if near is None:
        return False
    import difflib  # noqa: PLC0415 - as above

    words, others = set(name.split("_")), set(near.split("_"))
    same_numbers = re.findall(r"\d+", name) == re.findall(r"\d+", near)
    alike = difflib.SequenceMatcher(None, name, near).ratio() >= ALIKE
    return alike and same_numbers and not words < others and not others < words


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """Return ``did you mean ...?`` with a similar name or, if there is none, `otherwise` or a list of known names."""
    names = {*known}
    near = nearest(name, names)
    return f"did you mean {near}?" if near else otherwise or f"known are {listed(names)}"


def listed(names: Iterable[str]) -> str:
    """Return at most `LISTED` names in alphabetical order, separated by commas."""
    ordered = sorted(names)
    return f"{', '.join(ordered[:LISTED])}{' ...' if len(ordered) > LISTED else ''}" if ordered else "none"


def plural(number: int, one: str, several: str = "") -> str:
    """Return a number with its noun, as in ``1 task`` and ``2 tasks``; `several` is an irregular plural."""
    return f"{number} {one if number == 1 else several or f'{one}s'}"


def unknown(text: str, known: Iterable[str], kind: str) -> str:
    """Return the error message for an unknown name."""
    names = {*known}
    like = "(" in text and any(each.startswith(text[: text.index("(") + 1]) for each in names)
    never = ", or it can never occur" if kind == "action" and like else ""
    return f"no {kind} {text!r}{never}; {did_you_mean(text, names, f'there are {listed(names)}')}"


@contextmanager
def not_too_deep(text: str) -> Iterator[None]:
    """Turn a `RecursionError` in the block, which parses a text, into an error that quotes the text.

    Raises:
        QueryError: the text is nested too deeply.
    """
    try:
        yield
    except RecursionError:
        raise QueryError(f"'{text[:40]}...' is nested too deep, or too long; write it shorter") from None
