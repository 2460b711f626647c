"""prag_asp: robot manipulation tasks from logic programs, counted and sampled exactly, and checked by physics.

    domains/<name>/  ->  Domain  ->  GroundStep  ->  TaskSpace  ->  Task  ->  Verdict
    (.lp + .toml)        parsed,     clingo          count,         value     PyBullet:
                         linted      grounds         draw, iterate            witness

    >>> from prag_asp import TaskSpace, load_domain
    >>> TaskSpace(load_domain("prag"), length=15).count(by="skeleton", prefix=["approach"])
    191264896

The names below are loaded on first use, so that the command starts fast.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    __version__: str

    from prag_asp.atom import Atom, parse_atom
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.domain.load import Domain, load_domain, load_scene
    from prag_asp.domain.scaffold import write_new_domain
    from prag_asp.errors import (
        DomainError,
        EngineError,
        LimitReached,
        OutputError,
        PragError,
        QueryError,
        SceneError,
    )
    from prag_asp.logic.formula.approximate import Estimate
    from prag_asp.logic.formula.explanation import Explanation
    from prag_asp.models.answer_sets import AnswerSets, answer_sets
    from prag_asp.processes.bounded_call import bounded
    from prag_asp.processes.notebook_progress import show_progress
    from prag_asp.program.paths import shipped_domains
    from prag_asp.scene.scene import Scene
    from prag_asp.space.conditions.condition import Condition
    from prag_asp.space.emptiness import Reasons, fewest_changes, why_empty
    from prag_asp.space.explanation import explain
    from prag_asp.space.limits import Limits
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

__all__ = [
    "AnswerSets",
    "Atom",
    "Condition",
    "Dataset",
    "Domain",
    "DomainError",
    "EngineError",
    "Estimate",
    "Explanation",
    "LimitReached",
    "Limits",
    "OutputError",
    "PragError",
    "QueryError",
    "Reasons",
    "Scene",
    "SceneError",
    "Task",
    "TaskSpace",
    "__version__",
    "answer_sets",
    "bounded",
    "explain",
    "fewest_changes",
    "load_domain",
    "load_scene",
    "parse_atom",
    "shipped_domains",
    "show_progress",
    "why_empty",
    "write_new_domain",
]

_HOMES = {
    "prag_asp.atom": ("Atom", "parse_atom"),
    "prag_asp.dataset.store.dataset": ("Dataset",),
    "prag_asp.models.answer_sets": ("AnswerSets", "answer_sets"),
    "prag_asp.processes.bounded_call": ("bounded",),
    "prag_asp.processes.notebook_progress": ("show_progress",),
    "prag_asp.domain.load": ("Domain", "load_domain", "load_scene"),
    "prag_asp.domain.scaffold": ("write_new_domain",),
    "prag_asp.errors": (
        "DomainError", "EngineError", "LimitReached", "OutputError", "PragError", "QueryError", "SceneError",
    ),
    "prag_asp.logic.formula.approximate": ("Estimate",),
    "prag_asp.logic.formula.explanation": ("Explanation",),
    "prag_asp.program.paths": ("shipped_domains",),
    "prag_asp.scene.scene": ("Scene",),
    "prag_asp.space.conditions.condition": ("Condition",),
    "prag_asp.space.explanation": ("explain",),
    "prag_asp.space.emptiness": ("Reasons", "fewest_changes", "why_empty"),
    "prag_asp.space.limits": ("Limits",),
    "prag_asp.task": ("Task",),
    "prag_asp.space.task_space": ("TaskSpace",),
    "prag_asp.versions": ("__version__",),
}  # fmt: skip

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__


if "ipykernel" in sys.modules:  # the kernel of a notebook
    from prag_asp.processes.notebook_progress import watch_notebook

    watch_notebook()
