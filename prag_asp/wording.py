"""The known name that an unknown one is most likely a misspelling of."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from prag_asp.errors import QueryError


def most_similar(name: str, known: Iterable[str], cutoff: float = 0.6) -> str | None:
    """Return the most similar of the names `known`, None where none is as similar as `cutoff`, from 0 to 1."""
    import difflib  # noqa: PLC0415 - most names are right, and the command starts faster without

    near = difflib.get_close_matches(name, sorted(known), n=1, cutoff=cutoff)
    return near[0] if near else None


def is_slip(one: str, two: str) -> bool:
    """Tell whether two words differ in one letter, wrong, missing or too much, or in the order of letters."""
    if sorted(one) == sorted(two):
        return one != two
    longer, shorter = (one, two) if len(one) >= len(two) else (two, one)
    return any(
        longer[:i] + longer[i + 1 :] in (shorter, shorter[:i] + shorter[i + 1 :])
        for i in range(len(longer))
        if len(longer) - len(shorter) <= 1
    )


def plural(number: int, one: str, several: str = "") -> str:
    """Return a number with its noun: ``1 task``, ``2 tasks``; `several` where the plural is not with an s."""
    return f"{number} {one if number == 1 else several or f'{one}s'}"


def unknown(text: str, known: Iterable[str], kind: str) -> str:
    """Return the message for a word that is not among those known."""
    known = sorted(known)
    near = most_similar(text, known)
    hint = f"did you mean {near}?" if near else f"there are {', '.join(known[:8])}{' ...' if len(known) > 8 else ''}"
    return f"no {kind} {text!r}; {hint}"


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
