"""Exact counts, samples and lists of the answer sets of any logic program."""

from __future__ import annotations

ENGINES = ("auto", "ganak", "d4", "diagram", "clingo")
"""The engines: automatic choice; two #SAT counters, which can only count; a compiled diagram; and enumeration by
clingo."""
