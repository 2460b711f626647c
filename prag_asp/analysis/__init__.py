"""Plot the numbers of plans, tasks and skeletons of a space by length.

>>> from prag_asp import TaskSpace, load_domain
>>> from prag_asp.analysis import counts_by_length
>>> [line.counts for line in counts_by_length(TaskSpace(load_domain("blocks"), length=2)).series][:2]
[(4, 16), (1, 2)]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.analysis.curve import Curve, Series, counts_by_length, draw_curve

__all__ = ["Curve", "Series", "counts_by_length", "draw_curve"]

_HOMES = {"prag_asp.analysis.curve": ("Curve", "Series", "counts_by_length", "draw_curve")}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
