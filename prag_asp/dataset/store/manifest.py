"""dataset.json: the domain and the request for a dataset, its share of the task space, and its files."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec

from prag_asp.dataset.dataset_spec import DatasetSpec
from prag_asp.dataset.store.chosen_figures import CoverFigures, DiverseFigures
from prag_asp.dataset.store.domain_snapshot import DomainSnapshot, FileRecord
from prag_asp.dataset.store.draw_results import TRIVIAL
from prag_asp.dataset.store.manifest_file import ManifestFile
from prag_asp.dataset.strata.stratum_figures import StratumFigures, stratum_weights
from prag_asp.errors import QueryError
from prag_asp.integers import digits_of, number_of
from prag_asp.output.digests import digest
from prag_asp.tables.json_fields import Whole
from prag_asp.tables.report import shown

if TYPE_CHECKING:
    from prag_asp.space.task_space import TaskSpace

NAME = "dataset.json"

FOLDERS = {"tasks": "data", "witnesses": "witnesses", "rejected": "rejected", "recordings": "recordings"}
"""The folder for each table inside a dataset, in the order in which a hub offers the tables."""

MOST_DIGITS = 1_000_000
"""The maximum number of digits in a count of tasks; the time for parsing a number is quadratic in its length."""

Decimal = Annotated[str, msgspec.Meta(pattern="^[0-9]+$", max_length=MOST_DIGITS)]
"""A whole number that may exceed 64 bits."""


class CauseCount(msgspec.Struct):
    """A cause of failure, and the number of attempts that failed for it."""

    cause: str
    count: Whole


class RejectionCount(msgspec.Struct):
    """A reason for rejection, and the number of tasks rejected for it."""

    status: str
    reason: str
    count: Whole


class LengthTally(msgspec.Struct):
    """The outcomes of the draws of one length; without physics, all draws count as feasible.

    `trivial` draws are left out before physics, and the pass rate is that of the others.
    """

    length: Whole
    drawn: Whole = 0
    trivial: Whole = 0
    feasible: Whole = 0
    not_found: Whole = 0
    infeasible: Whole = 0
    witnesses: Whole = 0
    pass_rate: float = 0.0
    causes: list[CauseCount] = []
    reasons: list[RejectionCount] = []


class ShardFile(msgspec.Struct):
    """A file of rows: its path in the folder, its number of rows, its size in bytes, and its SHA-256."""

    path: str
    rows: Whole
    bytes: Whole
    sha256: str


class Shard(msgspec.Struct):
    """The rows of the draws `first` to `end` - 1 of a part, by table; a shard that is not full may grow."""

    number: Whole
    first: Whole
    end: Whole
    full: bool
    files: dict[str, ShardFile]
    tally: list[LengthTally]
    versions: str

    def rows(self, table: str) -> int:
        """Return the number of rows of the shard in a table."""
        return self.files[table].rows if table in self.files else 0


class Share(msgspec.Struct):
    """A share as an exact fraction, and as a float for readers."""

    numerator: Decimal
    denominator: Decimal
    value: float


class PartManifest(msgspec.Struct):
    """A part of the split: its numbers of tasks in the space, in the request and in the dataset, and its shards.

    `tail` is the last shard while rows are still being added to it. In a complete stratified sample, `weight` is the
    weight of each task in the part.
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
    weight: Share | msgspec.UnsetType = msgspec.UNSET

    def rows(self, table: str) -> int:
        """Return the number of rows of the part in a table."""
        return sum(shard.rows(table) for shard in self.shards)


class SpaceSize(msgspec.Struct):
    """The exact number of tasks of a length."""

    length: Whole
    tasks: Decimal


