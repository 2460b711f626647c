"""Audits of benchmarks: distinct tasks, overlaps between suites, combinations that occur, and mistakes.

>>> from prag_asp.audit import audit
>>> audit("libero_90", "libero_goal").total.goals                     # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.audit.auditing import (
        BenchmarkAudit,
        Combinations,
        NearestProblem,
        SuiteCounts,
        SuiteOverlap,
        audit_problems,
    )
    from prag_asp.audit.canonical_facts import canonical_form
    from prag_asp.audit.problem_checks import AuditFinding
    from prag_asp.audit.reading import audit

__all__ = [
    "AuditFinding", "BenchmarkAudit", "Combinations", "NearestProblem", "SuiteCounts", "SuiteOverlap", "audit",
    "audit_problems", "canonical_form",
]  # fmt: skip

_HOMES = {
    "prag_asp.audit.auditing": (
        "BenchmarkAudit", "Combinations", "NearestProblem", "SuiteCounts", "SuiteOverlap", "audit_problems",
    ),
    "prag_asp.audit.canonical_facts": ("canonical_form",),
    "prag_asp.audit.problem_checks": ("AuditFinding",),
    "prag_asp.audit.reading": ("audit",),
}  # fmt: skip

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
