"""Count, sample and list the answer sets of any logic program exactly."""

from __future__ import annotations

ENGINES = ("auto", "ganak", "diagram", "clingo")
"""Automatic choice; a #SAT counter, which only counts; a compiled diagram; and enumeration by clingo."""
