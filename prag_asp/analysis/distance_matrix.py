"""The matrix of distances between tasks, the nearest tasks, and near-duplicates."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from io import BytesIO
from math import floor, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.all_pairs import STRIPE, PairDistances, pair_distances
from prag_asp.errors import QueryError
from prag_asp.output import replace_file
from prag_asp.similarity.distance_tables import Numbers, Values

if TYPE_CHECKING:
    from prag_asp.similarity.background import Trace, UpTo
    from prag_asp.similarity.metrics import Metric
    from prag_asp.task import KnownDomain

MOST_BYTES = 4 * 10**9
"""The maximum size in bytes of a matrix in memory."""

SUFFIXES = (".npz", ".parquet")
"""The extensions of files with distances."""


@dataclass(frozen=True)
class SimilarityMatrix:
    """The distances between all pairs of tasks, shape (tasks, tasks).

    `units` are exact integers, and a distance of 1 is `denominator` units. If `denominator` is 0, `units` are 32-bit
    floats.
    """

    units: Values
    denominator: int
    pairs: PairDistances = field(repr=False)

    @property
    def count(self) -> int:
        """The number of tasks."""
        return len(self.units)

    def row(self, task: int) -> Values:
        """Return the distances from one task to all tasks, in units."""
        row: Values = self.units[task]
        return row

    @property
    def distances(self) -> NDArray[np.float64]:
        """The distances as floats."""
        values: NDArray[np.float64] = self.units / float(self.denominator or 1)
        return values

    @property
    def similarities(self) -> NDArray[np.float32]:
        """1 minus the normalised distances, which lie between 0 and 1."""
        numbers = self.pairs.plain[self.pairs.place]
        values: NDArray[np.float32] = 1 - self.pairs.table.normalised(self.units, numbers, numbers)
        return values

    def save(self, file: str | Path) -> None:
        """Write the matrix to a .npz file (`units` and `denominator`) or a .parquet file (one row for each pair i < j).

        Raises:
            QueryError: the file has neither extension.
            OutputError: the file cannot be written.
            DatasetsMissingError: the file is a .parquet, and pyarrow is not installed.
        """
        check_suffix(file)
        if Path(file).suffix == ".parquet":
            first, second = np.triu_indices(len(self.units), 1)
            distances = self.units[first, second] / float(self.denominator or 1)
            save_columns(file, task=first, other=second, distance=distances)
            return
        buffer = BytesIO()
        np.savez_compressed(buffer, units=self.units, denominator=np.int64(self.denominator))
        replace_file(file, buffer.getvalue())


def check_suffix(file: str | Path) -> None:
    """Check that a matrix, or neighbours, can be written to a file with this name.

    Raises:
        QueryError: the extension is unknown.
    """
    if Path(file).suffix not in SUFFIXES:
        raise QueryError(f"{file}: distances are written to a file that ends in {' or '.join(SUFFIXES)}")


def save_columns(file: str | Path, **columns: NDArray[Any]) -> None:
    """Write columns of equal length as the arrays of a .npz file or as the columns of a .parquet file.

    Raises:
        QueryError: the file has neither extension.
        OutputError: the file cannot be written.
        DatasetsMissingError: the file is a .parquet, and pyarrow is not installed.
    """
    check_suffix(file)
    buffer = BytesIO()
    if Path(file).suffix == ".parquet":
        from prag_asp.missing import require_pyarrow  # noqa: PLC0415 - only Parquet needs it

        require_pyarrow()
        import pyarrow as pa  # noqa: PLC0415
        from pyarrow.parquet import write_table  # noqa: PLC0415

        table = pa.table({name: pa.array(column) for name, column in columns.items()})
        write_table(table, buffer, compression="zstd")
    else:
        arrays: dict[str, Any] = dict(columns)
        np.savez_compressed(buffer, **arrays)
    replace_file(file, buffer.getvalue())


def similarity_matrix(
    tasks: Sequence[Trace],
    metric: str | Metric = "combined",
    *,
    within: KnownDomain | None = None,
    up_to: UpTo = "names",
) -> SimilarityMatrix:
    """Return the distances between all pairs of tasks; the arguments are those of `Task.distance`.

    Raises:
        QueryError: there is no such metric, it cannot compare these tasks, or the matrix is larger than 4 GB.
        SimilarityMissingError: the metric needs rapidfuzz, which is not installed.
    """
    return matrix_of(pair_distances(tasks, metric, within, up_to))


def fits(pairs: PairDistances) -> bool:
    """Return whether a matrix is small enough to keep in memory."""
    return pairs.count**2 * np.dtype(pairs.kind).itemsize <= MOST_BYTES


def matrix_of(pairs: PairDistances) -> SimilarityMatrix:
    """Return the distances between all pairs as a matrix.

    Raises:
        QueryError: the matrix is larger than 4 GB.
    """
    if not fits(pairs):
        raise QueryError(
            f"a matrix of {pairs.count:,} tasks takes more than {MOST_BYTES / 10**9:.0f} GB; "
            "take fewer tasks, or compute neighbours and duplicates without a matrix"
        )
    square = pairs.square()
    same = pairs.features == pairs.count and bool((pairs.place == np.arange(pairs.count)).all())
    units = square if same else square[np.ix_(pairs.place, pairs.place)]
    return SimilarityMatrix(units, pairs.table.denominator, pairs)


Stripes = Iterable[tuple[range, Values]]
"""Ranges of tasks with their distances to all tasks."""


def stripes_of(given: SimilarityMatrix | PairDistances) -> Stripes:
    """Return the distances from all tasks to all tasks, taken from a matrix or computed without one."""
    if isinstance(given, PairDistances):
        return given.stripes()
    step = max(STRIPE // max(given.count, 1), 1)
    return ((range(at, min(at + step, given.count)), given.units[at : at + step]) for at in range(0, given.count, step))


@dataclass(frozen=True)
class NearestNeighbours:
    """The tasks nearest to each task, nearest first; at equal distances, smaller indices come first.

    `tasks` and `distances` have shape (tasks, k).
    """

    tasks: Numbers
    distances: NDArray[np.float64]

    def save(self, file: str | Path) -> None:
        """Write a row for each task and neighbour (`task`, `other` and `distance`) to a .npz or .parquet file.

        Raises:
            QueryError: the file has neither extension.
            OutputError: the file cannot be written.
            DatasetsMissingError: the file is a .parquet, and pyarrow is not installed.
        """
        task = np.repeat(np.arange(len(self.tasks)), self.tasks.shape[1])
        save_columns(file, task=task, other=self.tasks.ravel(), distance=self.distances.ravel())


def nearest_neighbours(given: SimilarityMatrix | PairDistances, count: int = 5) -> NearestNeighbours:
    """Return the other tasks that are nearest to each task, at most `count` of them."""
    denominator = given.denominator or 1
    tasks, distances = [], []
    for numbers, values in stripes_of(given):
        for number, row in zip(numbers, values, strict=True):
            order = np.argsort(row, kind="stable")
            near = order[order != number][:count].copy()  # a view would keep the whole row
            tasks.append(near)
            distances.append(row[near] / float(denominator))
    shape = (len(tasks), max(min(count, len(tasks) - 1), 0))
    return NearestNeighbours(np.array(tasks, np.intp).reshape(shape), np.array(distances, np.float64).reshape(shape))


@dataclass(frozen=True)
class NearDuplicates:
    """Pairs of tasks at a small distance, each with the smaller index first, in order; iteration yields tuples."""

    tasks: Numbers
    others: Numbers
    distances: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.tasks)

    def __iter__(self) -> Iterator[tuple[int, int, float]]:
        for pair in zip(self.tasks, self.others, self.distances, strict=True):
            yield int(pair[0]), int(pair[1]), float(pair[2])

    def save(self, file: str | Path) -> None:
        """Write a row for each pair (`task`, `other` and `distance`) to a .npz or .parquet file.

        Raises:
            QueryError: the file has neither extension.
            OutputError: the file cannot be written.
            DatasetsMissingError: the file is a .parquet, and pyarrow is not installed.
        """
        save_columns(file, task=self.tasks, other=self.others, distance=self.distances)


def near_duplicates(given: SimilarityMatrix | PairDistances, at_most: float = 0.0) -> NearDuplicates:
    """Return the pairs of tasks whose distance is at most `at_most`, which is read as a decimal number.

    Raises:
        QueryError: `at_most` is infinite or not a number.
    """
    if not isfinite(at_most):
        raise QueryError(f"near-duplicates at a distance of at most {at_most}: give a number, such as 0.5")
    denominator = given.denominator
    limit = floor(Fraction(str(at_most)) * denominator) if denominator else at_most
    found = []
    for numbers, values in stripes_of(given):
        rows, columns = np.nonzero(values <= limit)
        later = columns > rows + numbers.start
        rows, columns = rows[later], columns[later]
        found.append((rows + numbers.start, columns, values[rows, columns] / float(denominator or 1)))
    joined = [np.concatenate(column) for column in zip(*found, strict=True)] if found else [np.zeros(0, np.intp)] * 3
    return NearDuplicates(*joined)


def without_duplicates(given: SimilarityMatrix | PairDistances, at_most: float = 0.0) -> list[int]:
    """Return the indices of the tasks that remain after dropping each task that is near an earlier remaining task.

    Raises:
        QueryError: `at_most` is infinite or not a number.
    """
    out: set[int] = set()
    for first, second, _ in near_duplicates(given, at_most):
        if first not in out:
            out.add(second)
    return [number for number in range(given.count) if number not in out]
