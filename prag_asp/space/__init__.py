"""Counts, enumeration and samples of task spaces."""

from __future__ import annotations

from collections.abc import Mapping

ENGINES: Mapping[str, str] = {
    "automaton": "prag_asp.space.engines.automaton_engine.AutomatonEngine",
    "clingo": "prag_asp.space.engines.clingo_engine.ClingoEngine",
    "sat": "prag_asp.space.engines.sat_engine.SatEngine",
    "sharp": "prag_asp.space.engines.sharp_engine.SharpEngine",
    "symbolic": "prag_asp.space.engines.symbolic_engine.symbolic_engine",
}
"""The class of each engine, or a function that returns it; see `prag_asp.space.engines.engine.Engine`.

They are loaded lazily, so that listing the names loads no engine.
"""
