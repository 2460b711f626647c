"""Say how many there are of something."""

from __future__ import annotations


def plural(number: int, one: str, several: str = "") -> str:
    """Return a number with its noun: ``1 task``, ``2 tasks``; `several` where the plural is not with an s."""
    return f"{number} {one if number == 1 else several or f'{one}s'}"
