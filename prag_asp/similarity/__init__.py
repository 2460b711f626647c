"""Metrics between two tasks, up to renaming of interchangeable entities.

    Task, Task  ->  features  ->  measure, least over renamings  ->  TaskComparison
                    (actions, effects, changes,  (edits, positions,  distance, edits,
                     states, causal links)        sets, strings)     renaming

>>> from prag_asp import TaskSpace, load_domain
>>> space = TaskSpace(load_domain("prag"), 5)
>>> float(space[17].distance(space[23], "levenshtein", within=space))
2.0
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.similarity.background import Background
    from prag_asp.similarity.cost_file import read_costs
    from prag_asp.similarity.edits import Edit
    from prag_asp.similarity.interchange import Interchange
    from prag_asp.similarity.metrics import METRICS, Metric
    from prag_asp.similarity.own_costs import metric_with_costs
    from prag_asp.similarity.task_comparison import TaskComparison, compare

__all__ = [
    "METRICS",
    "Background",
    "Edit",
    "Interchange",
    "Metric",
    "TaskComparison",
    "compare",
    "metric_with_costs",
    "read_costs",
]

_HOMES = {
    "prag_asp.similarity.background": ("Background",),
    "prag_asp.similarity.task_comparison": ("TaskComparison", "compare"),
    "prag_asp.similarity.cost_file": ("read_costs",),
    "prag_asp.similarity.edits": ("Edit",),
    "prag_asp.similarity.interchange": ("Interchange",),
    "prag_asp.similarity.metrics": ("METRICS", "Metric"),
    "prag_asp.similarity.own_costs": ("metric_with_costs",),
}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