class Manifest(msgspec.Struct):
    """The contents of dataset.json.

    `lengths` and `where` define the space of the tasks; `spaces` holds the exact size of this space by length. `cover`
    holds the coverage of chosen tasks, and `diverse` holds the distances between chosen tasks for each part.
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
    cover: CoverFigures | msgspec.UnsetType = msgspec.UNSET
    diverse: dict[str, DiverseFigures] | msgspec.UnsetType = msgspec.UNSET

    def __post_init__(self) -> None:
        names = [part.name for part in self.parts]
        if not names or sorted(names) != sorted(self.spec.split):
            raise QueryError("parts: are not those of spec.split; copy the dataset again")

    @property
    def strata(self) -> list[StratumFigures]:
        """The figures of the strata, or nothing if the parts are not the strata of a complete sample."""
        complete = all(each.tasks == each.requested or each.draws >= number_of(each.size) for each in self.parts)
        whole = self.complete and complete and self.spec.part is None
        if not (self.spec.strata and whole and self.rows("tasks")):
            return []
        return [StratumFigures(each.name, each.size, each.requested, each.draws, each.tasks) for each in self.parts]

    @property
    def request(self) -> dict[str, Any]:
        """The values that identify the dataset together with its domain, as `request_of` returns them."""
        return {"lengths": self.lengths, "where": self.where, **self.spec.fixed()}

    def difference(self, other: Manifest, ignored: str = "") -> str:
        """Return a description of how this dataset differs from another, apart from tasks, or "" if it does not.

        The text reads as a continuation of "a dataset". One entry in the requests can be `ignored`.
        """
        if self.domain.name != other.domain.name:
            return f"of {self.domain.name}, not of {other.domain.name}"
        request, its = self.request, other.request
        for name in dict.fromkeys((*its, *request)):
            if name != ignored and request.get(name) != its.get(name):
                return f"made with a different value of {name.replace('_', ' ')} ({shown(request.get(name, 'none'))})"
        return "" if self.domain == other.domain else "of a different version of the domain or of the encodings"

    def rows(self, table: str) -> int:
        """Return the number of rows of all parts in a table."""
        return sum(part.rows(table) for part in self.parts)

    @property
    def size(self) -> int:
        """The number of tasks in the space."""
        return sum(number_of(space.tasks) for space in self.spaces)


def request_of(space: TaskSpace, spec: DatasetSpec) -> dict[str, Any]:
    """Return the values that identify a dataset of a domain: the space and the fixed part of the request."""
    where = [str(clause) for clause in space.condition.clauses]
    return {"lengths": [*space.lengths], "where": where, **spec.fixed()}


def identity_of(domain: DomainSnapshot, request: Mapping[str, Any]) -> str:
    """Return the digest of all inputs of a dataset, except the number of tasks."""
    return digest([msgspec.to_builtins(domain), request])


def share_of(some: int, whole: int) -> Share:
    """Return `some` as a share of `whole`."""
    share = Fraction(some, whole) if whole else Fraction(0)
    return Share(digits_of(share.numerator), digits_of(share.denominator), rate_of(some, whole))


def rate_of(some: int, whole: int) -> float:
    """Return a share as a float, or infinity if a damaged manifest claims a share that exceeds all floats."""
    try:
        return some / whole if whole else 0.0
    except OverflowError:
        return math.inf


def summed(tallies: Iterable[LengthTally]) -> list[LengthTally]:
    """Return the sum of the tallies of each length, with its pass rate."""
    sums: dict[int, LengthTally] = {}
    for each in tallies:
        into = sums.setdefault(each.length, LengthTally(each.length))
        for name in ("drawn", "trivial", "feasible", "not_found", "infeasible", "witnesses"):
            setattr(into, name, getattr(into, name) + getattr(each, name))
        into.pass_rate = rate_of(into.feasible, into.drawn - into.trivial)
        causes = {cause.cause: cause.count for cause in into.causes}
        for cause in each.causes:
            causes[cause.cause] = causes.get(cause.cause, 0) + cause.count
        into.causes = [CauseCount(name, count) for name, count in sorted(causes.items())]
        reasons = {(reason.status, reason.reason): reason.count for reason in into.reasons}
        for reason in each.reasons:
            reasons[reason.status, reason.reason] = reasons.get((reason.status, reason.reason), 0) + reason.count
        into.reasons = [RejectionCount(*key, count) for key, count in sorted(reasons.items())]
    return [sums[length] for length in sorted(sums)]


def tally_of_draw(length: int, verdict: Mapping[str, Any] | None, witnesses: int = 0, *, passed: bool) -> LengthTally:
    """Return the tally of a single draw, given the verdict as stored in a row, and whether the task `passed`."""
    status = "feasible" if passed else "trivial"
    verdict = verdict or {"status": status, "causes": [], "reason": "" if passed else TRIVIAL}
    status = verdict["status"]
    return LengthTally(
        length,
        drawn=1,
        trivial=status == "trivial",
        feasible=status == "feasible",
        not_found=status == "not_found",
        infeasible=status == "infeasible",
        witnesses=witnesses,
        causes=[CauseCount(each["cause"], each["count"]) for each in verdict["causes"]],
        reasons=[] if status == "feasible" else [RejectionCount(status, verdict["reason"], 1)],
    )


def derive(manifest: Manifest) -> None:
    """Set the figures that follow from the shards."""
    for part in manifest.parts:
        part.draws = part.shards[-1].end if part.shards else 0
        part.tasks = part.rows("tasks")
        part.covered = share_of(part.tasks, number_of(part.size))
        part.lengths = summed(tally for shard in part.shards for tally in shard.tally)
    weights = stratum_weights(manifest.strata) if manifest.strata else {}
    for part in manifest.parts:
        part.weight = msgspec.UNSET
        if part.tasks and weights:
            part.weight = share_of(*(weights[part.name] / part.tasks).as_integer_ratio())
    manifest.covered = share_of(manifest.rows("tasks"), manifest.size)


DATASET = ManifestFile(NAME, Manifest, "prag_asp dataset", 1, "dataset")
"""The file dataset.json; the file and the tables have version 1."""


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write dataset.json atomically, with the figures that follow from the shards.

    Raises:
        OutputError: the file cannot be written.
    """
    derive(manifest)
    DATASET.write(folder, manifest)
