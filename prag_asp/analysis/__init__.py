"""Plot counts by length, and compute exact distances, neighbours and diversity of whole task spaces.

>>> from prag_asp import TaskSpace, load_domain
>>> from prag_asp.analysis import counts_by_length
>>> [line.counts for line in counts_by_length(TaskSpace(load_domain("blocks"), length=2)).series][:2]
[(4, 16), (1, 2)]
>>> from prag_asp.analysis import hamming_distribution
>>> hamming_distribution(TaskSpace(load_domain("blocks"), length=2)).pairs
(2, 2, 0)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.analysis.all_pairs import PairDistances, pair_distances
    from prag_asp.analysis.complexity import Complexity, ComplexityMeasure, complexity_of
    from prag_asp.analysis.distance_matrix import (
        NearDuplicates,
        NearestNeighbours,
        SimilarityMatrix,
        near_duplicates,
        nearest_neighbours,
        similarity_matrix,
        without_duplicates,
    )
    from prag_asp.analysis.distant_tasks import tasks_apart
    from prag_asp.analysis.farthest_first import DiverseChoice, Novelty, diverse_choice, novelty
    from prag_asp.analysis.frequencies import Frequency, FrequencyTest, compare_frequencies
    from prag_asp.analysis.hamming import DistanceDistribution, hamming_distribution, mean_hamming
    from prag_asp.analysis.neighbours import NearestTask, count_neighbours, nearest_task
    from prag_asp.analysis.plots.curve import Curve, Series, counts_by_length, draw_curve
    from prag_asp.analysis.plots.dendrogram import Dendrogram, dendrogram_of
    from prag_asp.analysis.plots.task_scaling import TaskMap, task_map
    from prag_asp.analysis.vendi import VendiScore, vendi_score

__all__ = [
    "Complexity",
    "ComplexityMeasure",
    "Curve",
    "Dendrogram",
    "DistanceDistribution",
    "DiverseChoice",
    "Frequency",
    "FrequencyTest",
    "NearDuplicates",
    "NearestNeighbours",
    "NearestTask",
    "Novelty",
    "PairDistances",
    "Series",
    "SimilarityMatrix",
    "TaskMap",
    "VendiScore",
    "compare_frequencies",
    "complexity_of",
    "count_neighbours",
    "counts_by_length",
    "dendrogram_of",
    "diverse_choice",
    "draw_curve",
    "hamming_distribution",
    "mean_hamming",
    "near_duplicates",
    "nearest_neighbours",
    "nearest_task",
    "novelty",
    "pair_distances",
    "similarity_matrix",
    "task_map",
    "tasks_apart",
    "vendi_score",
    "without_duplicates",
]

_HOMES = {
    "prag_asp.analysis.complexity": ("Complexity", "ComplexityMeasure", "complexity_of"),
    "prag_asp.analysis.plots.curve": ("Curve", "Series", "counts_by_length", "draw_curve"),
    "prag_asp.analysis.frequencies": ("Frequency", "FrequencyTest", "compare_frequencies"),
    "prag_asp.analysis.hamming": ("DistanceDistribution", "hamming_distribution", "mean_hamming"),
    "prag_asp.analysis.neighbours": ("NearestTask", "count_neighbours", "nearest_task"),
    "prag_asp.analysis.distant_tasks": ("tasks_apart",),
    "prag_asp.analysis.farthest_first": ("DiverseChoice", "Novelty", "diverse_choice", "novelty"),
    "prag_asp.analysis.plots.dendrogram": ("Dendrogram", "dendrogram_of"),
    "prag_asp.analysis.all_pairs": ("PairDistances", "pair_distances"),
    "prag_asp.analysis.distance_matrix": (
        "NearDuplicates", "NearestNeighbours", "SimilarityMatrix", "near_duplicates", "nearest_neighbours",
        "similarity_matrix", "without_duplicates",
    ),
    "prag_asp.analysis.plots.task_scaling": ("TaskMap", "task_map"),
    "prag_asp.analysis.vendi": ("VendiScore", "vendi_score"),
}  # fmt: skip

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
