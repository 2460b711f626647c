"""Task spaces: counted, enumerated, drawn."""

from __future__ import annotations

from collections.abc import Mapping

ENGINES: Mapping[str, str] = {
    "automaton": "prag_asp.space.engines.automaton_engine.AutomatonEngine",
    "clingo": "prag_asp.space.engines.clingo_engine.ClingoEngine",
    "sat": "prag_asp.space.engines.sat_engine.SatEngine",
    "sharp": "prag_asp.space.engines.sharp_engine.SharpEngine",
    "symbolic": "prag_asp.space.engines.symbolic_engine.SymbolicEngine",
}
"""Every engine by its name: the class that answers as `prag_asp.space.engines.engine.Engine` says.

It is loaded when it is first asked for, so that naming engines costs nothing.
"""
