"""Domains of any number of cubes, and their reductions."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from prag_asp import load_domain
from prag_asp.domain.load import Domain
from prag_asp.program.sources import Program, Source, core_sources
from prag_asp.reduction.reduction import Reduction, find_reduction
from tests.domains import ENCODINGS

NO_SETTINGS = Source(Path("domain.toml"), "")

STACKS = """class(cube). class(table). entity(table_1, table).
fluent(on(C,D)) :- is_a(C,cube), is_a(D,cube), C != D. fluent(held(C)) :- is_a(C,cube).
fluent(on(C,T)) :- is_a(C,cube), is_a(T,table).
exclusive(on(C,D), on(C,E)) :- fluent(on(C,D)), fluent(on(C,E)), D < E.
exclusive(held(C), held(D)) :- fluent(held(C)), fluent(held(D)), C < D.
action(take(C)) :- is_a(C,cube). action(put(C,D)) :- fluent(on(C,D)).
precondition(take(C), on(D,C), false) :- action(take(C)), fluent(on(D,C)).
precondition(take(C), held(D), false) :- action(take(C)), fluent(held(D)).
postcondition(take(C), held(C), true) :- action(take(C)).
postcondition(take(C), on(C,D), false) :- action(take(C)), fluent(on(C,D)).
precondition(put(C,D), held(C), true) :- action(put(C,D)).
precondition(put(C,D), on(E,D), false) :- action(put(C,D)), fluent(on(E,D)), is_a(D,cube).
postcondition(put(C,D), on(C,D), true) :- action(put(C,D)).
postcondition(put(C,D), held(C), false) :- action(put(C,D)).
"""
"""Cubes that are taken and put onto one another; where they begin is open."""


@cache
def cubes(number: int, more: str = "") -> Domain:
    """Return the domain of stacks with a number of cubes."""
    return load_domain(text=f"entity(({'; '.join(f'c{n}' for n in range(number))}), cube).\n{STACKS}{more}")


def reduction_of(text: str, fewest: int = 2) -> Reduction | str | None:
    """Return the reduction of a text with groups of at least `fewest` entities."""
    program = Program((*core_sources(ENCODINGS), Source(Path("toy.lp"), text)))
    return find_reduction(program, NO_SETTINGS, fewest=fewest)
