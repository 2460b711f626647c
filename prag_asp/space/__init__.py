"""Task spaces: counted, enumerated, drawn."""

from __future__ import annotations

from collections.abc import Mapping

ENGINES: Mapping[str, str] = {
    "automaton": "prag_asp.space.engines.automaton.AutomatonEngine",
    "clingo": "prag_asp.space.engines.clingo.ClingoEngine",
    "sat": "prag_asp.space.engines.sat.SatEngine",
    "sharp": "prag_asp.space.engines.sharp.SharpEngine",
    "symbolic": "prag_asp.space.engines.symbolic.SymbolicEngine",
}
"""Every engine by its name: the class that answers as `prag_asp.space.engines.protocol.Engine` says.

It is loaded when it is first asked for, so that naming engines costs nothing.
"""
