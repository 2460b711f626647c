"""Spaces of random domains with the orbits of their plans, by brute force."""

from __future__ import annotations

from collections.abc import Iterator

from prag_asp import TaskSpace
from tests.chance import Chance
from tests.domains import domain_of
from tests.orbits.case import Case, Plan
from tests.orbits.domains import draw_case
from tests.orbits.units import draw_units

Orbits = list[frozenset[Plan]]

FRESH = 300
"""Random domains that each test tries with fresh seeds."""

MOST = 120
"""Spaces with more plans are left out: brute force compares all pairs of them."""


def domains(chance: Chance, number: int) -> int:
    """Return how many random domains are tried where it is this many as a rule."""
    return number if chance.base is None else FRESH


def orbit_spaces(chance: Chance, number: int, length: int) -> Iterator[tuple[Case, TaskSpace, Orbits]]:
    """Yield this many random domains whose space of a length has tasks, with the space and its orbits."""
    seed = found = 0
    while found < domains(chance, number):
        draw = draw_units if seed % 4 == 3 else draw_case
        case = draw(chance.generator(seed))
        seed += 1
        plans = case.plans(length)
        space = TaskSpace(domain_of(case.text()), length).where(*(clause.words for clause in case.clauses))
        if 1 < len(plans) <= MOST and not space.engines.model.obstacles:
            found += 1
            yield case, space, list(case.orbits(plans))


def orbit_of(orbits: Orbits, plan: tuple[str, ...]) -> frozenset[Plan]:
    (orbit,) = (orbit for orbit in orbits if plan in orbit)
    return orbit
