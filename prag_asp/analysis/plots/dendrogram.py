"""Hierarchical clustering of tasks by average distance, and its picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.plots.picture import COLORS, DOTS
from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import so_far, stage

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST = 5_000
"""The maximum number of tasks in a dendrogram, whose table of distances takes 200 MB."""

LABELLED = 60
"""The maximum number of leaves for which labels are drawn."""

INCHES = 8.0
"""The size of a picture in inches."""


@dataclass(frozen=True)
class Dendrogram:
    """Merges of clusters, lowest first: the two clusters, the mean distance between their tasks, and the union's size.

    Clusters with numbers below `count` are tasks; the cluster of merge k has the number `count` + k.
    """

    count: int
    merges: tuple[tuple[int, int, float, int], ...]

    @property
    def leaves(self) -> tuple[int, ...]:
        """The tasks in an order in which no two lines of the picture cross."""
        if not self.merges:
            return tuple(range(self.count))
        order: list[int] = []
        waiting = [self.count + len(self.merges) - 1]
        while waiting:
            cluster = waiting.pop()
            if cluster < self.count:
                order.append(cluster)
            else:
                first, second, _, _ = self.merges[cluster - self.count]
                waiting += [second, first]
        return tuple(order)

    def clusters(self, height: float) -> list[list[int]]:
        """Return the clusters after all merges at mean distances of up to `height`, ordered by their smallest task."""
        members = {task: [task] for task in range(self.count)}
        for number, (first, second, at, _) in enumerate(self.merges):
            if at > height:
                break
            members[self.count + number] = sorted(members.pop(first) + members.pop(second))
        return sorted(members.values())


def dendrogram_of(distances: NDArray[np.float64]) -> Dendrogram:
    """Cluster tasks by average distance (UPGMA, Sokal and Michener 1958), given distances of shape (tasks, tasks).

    The clusters are found in quadratic time by nearest-neighbour chains (Murtagh 1983).

    Raises:
        QueryError: there are too many tasks.
    """
    count = len(distances)
    if count > MOST:
        raise QueryError(f"a dendrogram of {count:,} tasks is too large; take at most {MOST:,}")
    stage("clustering tasks")
    table = np.array(distances, dtype=np.float64)
    np.fill_diagonal(table, np.inf)
    sizes, found, chain = np.ones(count), list[tuple[int, int, float]](), list[int]()
    alive = np.ones(count, dtype=np.bool_)
    while len(found) < count - 1:
        if not chain:
            chain = [int(np.flatnonzero(alive)[0])]
        last = chain[-1]
        near = int(np.argmin(table[last]))
        if len(chain) > 1 and table[last, chain[-2]] <= table[last, near]:
            near = chain[-2]
        if len(chain) < 2 or near != chain[-2]:
            chain.append(near)
            continue
        del chain[-2:]
        low, high = sorted((last, near))
        found.append((low, high, float(table[low, high])))
        mean = (sizes[low] * table[low] + sizes[high] * table[high]) / (sizes[low] + sizes[high])
        table[low], table[:, low] = mean, mean
        table[low, low], table[high], table[:, high] = np.inf, np.inf, np.inf
        sizes[low] += sizes[high]
        alive[high] = False
        so_far(f"{len(found):,} of {count - 1:,} merges")
    return Dendrogram(count, _numbered(found, count))


def _numbered(found: Sequence[tuple[int, int, float]], count: int) -> tuple[tuple[int, int, float, int], ...]:
    """Return merges in order of height, with the numbers of their clusters.

    In `found`, each cluster is represented by one of its tasks.
    """
    above = list(range(count))
    cluster_of, sizes = {task: task for task in range(count)}, dict.fromkeys(range(count), 1)

    def representative(task: int) -> int:
        while above[task] != task:
            above[task] = above[above[task]]
            task = above[task]
        return task

    merges = []
    for number, (low, high, height) in enumerate(sorted(found, key=lambda merge: merge[2])):
        one, other = representative(low), representative(high)
        first, second = sorted((cluster_of[one], cluster_of[other]))
        above[other] = one
        sizes[one] += sizes[other]
        cluster_of[one] = count + number
        merges.append((first, second, height, sizes[one]))
    return tuple(merges)


def dendrogram_figure(dendrogram: Dendrogram, labels: Sequence[str], title: str) -> Figure:
    """Return the dendrogram as a matplotlib figure; at most `LABELLED` tasks get labels."""
    from matplotlib.collections import LineCollection  # noqa: PLC0415 - heavy
    from matplotlib.figure import Figure  # noqa: PLC0415 - heavy

    leaves = dendrogram.leaves
    place = {task: (0.0, float(at)) for at, task in enumerate(leaves)}
    lines = []
    for number, (first, second, height, _) in enumerate(dendrogram.merges):
        (x, y), (other_x, other_y) = place[first], place[second]
        lines.append([(x, y), (height, y), (height, other_y), (other_x, other_y)])
        place[dendrogram.count + number] = (height, (y + other_y) / 2)
    labelled = dendrogram.count <= LABELLED
    drawn = Figure(figsize=(INCHES, max(3.0, 0.2 * dendrogram.count) if labelled else INCHES), dpi=DOTS,
                   layout="constrained")  # fmt: skip
    axes = drawn.add_subplot(xlabel="mean distance")
    axes.set_title(title, parse_math=False)
    axes.add_collection(LineCollection(lines, colors=COLORS[0], linewidths=1.5 if labelled else 0.5))
    axes.set_xlim(0.0, max((height for *_, height, _ in dendrogram.merges), default=1.0) * 1.05 or 1.0)
    axes.set_ylim(-1.0, float(dendrogram.count))
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set_yticks(range(dendrogram.count) if labelled else [])
    if labelled:
        axes.set_yticklabels([labels[task] for task in leaves], fontsize=7, parse_math=False)
    return drawn
