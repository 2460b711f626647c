"""The statistics that LeRobot stores for each feature: per episode, and over all episodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Statistics = Mapping[str, Floats]
QUANTILES = (0.01, 0.10, 0.50, 0.90, 0.99)
NAMES = ("min", "max", "mean", "std", "count", *(f"q{round(100 * each):02d}" for each in QUANTILES))
LEVELS = 256
"""The number of levels of a colour channel with 8 bits."""

BOUNDS = dict.fromkeys(("min", "q01", "q10", "q50"), np.minimum)
"""The statistics that are aggregated by the minimum over episodes; other quantiles are aggregated by the maximum."""


def statistics_of(values: NDArray[Any]) -> Statistics:
    """Return the exact statistics of N values of shape (N,) or (N, D); each statistic has shape (1,) or (D,)."""
    rows = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
    least, most, mean, spread = rows.min(0), rows.max(0), rows.mean(0), rows.std(0)
    quantiles = np.quantile(rows, QUANTILES, axis=0)
    return dict(zip(NAMES, (least, most, mean, spread, np.array([len(rows)]), *quantiles), strict=True))


class Colours:
    """A histogram of the colours of 8-bit images of shape (H, W, 3), which are added one by one."""

    def __init__(self) -> None:
        self._counts = np.zeros((3, LEVELS), dtype=np.int64)
        self._pictures = 0

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Count the pixels of an image."""
        for channel in range(3):
            self._counts[channel] += np.bincount(picture[..., channel].ravel(), minlength=LEVELS)
        self._pictures += 1

    def statistics(self) -> Statistics:
        """Return the statistics of each channel over all pixels, in the range 0 to 1; each has shape (3, 1, 1)."""
        levels, channels = np.arange(LEVELS) / (LEVELS - 1), []
        for counts in self._counts:
            occurring, total, cumulative = np.flatnonzero(counts), counts.sum(), counts.cumsum()
            mean = float(counts @ levels / total)
            result = {"min": float(levels[occurring[0]]), "max": float(levels[occurring[-1]]), "mean": mean}
            result["std"] = float(np.sqrt(counts @ (levels - mean) ** 2 / total))
            for name, share in zip(NAMES[-len(QUANTILES) :], QUANTILES, strict=True):
                result[name] = float(levels[np.searchsorted(cumulative, share * (total - 1), side="right")])
            channels.append(result)
        values = {name: np.array([each[name] for each in channels]).reshape(3, 1, 1) for name in channels[0]}
        return {name: values[name] if name in values else np.array([self._pictures]) for name in NAMES}


class Aggregate:
    """The statistics of one feature over episodes, which are added one by one.

    The mean and the deviation are exact. Quantiles of all values do not follow from the quantiles of the episodes; as
    in LeRobot, the result is a bound: the minimum over episodes for quantiles up to the median, and the maximum for
    those above it.
    """

    def __init__(self) -> None:
        self._total: dict[str, Floats] = {}

    def add(self, each: Statistics) -> None:
        """Add the statistics of an episode."""
        total = self._total
        if not total:
            self._total = dict(each)
            return
        count, more = total["count"][0], each["count"][0]
        mean = total["mean"] + (each["mean"] - total["mean"]) * more / (count + more)
        squares = sum(
            number * (of["std"] ** 2 + (of["mean"] - mean) ** 2) for of, number in ((total, count), (each, more))
        )
        self._total = {
            **{name: BOUNDS.get(name, np.maximum)(total[name], each[name]) for name in NAMES},
            "mean": mean,
            "std": np.sqrt(squares / (count + more)),
            "count": total["count"] + each["count"],
        }

    def statistics(self) -> Statistics:
        """Return the statistics over all episodes that were added."""
        return self._total


def as_lists(statistics: Statistics) -> dict[str, Any]:
    """Return statistics as JSON values; the count is an integer."""
    return {
        name: value.astype(int).tolist() if name == "count" else value.tolist() for name, value in statistics.items()
    }


def flattened(features: Mapping[str, Statistics], names: Sequence[str] = NAMES) -> Iterable[tuple[str, Any]]:
    """Yield the name, ``stats/FEATURE/NAME``, and the value of each statistic of an episode."""
    for feature, statistics in features.items():
        values = as_lists(statistics)
        yield from ((f"stats/{feature}/{name}", values[name]) for name in names)
