"""Combinations of the factors of actions: which ones can be reached, and small sets of tasks that cover them.

>>> from prag_asp import TaskSpace, load_domain
>>> from prag_asp.analysis.covering import covering_set
>>> found = covering_set(TaskSpace(load_domain("blocks"), length=4), strength=2)
>>> len(found.reachable), len(found.tasks), found.at_least
(7, 1, 1)
"""

from __future__ import annotations

from prag_asp.analysis.covering.combinations import (
    Combination,
    Coverage,
    combination_text,
    combinations_of,
    coverage,
    reachable_combinations,
)
from prag_asp.analysis.covering.covering_set import CoveringSet, covering_set
from prag_asp.analysis.covering.held_out import HeldOut, held_out, hold_out_combinations

__all__ = [
    "Combination",
    "Coverage",
    "CoveringSet",
    "HeldOut",
    "combination_text",
    "combinations_of",
    "coverage",
    "covering_set",
    "held_out",
    "hold_out_combinations",
    "reachable_combinations",
]
