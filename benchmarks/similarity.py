"""Compare all pairs of tasks: python benchmarks/similarity.py [--tasks 10000].

Each way compares random tasks of `prag` of length 15; slow ones compare fewer pairs, and the table scales their time to
all pairs. The five metrics of the paper's code are written here in plain Python, as its authors run them.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from itertools import combinations
from time import process_time

import numpy as np
from rapidfuzz import process
from rapidfuzz.distance import Hamming, JaroWinkler, LCSseq, Levenshtein
from rich.console import Console
from rich.table import Table

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.analysis import pair_distances
from prag_asp.similarity.string_distances import spelled, substring_distance

LENGTH = 15
FEW = 60
"""The number of tasks that the ways in plain Python compare."""

BLOCK = 500
"""The number of tasks that numpy compares without blocks."""


def all_pairs(count: int) -> int:
    """Return the number of pairs of different tasks."""
    return count * (count - 1) // 2


def seconds(run: Callable[[], object]) -> float:
    """Return the seconds of processor time of a run."""
    begun = process_time()
    run()
    return process_time() - begun


def by_rapidfuzz(texts: Sequence[str]) -> None:
    """Compare all pairs of texts by Levenshtein; one thread, and the whole square, because cdist has no half."""
    process.cdist(texts, texts, scorer=Levenshtein.distance, dtype=np.uint8, workers=1)


def by_numpy(codes: np.ndarray, costs: np.ndarray) -> np.ndarray:
    """Return the edit distances of all pairs in 64 bits, one cell of the table for all pairs, without blocks."""
    count, length = codes.shape
    before = [np.full((count, count), float(at)) for at in range(length + 1)]
    for step in range(length):
        now = [np.full((count, count), step + 1.0)]
        for at in range(length):
            replaced = before[at] + costs[codes[:, step, None], codes[None, :, at]]
            now.append(np.minimum(replaced, np.minimum(before[at + 1], now[at]) + 1))
        before = now
    return before[-1]


def levenshtein(one: Sequence[str], other: Sequence[str]) -> int:
    """Return the Levenshtein distance, in plain Python."""
    row = list(range(len(other) + 1))
    for place, each in enumerate(one, 1):
        diagonal, row[0] = row[0], place
        for at, character in enumerate(other, 1):
            diagonal, row[at] = row[at], min(row[at] + 1, row[at - 1] + 1, diagonal + (each != character))
    return row[-1]


def subsequence(one: Sequence[str], other: Sequence[str]) -> int:
    """Return the length of the longest common subsequence, in plain Python."""
    row = [0] * (len(other) + 1)
    for each in one:
        diagonal = 0
        for at, character in enumerate(other, 1):
            diagonal, row[at] = row[at], diagonal + 1 if each == character else max(row[at], row[at - 1])
    return row[-1]


def jaro_winkler(one: Sequence[str], other: Sequence[str]) -> float:
    """Return the similarity of Jaro and Winkler, in plain Python."""
    reach = max(max(len(one), len(other)) // 2 - 1, 0)
    free, matched = [True] * len(other), []
    for place, each in enumerate(one):
        for at in range(max(0, place - reach), min(len(other), place + reach + 1)):
            if free[at] and other[at] == each:
                free[at] = False
                matched.append(each)
                break
    if not matched:
        return 0.0
    swapped = sum(a != b for a, b in zip(matched, (b for b, f in zip(other, free, strict=True) if not f), strict=True))
    count = len(matched)
    jaro = (count / len(one) + count / len(other) + (count - swapped // 2) / count) / 3
    prefix = next((at for at in range(4) if one[at] != other[at]), 4)
    return jaro + prefix * 0.1 * (1 - jaro) if jaro > 0.7 else jaro  # as rapidfuzz does


def hamming(one: Sequence[str], other: Sequence[str]) -> int:
    """Return the Hamming distance, in plain Python."""
    return sum(a != b for a, b in zip(one, other, strict=True))


def check(texts: Sequence[str]) -> None:
    """Check that plain Python and rapidfuzz agree."""
    for one, other in combinations(texts[:20], 2):
        assert levenshtein(one, other) == Levenshtein.distance(one, other)
        assert hamming(one, other) == Hamming.distance(one, other)
        assert subsequence(one, other) == LCSseq.similarity(one, other)
        assert abs(jaro_winkler(one, other) - JaroWinkler.similarity(one, other)) < 1e-12


def ours(space: TaskSpace, tasks: Sequence[Task], metric: str) -> float:
    """Return the seconds that we take for all pairs by a metric, from tasks to a matrix."""
    return seconds(lambda: pair_distances(tasks, metric, within=space).square())


def main() -> None:
    """Print the processor time of each way for all pairs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=10_000)
    count = parser.parse_args().tasks
    space = TaskSpace(load_domain("prag"), LENGTH)
    tasks = space.sample(count, seed=1)
    texts = spelled(*(task.actions for task in tasks))
    check(texts)
    every, few = all_pairs(count), all_pairs(FEW)
    characters = sorted(set("".join(texts[:BLOCK])))
    codes = np.array([[characters.index(each) for each in text] for text in texts[:BLOCK]])
    costs = 1.0 - np.eye(len(characters))
    plain = {
        "Levenshtein": levenshtein, "Hamming": hamming, "Jaro-Winkler": jaro_winkler,
        "longest common subsequence": subsequence, "longest common substring": substring_distance,
    }  # fmt: skip
    rows: list[tuple[str, str, float]] = [("rapidfuzz, cdist", "names", seconds(lambda: by_rapidfuzz(texts)))]
    taken = seconds(lambda: by_numpy(codes, costs)) / BLOCK**2 * count**2
    rows.append(("numpy, whole table in 64 bits, costs", "names", taken))
    for name, distance in plain.items():
        pairs = list(combinations(texts[:FEW], 2))
        taken = seconds(lambda distance=distance, pairs=pairs: [distance(*pair) for pair in pairs]) / few * every
        rows.append((f"paper's metric in Python: {name}", "names", taken))
    for metric in ("levenshtein", "hamming", "levenshtein-classes", "levenshtein-effects", "goal", "links", "states"):
        rows.append((f"prag_asp, {metric}", "renaming", ours(space, tasks, metric)))
    rows.append(("prag_asp, combined", "renaming", ours(space, tasks, "combined")))
    table = Table("way", "up to", f"s for {every:,} pairs", "times prag_asp, levenshtein")
    base = next(taken for name, _, taken in rows if name == "prag_asp, levenshtein")
    for name, up_to, taken in rows:
        table.add_row(name, up_to, f"{taken:,.1f}", f"{taken / base:,.1f}")
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
