"""Messages for words that are not known."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def unknown(text: str, known: Iterable[str], kind: str) -> str:
    """Return the message for a word that is not among those known."""
    known = sorted(known)
    near = difflib.get_close_matches(text, known, n=1)
    hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(known[:8])}{' ...' if len(known) > 8 else ''}"
    return f"no {kind} {text!r}; {hint}"
