"""Compute the distances between all pairs of tasks, up to renaming, in blocks that fit into memory.

    tasks -> features, each once -> renamed features (one for each renaming that matters) -> table of codes
          -> block of rows x renamed columns -> least of each column's renamings -> matrix, neighbours, ...

The relevant renamings depend only on the entities of the row, so rows are grouped by their entities.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import so_far, stage
from prag_asp.similarity.background import Background, Trace, UpTo
from prag_asp.similarity.distance_tables import DistanceTable, Numbers, Values
from prag_asp.similarity.edit_arrays import small_type
from prag_asp.similarity.features import Feature
from prag_asp.similarity.metrics import Metric, metric_of
from prag_asp.similarity.symbols import entities_in, renamer

if TYPE_CHECKING:
    from prag_asp.task import KnownDomain

MOST_IMAGES = 2_000_000
"""The maximum total number of renamed features over all groups of rows; they take about 2 GB."""

STRIPE = 1 << 23
"""The number of pairs of tasks whose distances are in memory at a time; they take at most 32 MB."""


@dataclass(frozen=True)
class Images:
    """Images of all features under the renamings that matter to a group of rows; `starts` separates the features."""

    numbers: Numbers
    starts: Numbers

    def of(self, first: int, last: int) -> tuple[Numbers, Numbers]:
        """Return the images of the features from `first` to `last`, and the index of the first image of each."""
        starts = self.starts[first : last + 1]
        return self.numbers[starts[0] : starts[-1]], starts[:-1] - starts[0]


@dataclass(frozen=True)
class PairDistances:
    """The distances between all pairs of the given tasks.

    `place` maps each task to its feature; several tasks can have the same feature. `groups` holds, for each group of
    rows, the range of its features and the images of all features.
    """

    metric: Metric
    table: DistanceTable
    place: Numbers
    groups: tuple[tuple[range, Images], ...]

    @property
    def count(self) -> int:
        """The number of tasks."""
        return len(self.place)

    @property
    def denominator(self) -> int:
        """The number of units in a distance of 1, or 0 if distances are floats."""
        return self.table.denominator

    @property
    def features(self) -> int:
        """The number of distinct features."""
        return self.groups[-1][0].stop if self.groups else 0

    @property
    def kind(self) -> type[Any]:
        """The NumPy type of distances."""
        return small_type(self.table.largest) if self.denominator else np.float32

    @cached_property
    def plain(self) -> Numbers:
        """The index of each feature in the table, without renaming."""
        return np.array([images.numbers[images.starts[at]] for own, images in self.groups for at in own], dtype=np.intp)

    def block(self, rows: Numbers, images: Images, columns: range) -> Values:
        """Return the distances from the features of one group, given their images, to a range of features."""
        numbers, starts = images.of(columns.start, columns.stop)
        found = self.table.block(self.plain[rows], numbers)
        return found if len(numbers) == len(columns) else np.minimum.reduceat(found, starts, axis=1)

    def _columns(self, images: Images, first: int) -> Iterator[range]:
        """Yield ranges of features, in order, each with about as many images as a block has columns."""
        starts, width = images.starts, self.table.shape[1]
        while first < self.features:
            last = max(int(np.searchsorted(starts, starts[first] + width, side="right")) - 1, first + 1)
            yield range(first, min(last, self.features))
            first = last

    def square(self) -> Values:
        """Return the distances between all features, in units; shape (features, features)."""
        stage("comparing tasks")
        values = np.zeros((self.features, self.features), self.kind)
        step, _ = self.table.shape
        for own, images in self.groups:
            for first in range(own.start, own.stop, step):
                last = min(first + step, own.stop)
                for columns in self._columns(images, first):  # those on and above the diagonal
                    block = self.block(np.arange(first, last), images, columns)
                    values[first:last, columns.start : columns.stop] = block
                    values[columns.start : columns.stop, first:last] = block.T
                left = 1 - last / self.features
                so_far(f"{1 - left**2:.0%} of {self.count:,} x {self.count:,} tasks")
        return values

    def row(self, task: int) -> Values:
        """Return the distances from one task to all tasks, in units."""
        feature = int(self.place[task])
        images = next(images for own, images in self.groups if feature in own)
        blocks = [self.block(np.array([feature]), images, columns)[0] for columns in self._columns(images, 0)]
        values: Values = np.concatenate(blocks)[self.place]
        return values

    def stripes(self) -> Iterator[tuple[range, Values]]:
        """Yield the distances from ranges of tasks to all tasks, in order, without storing a whole matrix."""
        stage("comparing tasks")
        step = max(STRIPE // max(self.count, 1), 1)
        for first in range(0, self.count, step):
            tasks = range(first, min(first + step, self.count))
            needed, inverse = np.unique(self.place[tasks.start : tasks.stop], return_inverse=True)
            values = np.empty((len(needed), self.features), self.kind)
            for own, images in self.groups:
                low, high = np.searchsorted(needed, (own.start, own.stop))
                for columns in self._columns(images, 0) if low < high else ():
                    values[low:high, columns.start : columns.stop] = self.block(needed[low:high], images, columns)
            so_far(f"{tasks.stop:,} of {self.count:,} tasks")
            yield tasks, values[inverse][:, self.place]


def pair_distances(
    tasks: Sequence[Trace],
    metric: str | Metric = "combined",
    within: KnownDomain | None = None,
    up_to: UpTo = "names",
) -> PairDistances:
    """Return the distances between all pairs of tasks, computed in blocks; the arguments are those of `Task.distance`.

    Raises:
        QueryError: there is no such metric, it cannot compare these tasks, or too many renamings matter.
        SimilarityMissingError: the metric needs rapidfuzz, which is not installed.
    """
    stage("reading tasks")
    found = metric if isinstance(metric, Metric) else metric_of(metric)
    background = within.background if within is not None else Background.of_tasks(tasks, up_to)
    features = [found.features(task, background) for task in tasks]
    entities = background.interchange.entities
    mentioned = {feature: tuple(dict.fromkeys(entities_in(feature, entities))) for feature in features}
    ordered = sorted(mentioned, key=lambda feature: sorted(mentioned[feature]))
    groups: dict[frozenset[str], list[int]] = {}
    for number, feature in enumerate(ordered):
        groups.setdefault(frozenset(mentioned[feature]), []).append(number)
    numbers: dict[Feature, int] = {}
    listed = []
    for fixed, members in groups.items():
        listed.append((range(members[0], members[-1] + 1), _images(ordered, mentioned, background, fixed, numbers)))
    table = found.measure(background).table(tuple(numbers))
    number_of = {feature: number for number, feature in enumerate(ordered)}
    place = np.array([number_of[feature] for feature in features], dtype=np.intp)
    return PairDistances(found, table, place, tuple(listed))


def _images(
    ordered: Sequence[Feature],
    mentioned: dict[Feature, tuple[str, ...]],
    background: Background,
    fixed: frozenset[str],
    numbers: dict[Feature, int],
) -> Images:
    """Return the images of features that matter to rows with the entities `fixed`; `numbers` maps images to indices.

    Raises:
        QueryError: there are too many images.
    """
    renamers: dict[tuple[str, ...], list[Any]] = {}
    allowed = MOST_IMAGES - len(numbers)
    by_names: dict[frozenset[tuple[str, str]], Any] = {}
    images: list[int] = []
    starts = [0]
    for feature in ordered:
        names = mentioned[feature]
        if names not in renamers:
            renamings = islice(background.interchange.renamings(names, fixed), max(allowed, 0) + 1)
            renamers[names] = [by_names.setdefault(frozenset(each.items()), renamer(each)) for each in renamings]
        renamed = (rename(feature) for rename in renamers[names])
        images += dict.fromkeys(numbers.setdefault(each, len(numbers)) for each in renamed)
        starts.append(len(images))
        if len(images) > allowed:
            raise QueryError(
                f"these tasks have more than {MOST_IMAGES:,} renamings that matter; compare fewer tasks, or "
                "entities by their names (up_to names)"
            )
    return Images(np.array(images, dtype=np.intp), np.array(starts, dtype=np.intp))
