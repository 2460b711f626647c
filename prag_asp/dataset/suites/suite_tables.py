"""The tables in the TOML file of a suite, as plain structs."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec

from prag_asp.dataset.dataset_spec import LARGEST_SEED, MOST_STARTS

Positive = Annotated[int, msgspec.Meta(ge=1)]
Seed = Annotated[int, msgspec.Meta(ge=0, le=LARGEST_SEED)]
Words = str | list[str]
"""One text, or several texts."""

LONGEST = 1000
"""The maximum length in a suite; a range such as 1..3 is expanded to a list of lengths."""


class PhysicsTable(msgspec.Struct):
    """``[physics]``: the search budget of the physics checks, and the options for recordings."""

    budget: str = "10x10"
    tier: str = "kinematics"
    demonstrate: bool = False
    cameras: list[str] = []
    size: str | None = None
    rate: Positive | None = None
    vary: list[str] = []


class PartTable(msgspec.Struct):
    """``[parts.NAME]``: the tasks of a part and their number; missing keys default to the keys of the suite."""

    tasks: Annotated[int, msgspec.Meta(ge=1, le=10**12)]
    about: str = ""
    lengths: str | int | None = None
    where: Words = []
    unseen: Words = []
    of: str | None = None
    shares: Words = []
    distance: dict[str, Annotated[int, msgspec.Meta(ge=1, le=100)]] = {}
    seed: Seed | None = None
    starts: Annotated[int, msgspec.Meta(ge=1, le=MOST_STARTS)] = 1
    split: dict[str, Any] = {}
    skeletons: bool = False
    evenly: bool = False
    language: str | None = None
    phrasings: str | None = None


class SuiteTable(msgspec.Struct):
    """The whole file: each of its `parts` is a `PartTable`, and `physics` may be a `PhysicsTable`."""

    domain: str
    parts: dict[str, Any]
    title: str = ""
    description: str = ""
    seed: Seed = 0
    lengths: str | int | None = None
    where: Words = []
    uniform: bool = False
    language: str = "en"
    phrasings: str = ""
    physics: bool | dict[str, Any] | None = None


OWN_OF_COPIES = ("tasks", "about", "of", "language", "phrasings")
"""The keys that a part with the tasks of another part may set; all other values come from that part."""


def texts(value: Words) -> tuple[str, ...]:
    """Return one text or several texts as a tuple."""
    return (value,) if isinstance(value, str) else tuple(value)
