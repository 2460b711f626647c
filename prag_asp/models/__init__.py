"""The answer sets of any logic program: counted, sampled and listed exactly."""

from __future__ import annotations

ENGINES = ("auto", "ganak", "diagram", "clingo")
"""The fastest that fits; a #SAT counter, which only counts; a compiled diagram; and clingo's enumeration."""
