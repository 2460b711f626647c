"""A map of tasks in two dimensions, in which nearby points are similar tasks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.plots.picture import COLORS, DOTS, GREY
from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import stage

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST = 5_000
"""The largest number of tasks in a map; beyond it, computing the eigenvectors takes minutes."""

INCHES = 7.0
"""The size of a picture in inches."""


@dataclass(frozen=True)
class TaskMap:
    """One point for each task, shape (tasks, 2), and the share of the sum of positive eigenvalues in these two axes."""

    points: NDArray[np.float64]
    share: float


def task_map(distances: NDArray[np.float64]) -> TaskMap:
    """Return the classical scaling (Torgerson 1952) of distances, which have shape (tasks, tasks).

    The sign of each axis is such that its largest coordinate is positive.

    Raises:
        QueryError: there are too many tasks.
    """
    count = len(distances)
    if count > MOST:
        raise QueryError(f"a map of {count:,} tasks is too large; take at most {MOST:,}")
    stage("drawing a map")
    squares = np.square(distances)
    means = squares.mean(axis=0) if count else np.zeros(0)
    centred = -0.5 * (squares - means - means[:, None] + (means.mean() if count else 0.0))
    values, vectors = np.linalg.eigh(centred)
    best = values[::-1][:2].clip(0.0)
    points = np.zeros((count, 2))
    points[:, : len(best)] = vectors[:, ::-1][:, :2] * np.sqrt(best)
    if count:
        largest = points[np.abs(points).argmax(axis=0), [0, 1]]
        points *= np.where(largest < 0, -1.0, 1.0)
    positive = float(values.clip(0.0).sum())
    return TaskMap(points, float(best.sum()) / positive if positive else 1.0)


def map_figure(placed: TaskMap, groups: list[str], title: str) -> Figure:
    """Return the map as a matplotlib figure; `groups` names each task's group, and each group has its own colour."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - heavy

    drawn = Figure(figsize=(INCHES, INCHES), dpi=DOTS, layout="constrained")
    axes = drawn.add_subplot(aspect="equal")
    axes.set_title(f"{title} ({placed.share:.0%} of the variance)", parse_math=False)
    colours = (*COLORS, GREY)
    named = list(dict.fromkeys(groups))
    for number, name in enumerate(named):
        own = np.array([group == name for group in groups], dtype=np.bool_)
        size = 20.0 if len(groups) <= 500 else 4.0
        across, up = placed.points[own].T
        axes.scatter(across, up, s=size, color=colours[number % len(colours)], label=name, linewidths=0)
    if len(named) > 1:
        axes.legend(frameon=False, fontsize=7)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[["top", "right", "left", "bottom"]].set_visible(False)
    return drawn
