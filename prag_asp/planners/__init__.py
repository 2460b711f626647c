"""The export of a domain or a task as two PDDL files for other planners.

>>> from prag_asp import load_domain
>>> export = write(load_domain("blocks"))
>>> export.problem.splitlines()[0]
'(define (problem blocks-task)'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.planners.pddl_writer import PddlExport, write

__all__ = ["PddlExport", "write"]

_HOMES = {"prag_asp.planners.pddl_writer": ("PddlExport", "write")}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
