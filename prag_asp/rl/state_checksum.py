"""States of environments under a seal: those that are damaged, or of another environment, are refused."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from typing import Any

from prag_asp.errors import QueryError


def sealed(state: Mapping[str, Any], made: str) -> dict[str, Any]:
    """Return a state, of what JSON can write, with what its environment was `made` of and a seal over both."""
    return {**state, "made": made, "seal": _seal({**state, "made": made})}


def check_seal(state: object, made: str) -> None:
    """Refuse what is no state of an environment that was `made` of this.

    Raises:
        QueryError: that is so.
    """
    if not isinstance(state, Mapping) or state.get("made") != made:
        of = repr(state["made"]) if isinstance(state, Mapping) and "made" in state else "nothing that is known"
        raise QueryError(f"the state is of another environment, made of {of}; this one is made of {made}")
    try:
        whole = state.get("seal") == _seal({key: each for key, each in state.items() if key != "seal"})
    except (TypeError, ValueError):
        whole = False
    if not whole:
        raise QueryError("the state is damaged; load all that state_dict returned, unchanged")


def _seal(state: Mapping[str, Any]) -> str:
    """Return what tells a state from others, the same after JSON has written and read it."""
    return sha256(json.dumps(state, sort_keys=True).encode()).hexdigest()[:16]
