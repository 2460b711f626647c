"""dataset.json: what a dataset is of, how it was made, how much of the space it covers, and its files."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec

from prag_asp.dataset.dataset_spec import DatasetSpec
from prag_asp.dataset.store.domain_snapshot import DomainSnapshot, FileRecord
from prag_asp.dataset.store.manifest_file import ManifestFile
from prag_asp.errors import QueryError
from prag_asp.fields import Whole
from prag_asp.integers import digits_of, number_of

if TYPE_CHECKING:
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.space.task_spaces import TaskSpaces

NAME = "dataset.json"

MOST_DIGITS = 1_000_000
"""Digits of a number of tasks: the time to parse a number grows with the square of its digits."""

Decimal = Annotated[str, msgspec.Meta(pattern="^[0-9]+$", max_length=MOST_DIGITS)]
"""A whole number that may outgrow 64 bits."""


class CauseCount(msgspec.Struct):
    """The number of attempts that failed for a cause."""

    cause: str
    count: Whole


class RefusalCount(msgspec.Struct):
    """The number of tasks refused for a reason."""

    status: str
    reason: str
    count: Whole


class LengthTally(msgspec.Struct):
    """The outcomes of the draws of one length; without physics, all count as feasible."""

    length: Whole
    drawn: Whole = 0
    feasible: Whole = 0
    not_found: Whole = 0
    infeasible: Whole = 0
    witnesses: Whole = 0
    pass_rate: float = 0.0
    causes: list[CauseCount] = []
    reasons: list[RefusalCount] = []


class ShardFile(msgspec.Struct):
    """A file of rows: its path in the folder, its rows, its size and its SHA-256."""

    path: str
    rows: Whole
    bytes: Whole
    sha256: str


class Shard(msgspec.Struct):
    """The rows of the draws of a part from `first` to before `end`, by tables; a shard that is not full may grow."""

    number: Whole
    first: Whole
    end: Whole
    full: bool
    files: dict[str, ShardFile]
    tally: list[LengthTally]
    versions: str

    def rows(self, table: str) -> int:
        """Return the number of its rows in a table."""
        return self.files[table].rows if table in self.files else 0


class Share(msgspec.Struct):
    """A share, exactly, and as a float for reading."""

    numerator: Decimal
    denominator: Decimal
    value: float


class PartManifest(msgspec.Struct):
    """A part: the tasks that there are, the number requested, the number found, and its shards.

    `tail` is the last shard while more rows are added to it.
    """

    name: str
    size: Decimal
    requested: Whole
    draws: Whole = 0
    tasks: Whole = 0
    covered: Share | None = None
    lengths: list[LengthTally] = []
    shards: list[Shard] = []
    tail: Shard | None = None

    def rows(self, table: str) -> int:
        """Return the number of its rows in a table."""
        return sum(shard.rows(table) for shard in self.shards)


class SpaceSize(msgspec.Struct):
    """The exact number of tasks of a length."""

    length: Whole
    tasks: Decimal


class Manifest(msgspec.Struct):
    """The contents of dataset.json.

    `lengths` and `where` are those of the space that its tasks are of, `spaces` its exact size by lengths.
    """

    complete: bool
    identity: str
    spec: DatasetSpec
    lengths: list[Whole]
    where: list[str]
    domain: DomainSnapshot
    spaces: list[SpaceSize]
    parts: list[PartManifest]
    covered: Share | None = None
    pictures: list[FileRecord] = []
    versions: str = ""

    def __post_init__(self) -> None:
        names = [part.name for part in self.parts]
        if not names or sorted(names) != sorted(self.spec.split):
            raise QueryError("parts: are not those of spec.split; copy the dataset once more")

    @property
    def request(self) -> dict[str, Any]:
        """The values that identify it besides its domain, by their names, as `request_of` returns them."""
        return {"lengths": self.lengths, "where": self.where, **self.spec.fixed()}

    def rows(self, table: str) -> int:
        """Return the number of rows of a table in all parts."""
        return sum(part.rows(table) for part in self.parts)

    @property
    def size(self) -> int:
        """The number of tasks of the space."""
        return sum(number_of(space.tasks) for space in self.spaces)


def request_of(space: TaskSpace | TaskSpaces, spec: DatasetSpec) -> dict[str, Any]:
    """Return the values that identify a dataset besides its domain, by their names: the space and the fixed request."""
    from prag_asp.space.without_replacement import lengths_of

    where = [str(clause) for clause in space.condition.clauses]
    return {"lengths": [*lengths_of(space)], "where": where, **spec.fixed()}


def identity_of(domain: DomainSnapshot, request: Mapping[str, Any]) -> str:
    """Return a digest of everything that a dataset depends on, except the number of its tasks."""
    from prag_asp.domain.identity import digest

    return digest([msgspec.to_builtins(domain), request])


def share_of(some: int, whole: int) -> Share:
    """Return a number as a share of the whole."""
    share = Fraction(some, whole) if whole else Fraction(0)
    return Share(digits_of(share.numerator), digits_of(share.denominator), rate_of(some, whole))


def rate_of(some: int, whole: int) -> float:
    """Return a share as a float; a damaged manifest may claim one beyond all floats."""
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
        into.causes = [CauseCount(name, count) for name, count in sorted(causes.items())]
        reasons = {(reason.status, reason.reason): reason.count for reason in into.reasons}
        for reason in each.reasons:
            reasons[reason.status, reason.reason] = reasons.get((reason.status, reason.reason), 0) + reason.count
        into.reasons = [RefusalCount(*key, count) for key, count in sorted(reasons.items())]
    return [found[length] for length in sorted(found)]


def derive(manifest: Manifest) -> None:
    """Set the figures that follow from the shards."""
    for part in manifest.parts:
        part.draws = part.shards[-1].end if part.shards else 0
        part.tasks = part.rows("tasks")
        part.covered = share_of(part.tasks, number_of(part.size))
        part.lengths = summed(tally for shard in part.shards for tally in shard.tally)
    manifest.covered = share_of(manifest.rows("tasks"), manifest.size)


DATASET = ManifestFile(NAME, Manifest, "prag_asp dataset", 1, "dataset")
"""The file of a dataset; version 1 of it and of the tables."""


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write dataset.json, whole, with what follows from its shards.

    Raises:
        OutputError: it cannot be written.
    """
    derive(manifest)
    DATASET.write(folder, manifest)
