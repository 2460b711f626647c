"""The known name that an unknown one is most likely a misspelling of."""

from __future__ import annotations

from collections.abc import Iterable


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
