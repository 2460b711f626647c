"""The files with which the PDDL extension of VS Code (jan-dolejsi.pddl) shows the final states of plans.

The extension reads ``DOMAIN.planviz.json`` next to ``DOMAIN.pddl``, which names a script with the property
``customVisualization``; the interface of scripts is documented in https://github.com/jan-dolejsi/pddl-gantt.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import clingo

SETTINGS_SUFFIX = ".planviz.json"
"""The text that replaces ``.pddl`` in the name of a domain's file."""


def view_settings(script: str) -> str:
    """Return the settings, as JSON, that name the script which the extension uses for a view."""
    return json.dumps({"customVisualization": script}, indent=1) + "\n"


def view_script(fluents: Mapping[str, clingo.Symbol]) -> str:
    """Return the script of a view; `fluents` maps atoms in PDDL, such as ``on a b``, to the fluents of a domain."""
    shown: dict[str, Any] = {
        atom.lower(): {"text": str(fluent), "about": str(fluent.arguments[0]) if fluent.arguments else ""}
        for atom, fluent in fluents.items()
    }
    text = Path(__file__).with_suffix(".js").read_text(encoding="utf-8")
    return text.replace("FLUENTS", json.dumps(shown, separators=(",", ":")), 1)
