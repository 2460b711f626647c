"""Add a checksum to the checkpoints of environments, and refuse damaged checkpoints and those of other environments."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from typing import Any

from prag_asp.errors import QueryError


def with_checksum(state: Mapping[str, Any], spec: str) -> dict[str, Any]:
    """Return a state of JSON values with the `spec` of its environment and a checksum of both."""
    return {**state, "spec": spec, "checksum": _checksum({**state, "spec": spec})}


def verify_checksum(state: object, spec: str) -> None:
    """Check that a state is undamaged and belongs to an environment with this `spec`.

    Raises:
        QueryError: the state is damaged, or belongs to another environment.
    """
    if not isinstance(state, Mapping) or state.get("spec") != spec:
        of = repr(state["spec"]) if isinstance(state, Mapping) and "spec" in state else "unknown arguments"
        raise QueryError(f"the state belongs to another environment, made of {of}; this one is made of {spec}")
    try:
        whole = state.get("checksum") == _checksum({key: each for key, each in state.items() if key != "checksum"})
    except (TypeError, ValueError):
        whole = False
    if not whole:
        raise QueryError("the state is damaged; load all that state_dict returned, unchanged")


def _checksum(state: Mapping[str, Any]) -> str:
    """Return the checksum of a state; it does not change when the state is converted to JSON and back."""
    return sha256(json.dumps(state, sort_keys=True).encode()).hexdigest()[:16]
