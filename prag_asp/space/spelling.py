"""Messages for words that are not known."""

from __future__ import annotations

from collections.abc import Iterable

from prag_asp.domain.misspelling import most_similar


def unknown(text: str, known: Iterable[str], kind: str) -> str:
    """Return the message for a word that is not among those known."""
    known = sorted(known)
    near = most_similar(text, known)
    hint = f"did you mean {near}?" if near else f"there are {', '.join(known[:8])}{' ...' if len(known) > 8 else ''}"
    return f"no {kind} {text!r}; {hint}"
