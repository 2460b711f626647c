"""What stands beside a data set in another form: of which one it is, and what has written it."""

from __future__ import annotations

import json

from prag_asp.dataset.formats.episode_source import Source
from prag_asp.versions import versions

MARK = "export.json"
"""The file that says it."""


def told_of(source: Source, form: str) -> dict[str, object]:
    """Return of which data set something is, and what has written it."""
    manifest = source.data.manifest
    return {
        "form": form,
        "domain": manifest.domain.name,
        "identity": manifest.identity,
        "parts": list(source.data.parts),
        "conditions": list(source.data.conditions),
        "level": source.level,
        "versions": versions(),
    }


def mark_of(source: Source, form: str) -> bytes:
    """Return the content of that file."""
    return f"{json.dumps(told_of(source, form), indent=1, ensure_ascii=False)}\n".encode()
