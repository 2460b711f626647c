"""Ground a text as a domain's own file, after the step of number 5 where it has one."""

from __future__ import annotations

from pathlib import Path

import clingo

from prag_asp.program.grounding import Grounder
from prag_asp.program.sources import Program, Source

CONTRACT = Source(Path("encodings/contract.lp"), "")


def ground(text: str) -> list[str]:
    """Return the atoms of a text, sorted."""
    grounder = Grounder(Program((CONTRACT, Source(Path("domain.lp"), text))))
    grounder.ground([("base", [])])
    grounder.ground([("step", [clingo.Number(5)])])
    return sorted(str(atom.symbol) for atom in grounder.control.symbolic_atoms)


def ground_by_clingo_alone(text: str) -> list[str]:
    """Return the atoms of a text as clingo itself makes them, sorted."""
    control = clingo.Control(["--warn=none"])
    control.add("base", [], text)
    control.ground([("base", []), ("step", [clingo.Number(5)])])
    return sorted(str(atom.symbol) for atom in control.symbolic_atoms)
