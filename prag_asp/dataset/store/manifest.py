"""dataset.json: what a data set is of, how it was made, how much of the space it covers, and its files."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec

from prag_asp.dataset.store.description import read_description, write_description
from prag_asp.dataset.store.domain_snapshot import KeptDomain, KeptFile
from prag_asp.errors import QueryError
from prag_asp.integers import digits_of, number_of
from prag_asp.space.sampling.sharding import ALL, Deal
from prag_asp.tables.json_fields import Whole

if TYPE_CHECKING:
    from prag_asp.physics import Staging

NAME, FORMAT = "dataset.json", "prag_asp dataset"
VERSION = 1
"""The form of dataset.json and of the tables; another one is not read."""


MOST_DIGITS = 1_000_000
"""Digits of a number of tasks: how long it takes to read more grows with their square."""

Decimal = Annotated[str, msgspec.Meta(pattern="^[0-9]+$", max_length=MOST_DIGITS)]
"""A whole number that may outgrow 64 bits."""


class Cause(msgspec.Struct):
    """How many attempts failed for a cause."""

    cause: str
    count: Whole


class Reason(msgspec.Struct):
    """How many tasks were refused for a reason."""

    status: str
    reason: str
    count: Whole


class LengthTally(msgspec.Struct):
    """What became of the draws of one length; those that physics was not asked of count as feasible."""

    length: Whole
    drawn: Whole = 0
    feasible: Whole = 0
    not_found: Whole = 0
    infeasible: Whole = 0
    witnesses: Whole = 0
    pass_rate: float = 0.0
    causes: list[Cause] = []
    reasons: list[Reason] = []


class ShardFile(msgspec.Struct):
    """A file of rows: its path in the folder, its rows, its size and its SHA-256."""

    path: str
    rows: Whole
    bytes: Whole
    sha256: str


class Shard(msgspec.Struct):
    """The rows of some draws of a part, from `first` to before `end`, by their tables; one that is not full grows."""

    number: Whole
    first: Whole
    end: Whole
    full: bool
    files: dict[str, ShardFile]
    tally: list[LengthTally]
    versions: str

    def rows(self, table: str) -> int:
        """Return how many rows of a table it has."""
        return self.files[table].rows if table in self.files else 0


class Share(msgspec.Struct):
    """A share, exactly, and as a float for reading."""

    numerator: Decimal
    denominator: Decimal
    value: float


class PartNote(msgspec.Struct):
    """A part: how many tasks there are to draw, how many were wanted, what came of them, and its shards.

    `tail` is a shard that was not full, while more rows are added to it.
    """

    name: str
    size: Decimal
    wanted: Whole
    draws: Whole = 0
    tasks: Whole = 0
    covered: Share | None = None
    lengths: list[LengthTally] = []
    shards: list[Shard] = []
    tail: Shard | None = None

    def rows(self, table: str) -> int:
        """Return how many rows of a table it has."""
        return sum(shard.rows(table) for shard in self.shards)


class SpaceNote(msgspec.Struct):
    """The exact number of tasks of a length."""

    length: Whole
    tasks: Decimal


class BudgetNote(msgspec.Struct):
    """How hard physics looked; see `Budget`."""

    restarts: Whole
    samples: Whole
    tier: str


class StagingNote(msgspec.Struct):
    """The cameras of demonstrations, and what varies."""

    cameras: list[str]
    size: list[Whole] | None
    rate: Whole
    vary: list[str]

    @classmethod
    def of(cls, staging: Staging) -> StagingNote:
        """Return the note of what is staged."""
        size = None if staging.size is None else list(staging.size)
        return cls(list(staging.cameras), size, staging.rate, list(staging.vary))


class Asked(msgspec.Struct, omit_defaults=True):
    """All that identifies a data set, beside its domain: what `generate` was asked for.

    `part` is such as ``3/64`` where others make the rest of it: only those draws are in it that are dealt to the third.
    """

    lengths: list[Whole]
    where: list[str]
    seed: Whole
    weights: dict[str, str]
    temperature: str
    evenly: bool
    split: dict[str, str]
    skeletons: bool
    hold_out: str | None
    budget: BudgetNote | None
    starts: Whole
    demonstrate: bool
    shard: Whole
    language: str
    staging: StagingNote | None
    phrasings: str = ""
    part: Annotated[str, msgspec.Meta(pattern="^[1-9][0-9]{0,6}/[1-9][0-9]{0,6}$")] | None = None

    @property
    def deal(self) -> Deal:
        """Which draws are dealt to it."""
        return ALL if self.part is None else Deal.parse(self.part)


class Manifest(msgspec.Struct):
    """What dataset.json says."""

    format: str
    version: Whole
    complete: bool
    identity: str
    wanted: Whole
    asked: Asked
    domain: KeptDomain
    spaces: list[SpaceNote]
    parts: list[PartNote]
    covered: Share | None = None
    pictures: list[KeptFile] = []
    versions: str = ""

    def rows(self, table: str) -> int:
        """Return how many rows of a table there are in all parts."""
        return sum(part.rows(table) for part in self.parts)

    @property
    def size(self) -> int:
        """How many tasks there are in the space."""
        return sum(number_of(space.tasks) for space in self.spaces)


def require_parts(manifest: Manifest, folder: Path) -> None:
    """Check that a data set has the parts that were asked for.

    Raises:
        QueryError: it has others.
    """
    names = [part.name for part in manifest.parts]
    if not names or sorted(names) != sorted(manifest.asked.split):
        raise QueryError(f"{folder / NAME}: parts: are not those of asked.split; copy the data set once more")


def share_of(some: int, whole: int) -> Share:
    """Return which share some are of the whole."""
    share = Fraction(some, whole) if whole else Fraction(0)
    return Share(digits_of(share.numerator), digits_of(share.denominator), rate_of(some, whole))


def rate_of(some: int, whole: int) -> float:
    """Return the same as a float; what a stranger claims may be beyond all floats."""
    try:
        return some / whole if whole else 0.0
    except OverflowError:
        return math.inf


def summed(tallies: Iterable[LengthTally]) -> list[LengthTally]:
    """Return tallies with those of one length added up, each with its pass rate."""
    found: dict[int, LengthTally] = {}
    for each in tallies:
        into = found.setdefault(each.length, LengthTally(each.length))
        for name in ("drawn", "feasible", "not_found", "infeasible", "witnesses"):
            setattr(into, name, getattr(into, name) + getattr(each, name))
        into.pass_rate = rate_of(into.feasible, into.drawn)
        causes = {cause.cause: cause.count for cause in into.causes}
        for cause in each.causes:
            causes[cause.cause] = causes.get(cause.cause, 0) + cause.count
        into.causes = [Cause(name, count) for name, count in sorted(causes.items())]
        reasons = {(reason.status, reason.reason): reason.count for reason in into.reasons}
        for reason in each.reasons:
            reasons[reason.status, reason.reason] = reasons.get((reason.status, reason.reason), 0) + reason.count
        into.reasons = [Reason(*key, count) for key, count in sorted(reasons.items())]
    return [found[length] for length in sorted(found)]


def derive(manifest: Manifest) -> None:
    """Set what follows from the shards that are listed."""
    for part in manifest.parts:
        part.draws = part.shards[-1].end if part.shards else 0
        part.tasks = part.rows("tasks")
        part.covered = share_of(part.tasks, number_of(part.size))
        part.lengths = summed(tally for shard in part.shards for tally in shard.tally)
    manifest.covered = share_of(manifest.rows("tasks"), manifest.size)


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write dataset.json, whole, with what follows from its shards.

    Raises:
        OutputError: it cannot be written.
    """
    derive(manifest)
    write_description(folder, NAME, manifest)


def read_manifest(folder: Path) -> Manifest | None:
    """Return what dataset.json says, None where there is none.

    Raises:
        QueryError: it is damaged, of another program, or of another version.
    """
    return read_description(folder, NAME, Manifest, (FORMAT, VERSION), "data set")
