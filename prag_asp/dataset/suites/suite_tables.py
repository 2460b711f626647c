"""The tables of a suite's TOML file, as they are written there."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec

from prag_asp.dataset.dataset_spec import LARGEST_SEED, MOST_STARTS
from prag_asp.errors import QueryError

Positive = Annotated[int, msgspec.Meta(ge=1)]
Seed = Annotated[int, msgspec.Meta(ge=0, le=LARGEST_SEED)]
Words = str | list[str]
"""One text, or several."""

LONGEST = 1000
"""The longest task that a suite may ask for: a range is written out by its ends."""


class PhysicsTable(msgspec.Struct):
    """``[physics]``: how hard physics looks at tasks, and what it records."""

    budget: str = "10x10"
    tier: str = "kinematics"
    demonstrate: bool = False
    cameras: list[str] = []
    size: str | None = None
    rate: Positive | None = None
    vary: list[str] = []


class PartTable(msgspec.Struct):
    """``[parts.NAME]``: the tasks of a part, and how many are drawn; what is left out is as for the whole suite."""

    tasks: Annotated[int, msgspec.Meta(ge=1, le=10**12)]
    about: str = ""
    lengths: str | int | None = None
    where: Words = []
    unseen: Words = []
    of: str | None = None
    shares: Words = []
    seed: Seed | None = None
    starts: Annotated[int, msgspec.Meta(ge=1, le=MOST_STARTS)] = 1
    split: dict[str, Any] = {}
    skeletons: bool = False
    evenly: bool = False
    language: str | None = None
    phrasings: str | None = None


class SuiteTable(msgspec.Struct):
    """All of the file: each of its `parts` is a `PartTable`, and `physics` may be a `PhysicsTable`."""

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
"""The keys of a part that has the tasks of another one: all else is that one's."""


def texts(given: Words) -> tuple[str, ...]:
    """Return one text, or several, as a tuple."""
    return (given,) if isinstance(given, str) else tuple(given)


def lengths_of(given: str | int) -> range:
    """Return the lengths that a value spells: ``3``, or ``1..3``.

    Raises:
        QueryError: it spells none.
    """
    first, dots, last = str(given).partition("..")
    if not first.strip().isdecimal() or (dots and not last.strip().isdecimal()) or len(str(given)) > LONGEST:
        raise QueryError(f"lengths {given!r}: write a number such as 4, or a range such as '1..3'")
    low, high = int(first), int(last) if dots else int(first)
    if low > high or high > LONGEST:
        raise QueryError(f"lengths {given!r}: write the smaller number first, and none above {LONGEST}")
    return range(low, high + 1)
