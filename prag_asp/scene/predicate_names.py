"""The words of space: the predicates that every scene has, one a line, the one place that registers them.

A new predicate needs a row here, and the file that it names; see `prag_asp.physics.predicates`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Word(NamedTuple):
    """What each argument of a predicate has to be, and the file of `prag_asp.physics.predicates` that defines it."""

    roles: tuple[str, ...]
    file: str


VOCABULARY: Mapping[str, Word] = {
    "on_top": Word(("object", "object"), "on_top"),
    "inside": Word(("object", "object"), "inside"),
    "left_of": Word(("object", "object"), "beside"),
    "right_of": Word(("object", "object"), "beside"),
    "in_front_of": Word(("object", "object"), "beside"),
    "behind": Word(("object", "object"), "beside"),
    "reachable": Word(("robot", "object"), "reachable"),
    "holding": Word(("robot", "object"), "gripper"),
    "at": Word(("robot", "object"), "gripper"),
    "gripper_open": Word(("robot",), "gripper"),
    "over": Word(("robot", "object"), "gripper"),
    "located": Word(("object", "object"), "inside"),
    "rotated": Word(("object", "rotation"), "rotated"),
    "near": Word(("object", "object"), "near"),
    "far": Word(("object", "object"), "near"),
    "touching": Word(("object", "object"), "touching"),
    "between": Word(("object", "object", "object"), "between"),
    "aligned": Word(("object", "object"), "aligned"),
    "upright": Word(("object",), "upright"),
    "is_open": Word(("furniture",), "opening"),
    "is_closed": Word(("furniture",), "opening"),
}

PREDICATE_ROLES: Mapping[str, tuple[str, ...]] = {name: word.roles for name, word in VOCABULARY.items()}
"""The predicates that every scene has, and what each of their arguments has to be."""
