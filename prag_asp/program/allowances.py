"""Comments that suppress warnings: ``% lint: allow unused, empty-class`` on the line of the warning."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from prag_asp.program.sources import Source
from prag_asp.program.tokens import comments

ALLOW = re.compile(r"\blint:\s*allow\b(?P<names>[^*#%\n]*)")
"""Such a comment in a logic program (after %, or in %* *%) or in domain.toml (after #)."""


def allowed_in_sources(sources: Iterable[Source]) -> dict[tuple[Path, int], tuple[str, ...]]:
    """Return the names that the comments of sources allow, by file and line, even those that name no warning."""
    allowed: dict[tuple[Path, int], tuple[str, ...]] = {}
    for source in sources:
        if "lint:" in source.text:
            allowed |= {(source.path, line): names for line, names in allowed_by_comments(comments(source.text))}
    return allowed


def allowed_by_comments(spoken: Iterable[tuple[int, str]]) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Yield the lines of comments that allow warnings, with the names."""
    for line, words in spoken:
        match = ALLOW.search(words)
        if match:
            yield line, tuple(re.findall(r"[^\s,]+", match["names"]))
