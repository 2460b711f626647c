"""BDDL: problems of LIBERO, LIBERO-PRO and BEHAVIOR-1K.

>>> from prag_asp.bddl import parse_bddl
>>> problem = parse_bddl('''(define (problem tidy) (:domain robosuite) (:language put the cup on the plate)
...     (:objects cup_1 - cup plate_1 - plate) (:init) (:goal (and (on cup_1 plate_1))))''')
>>> problem.language, problem.objects
('put the cup on the plate', {'cup_1': 'cup', 'plate_1': 'plate'})
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.bddl.bddl_problem import BddlFact, BddlFormula, BddlProblem, Connective, Quantifier, Region
    from prag_asp.bddl.bddl_reader import parse_bddl, read_bddl
    from prag_asp.bddl.bddl_writing import bddl_text
    from prag_asp.bddl.domain_writer import SuiteDomain, read_suite
    from prag_asp.bddl.ground_problems import GroundProblem, ground_problem

__all__ = [
    "BddlFact", "BddlFormula", "BddlProblem", "Connective", "GroundProblem", "Quantifier", "Region",
    "SuiteDomain", "bddl_text", "ground_problem", "parse_bddl", "read_bddl", "read_suite",
]  # fmt: skip

_HOMES = {
    "prag_asp.bddl.bddl_problem": ("BddlFact", "BddlFormula", "BddlProblem", "Connective", "Quantifier", "Region"),
    "prag_asp.bddl.bddl_reader": ("parse_bddl", "read_bddl"),
    "prag_asp.bddl.bddl_writing": ("bddl_text",),
    "prag_asp.bddl.domain_writer": ("SuiteDomain", "read_suite"),
    "prag_asp.bddl.ground_problems": ("GroundProblem", "ground_problem"),
}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
