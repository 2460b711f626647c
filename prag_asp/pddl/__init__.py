"""PDDL import: a domain and a problem become the logic program of a domain.

>>> from prag_asp import TaskSpace, load_domain
>>> space = TaskSpace(load_domain("domain.pddl", "problem.pddl"), length=4)  # doctest: +SKIP
>>> print(read("domain.pddl", "problem.pddl").text)                          # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.pddl.task_reader import Imported, read

__all__ = ["Imported", "read"]

_HOMES = {"prag_asp.pddl.task_reader": ("Imported", "read")}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
