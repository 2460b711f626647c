"""How messages are worded: names that are nearly known, numbers with their nouns."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from prag_asp.errors import QueryError

SIMILAR = 0.6
"""The share of their letters, in order, that two names have in common where one may be meant by the other."""

ALIKE = 0.7
"""The share from which a name is held for a misspelling, and not only for one that may be meant."""

LISTED = 8
"""Known names that a message lists at most."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that another is most likely a misspelling of, None where no other is similar."""
    import difflib  # noqa: PLC0415 - most names are right, and the command starts faster without

    near = difflib.get_close_matches(name, sorted({*known} - {name}), n=1, cutoff=SIMILAR)
    return near[0] if near else None


def is_misspelt(name: str, known: Iterable[str]) -> bool:
    """Tell whether a name is hardly one of its own: a known one is like it, and not by a whole word or but a number."""
    near = nearest(name, known)
    if near is None:
        return False
    import difflib  # noqa: PLC0415 - as above

    words, others = set(name.split("_")), set(near.split("_"))
    same_numbers = re.findall(r"\d+", name) == re.findall(r"\d+", near)
    alike = difflib.SequenceMatcher(None, name, near).ratio() >= ALIKE
    return alike and same_numbers and not words < others and not others < words


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """Return ``did you mean ...?`` where a known name is near; where none is, `otherwise` or what is known."""
    names = {*known}
    near = nearest(name, names)
    return f"did you mean {near}?" if near else otherwise or f"known are {listed(names)}"


def listed(names: Iterable[str]) -> str:
    """Return names in order, as many as a message has room for."""
    ordered = sorted(names)
    return f"{', '.join(ordered[:LISTED])}{' ...' if len(ordered) > LISTED else ''}" if ordered else "none"


def plural(number: int, one: str, several: str = "") -> str:
    """Return a number with its noun: ``1 task``, ``2 tasks``; `several` where the plural is not with an s."""
    return f"{number} {one if number == 1 else several or f'{one}s'}"


def unknown(text: str, known: Iterable[str], kind: str) -> str:
    """Return the message for a word that is not among those known."""
    names = {*known}
    like = "(" in text and any(each.startswith(text[: text.index("(") + 1]) for each in names)
    never = ", or it can never occur" if kind == "action" and like else ""
    return f"no {kind} {text!r}{never}; {did_you_mean(text, names, f'there are {listed(names)}')}"


@contextmanager
def not_too_deep(text: str) -> Iterator[None]:
    """Read something that is nested, and say so where it is too deep.

    Raises:
        QueryError: it is.
    """
    try:
        yield
    except RecursionError:
        raise QueryError(f"'{text[:40]}...' is nested too deep, or too long; write it shorter") from None
