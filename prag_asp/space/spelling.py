"""Messages for words that are not known, and for texts that are nested too deep."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from prag_asp.errors import QueryError
from prag_asp.wording import most_similar


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
