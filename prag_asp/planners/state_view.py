"""The files with which the PDDL extension of VS Code (jan-dolejsi.pddl) shows final states of plans.

The extension reads ``DOMAIN.planviz.json`` beside ``DOMAIN.pddl``, which names a script with the property
``customVisualization``; the interface of scripts is documented in https://github.com/jan-dolejsi/pddl-gantt.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import clingo

SETTINGS_SUFFIX = ".planviz.json"
"""What replaces ``.pddl`` in the name of a domain's file."""


def view_settings(script: str) -> str:
    """Return the settings of the extension that name the script of a view, as JSON."""
    return json.dumps({"customVisualization": script}, indent=1) + "\n"


def view_script(fluents: Mapping[str, clingo.Symbol]) -> str:
    """Return the script of a view; `fluents` are the fluents of a domain by their atoms in PDDL, like ``on a b``."""
    shown: dict[str, Any] = {
        atom.lower(): {"text": str(fluent), "about": str(fluent.arguments[0]) if fluent.arguments else ""}
        for atom, fluent in fluents.items()
    }
    text = Path(__file__).with_suffix(".js").read_text(encoding="utf-8")
    return text.replace("FLUENTS", json.dumps(shown, separators=(",", ":")), 1)
