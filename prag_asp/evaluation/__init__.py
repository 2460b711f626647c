"""Evaluate policies on scenarios, and compare their results.

>>> from prag_asp import TaskSpace, load_domain
>>> from prag_asp.evaluation import FreshScenarios, evaluate
>>> space = TaskSpace(load_domain("tabletop"), length=1)
>>> results = evaluate("zeros", FreshScenarios(space, count=2), steps=5)
>>> results.whole().trials
2

Importing a name other than `ComparisonDesign` raises `LearningMissingError` if Gymnasium is not installed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from prag_asp.lazy import names_from
from prag_asp.missing import require_gymnasium

if TYPE_CHECKING:
    from prag_asp.evaluation.comparison import PolicyComparison, compare
    from prag_asp.evaluation.episode import EvaluatedEpisode, SubgoalResult
    from prag_asp.evaluation.evaluating import evaluate
    from prag_asp.evaluation.paired import Pairs
    from prag_asp.evaluation.policies import load_policy
    from prag_asp.evaluation.power import ComparisonDesign
    from prag_asp.evaluation.results import EvaluationRecord, Results
    from prag_asp.evaluation.sources import FreshScenarios, NamedScenarios, StoredScenarios

__all__ = [
    "ComparisonDesign",
    "EvaluatedEpisode",
    "EvaluationRecord",
    "FreshScenarios",
    "NamedScenarios",
    "Pairs",
    "PolicyComparison",
    "Results",
    "StoredScenarios",
    "SubgoalResult",
    "compare",
    "evaluate",
    "load_policy",
]

_HOMES = {
    "prag_asp.evaluation.comparison": ("PolicyComparison", "compare"),
    "prag_asp.evaluation.episode": ("EvaluatedEpisode", "SubgoalResult"),
    "prag_asp.evaluation.evaluating": ("evaluate",),
    "prag_asp.evaluation.paired": ("Pairs",),
    "prag_asp.evaluation.policies": ("load_policy",),
    "prag_asp.evaluation.power": ("ComparisonDesign",),
    "prag_asp.evaluation.results": ("EvaluationRecord", "Results"),
    "prag_asp.evaluation.sources": ("FreshScenarios", "NamedScenarios", "StoredScenarios"),
}

_imported = names_from(__name__, _HOMES)


def __getattr__(name: str) -> Any:
    if name in __all__ and name != "ComparisonDesign":
        require_gymnasium()
    return _imported(name)


def __dir__() -> list[str]:
    return __all__
