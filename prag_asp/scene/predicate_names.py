"""The registry of the spatial predicates that every scene has.

A new predicate needs a row here, and the file that it names; see `prag_asp.physics.predicates`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class SpatialWord(NamedTuple):
    """The roles of a predicate's arguments, and the file in `prag_asp.physics.predicates` that defines it."""

    roles: tuple[str, ...]
    file: str


VOCABULARY: Mapping[str, SpatialWord] = {
    "on_top": SpatialWord(("object", "object"), "on_top"),
    "inside": SpatialWord(("object", "object"), "inside"),
    "left_of": SpatialWord(("object", "object"), "beside"),
    "right_of": SpatialWord(("object", "object"), "beside"),
    "in_front_of": SpatialWord(("object", "object"), "beside"),
    "behind": SpatialWord(("object", "object"), "beside"),
    "reachable": SpatialWord(("robot", "object"), "reachable"),
    "holding": SpatialWord(("robot", "object"), "gripper"),
    "at": SpatialWord(("robot", "object"), "gripper"),
    "gripper_open": SpatialWord(("robot",), "gripper"),
    "over": SpatialWord(("robot", "object"), "gripper"),
    "located": SpatialWord(("object", "object"), "inside"),
    "rotated": SpatialWord(("object", "rotation"), "rotated"),
    "near": SpatialWord(("object", "object"), "near"),
    "far": SpatialWord(("object", "object"), "near"),
    "touching": SpatialWord(("object", "object"), "touching"),
    "between": SpatialWord(("object", "object", "object"), "between"),
    "aligned": SpatialWord(("object", "object"), "aligned"),
    "upright": SpatialWord(("object",), "upright"),
    "is_open": SpatialWord(("furniture",), "opening"),
    "is_closed": SpatialWord(("furniture",), "opening"),
}

PREDICATE_ROLES: Mapping[str, tuple[str, ...]] = {name: word.roles for name, word in VOCABULARY.items()}
"""The predicates that every scene has, with the roles of their arguments."""
