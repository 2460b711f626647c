"""Count, sample and list the answer sets of any logic program exactly."""

from __future__ import annotations

ENGINES = ("auto", "ganak", "d4", "diagram", "clingo")
"""Automatic choice; two #SAT counters, which only count; a compiled diagram; and enumeration by clingo."""
