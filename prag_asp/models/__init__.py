"""The answer sets of any logic program: counted, drawn and listed exactly."""

from __future__ import annotations

ENGINES = ("auto", "ganak", "diagram", "clingo")
"""What fits; a #SAT counter, which counts alone; a compiled diagram; and clingo's enumeration."""
