"""The statistics that LeRobot keeps of each feature: of an episode, and of all."""

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


def statistics_of(values: NDArray[Any]) -> Statistics:
    """Return the statistics of N values of shape (N,) or (N, D), each of shape (1,) or (D,), exactly."""
    rows = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
    least, most, mean, spread = rows.min(0), rows.max(0), rows.mean(0), rows.std(0)
    quantiles = np.quantile(rows, QUANTILES, axis=0)
    return dict(zip(NAMES, (least, most, mean, spread, np.array([len(rows)]), *quantiles), strict=True))


class Colours:
    """Counts the colours of pictures, shape (H, W, 3), one picture after the other."""

    def __init__(self) -> None:
        self._counts = np.zeros((3, LEVELS), dtype=np.int64)
        self._pictures = 0

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Count the pixels of a picture."""
        for channel in range(3):
            self._counts[channel] += np.bincount(picture[..., channel].ravel(), minlength=LEVELS)
        self._pictures += 1

    def statistics(self) -> Statistics:
        """Return the statistics of each channel from 0 to 1, over all pixels, each of shape (3, 1, 1)."""
        found = [_of_histogram(counts) for counts in self._counts]
        values = {name: np.array([each[name] for each in found]).reshape(3, 1, 1) for name in found[0]}
        return {name: values[name] if name in values else np.array([self._pictures]) for name in NAMES}


def _of_histogram(counts: NDArray[np.int64]) -> dict[str, float]:
    """Return the statistics of values from 0 to 1, of which each of `LEVELS` steps comes so many times."""
    steps = np.arange(LEVELS) / (LEVELS - 1)
    there, total, below = np.flatnonzero(counts), counts.sum(), counts.cumsum()
    mean = float(counts @ steps / total)
    found = {"min": float(steps[there[0]]), "max": float(steps[there[-1]]), "mean": mean}
    found["std"] = float(np.sqrt(counts @ (steps - mean) ** 2 / total))
    for name, share in zip(NAMES[-len(QUANTILES) :], QUANTILES, strict=True):
        found[name] = float(steps[np.searchsorted(below, share * (total - 1), side="right")])
    return found


class Aggregate:
    """Adds up the statistics of one feature over episodes, in the memory of one.

    Mean and deviation are exact. Of a quantile, what is kept is the least of those up to the median, and the largest of
    those above it, as LeRobot does: bounds, for the quantile of all cannot be known from those of parts.
    """

    def __init__(self) -> None:
        self._found: dict[str, Floats] = {}

    def add(self, each: Statistics) -> None:
        """Add the statistics of an episode."""
        known = self._found
        if not known:
            self._found = dict(each)
            return
        count, more = known["count"][0], each["count"][0]
        mean = known["mean"] + (each["mean"] - known["mean"]) * more / (count + more)
        squares = sum(
            number * (of["std"] ** 2 + (of["mean"] - mean) ** 2) for of, number in ((known, count), (each, more))
        )
        self._found = {
            **{name: _bound(name)(known[name], each[name]) for name in NAMES},
            "mean": mean,
            "std": np.sqrt(squares / (count + more)),
            "count": known["count"] + each["count"],
        }

    def statistics(self) -> Statistics:
        """Return the statistics of all that was added."""
        return self._found


def _bound(name: str) -> Any:
    """Return which of two values is kept."""
    return np.minimum if name in ("min", "q01", "q10", "q50") else np.maximum


def as_lists(statistics: Statistics) -> dict[str, Any]:
    """Return statistics as JSON has them: the count is a whole number."""
    return {
        name: value.astype(int).tolist() if name == "count" else value.tolist() for name, value in statistics.items()
    }


def flattened(features: Mapping[str, Statistics], names: Sequence[str] = NAMES) -> Iterable[tuple[str, Any]]:
    """Yield the columns of an episode: ``stats/FEATURE/NAME`` with its value."""
    for feature, statistics in features.items():
        values = as_lists(statistics)
        yield from ((f"stats/{feature}/{name}", values[name]) for name in names)
