"""Domains made from text, without the checks that would refuse the oddities that tests want."""

from __future__ import annotations

from pathlib import Path

from prag_asp.domain.load import Domain
from prag_asp.program.facts import read_facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.paths import data_folder
from prag_asp.program.settings import Settings
from prag_asp.program.sources import Program, Source, asked_sources, core_sources, read_sources

ENCODINGS = data_folder("encodings")
CORE = core_sources(ENCODINGS)


def domain_of(text: str, *rules: str) -> Domain:
    """Return the domain of a text, with rules by their names."""
    added = tuple(s for rule in rules for s in read_sources(ENCODINGS / "rules" / f"{rule}.lp", ENCODINGS))
    own = Source(Path("domain.lp"), text)
    program = Program((*CORE, *asked_sources([own], ENCODINGS), own, *added))
    grounder = Grounder(program)
    grounder.ground([("base", [])])
    return Domain("toy", Path(), ENCODINGS, program, read_facts(grounder.control), Settings(Path("domain.toml")))
