"""The provenance of an export: its dataset, and the versions of the programs that wrote it."""

from __future__ import annotations

import json
from pathlib import Path

from prag_asp.dataset.formats.episode_source import EpisodeSource
from prag_asp.output import replace_file
from prag_asp.versions import versions

PROVENANCE = "export.json"
"""The file with the provenance of an export."""


def provenance_of(source: EpisodeSource, form: str) -> dict[str, object]:
    """Return the provenance of an export."""
    manifest = source.data.manifest
    return {
        "form": form,
        "domain": manifest.domain.name,
        "identity": manifest.identity,
        "parts": list(source.data.parts),
        "conditions": list(source.data.conditions),
        "level": source.level,
        "action": source.action,
        "versions": versions(),
    }


def write_provenance(folder: Path, source: EpisodeSource, form: str) -> None:
    """Write the provenance of an export into its folder.

    Raises:
        OutputError: the file cannot be written.
    """
    text = json.dumps(provenance_of(source, form), indent=1, ensure_ascii=False)
    replace_file(folder / PROVENANCE, f"{text}\n".encode())
