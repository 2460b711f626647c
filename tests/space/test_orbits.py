"""Tasks are the orbits of plans, taken by brute force: the one check of where engines agree because they share it."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator

import pytest

from prag_asp import TaskSpace
from prag_asp.space.engines import Engine, select
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from tests.chance import Chance
from tests.domains import domain_of
from tests.ganak import counting_by, one_process
from tests.orbits.case import Case
from tests.orbits.domains import draw_case, draw_redundant
from tests.orbits.units import draw_units

LENGTHS, LONGER = (0, 1, 2), (0, 1, 2, 3)
LONGER_EACH = 5
"""Plans of three actions are many, so one domain of so many has them."""

DOMAINS, WITH_UNITS, REDUNDANT, PARTS = 100, 30, 40, 10
"""How many domains are drawn, how many whose entities belong to each other, and how many that say much again; with
`pytest --fresh`, ten times as many."""

SHARP_EACH = 10
"""The counter counts one of so many."""


@pytest.fixture(scope="module")
def ganak() -> Iterator[None]:
    with one_process() as count_models, counting_by(count_models):
        yield


def engines_of(case: Case, sharp: bool) -> Iterator[tuple[str, TaskSpace, Engine]]:
    """Yield the space of a case, with every engine that can express it."""
    space = TaskSpace(domain_of(case.text()), 0).where(*(clause.words for clause in case.clauses))
    model = space.engines.model
    for name in ("clingo", "sat", *(["sharp"] if sharp else [])):
        yield name, space, select(name, model, "task")
    if not model.obstacles:
        yield "automaton", space, AutomatonEngine(model, "task", merge=False)
        yield "merged", space, AutomatonEngine(model, "task", merge=True)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_what_follows_anyway_tells_no_entities_apart(part: int, chance: Chance) -> None:
    """Engines share the groups of entities, so that one of them tells enough, the one that merges by them."""
    number = chance.examples(REDUNDANT) // PARTS
    for seed in range(part * number, (part + 1) * number):
        case = draw_redundant(chance.generator(seed))
        space = TaskSpace(domain_of(case.text()), 0).where(*(clause.words for clause in case.clauses))
        model = space.engines.model
        told = model.symmetries(0)
        engine = select("clingo", model, "task") if model.obstacles else AutomatonEngine(model, "task", merge=True)
        for length in LENGTHS:
            plans = case.plans(length)
            orbits = case.orbits(plans)
            found = f"seed {seed}, length {length}, {space.condition!s}, {told}: {case.text()}"
            assert engine.count(length) == len(orbits), found


@pytest.mark.slow
@pytest.mark.usefixtures("ganak")
@pytest.mark.parametrize("draw", [draw_case, draw_units])
@pytest.mark.parametrize("part", range(PARTS))
def test_tasks_are_the_orbits_of_plans_in_every_engine(
    part: int, draw: Callable[[random.Random], Case], chance: Chance
) -> None:
    number = chance.examples(DOMAINS if draw is draw_case else WITH_UNITS) // PARTS
    for seed in range(part * number, (part + 1) * number):
        case = draw(chance.generator(seed))
        lengths = LENGTHS if seed % LONGER_EACH else LONGER
        expected = {length: case.orbits(case.plans(length)) for length in lengths}
        for name, space, engine in engines_of(case, sharp=seed % SHARP_EACH == 0):
            for length, orbits in expected.items():
                found = f"seed {seed}, engine {name}, length {length}, {space.condition!s}: {case.text()}"
                assert engine.count(length) == len(orbits), found
                words = list(engine.words(length))
                assert len(words) == len(orbits), found
                assert case.orbits(words) == orbits, found
                if name == "automaton":
                    assert [engine.unrank(length, rank) for rank in range(len(words))] == words, found
                    orbit = max(orbits, key=len, default=frozenset())
                    assert len({space.at(length).index(plan) for plan in orbit}) == bool(orbit), found
