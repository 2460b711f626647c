"""prag_asp: robot manipulation tasks from logic programs, counted and drawn exactly and checked by physics.

    domains/<name>/  ->  Domain  ->  GroundStep  ->  TaskSpace  ->  Task  ->  Verdict
    (.lp + .toml)        parsed,     clingo          count,         value     PyBullet:
                         linted      grounds         draw, iterate            witness

    >>> from prag_asp import TaskSpace, load_domain
    >>> TaskSpace(load_domain("prag"), length=15).count(by="skeleton", prefix=["approach"])
    191264896
"""

from __future__ import annotations

from prag_asp.domain.atom import Atom, parse_atom
from prag_asp.domain.load import Domain, load_domain
from prag_asp.errors import DomainError, EngineError, OutputError, PragError, QueryError, SceneError
from prag_asp.space.task import Task
from prag_asp.space.task_space import TaskSpace

__all__ = [
    "Atom",
    "Domain",
    "DomainError",
    "EngineError",
    "OutputError",
    "PragError",
    "QueryError",
    "SceneError",
    "Task",
    "TaskSpace",
    "load_domain",
    "parse_atom",
]
