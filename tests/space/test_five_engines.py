"""The five engines agree with the definition and with each other, under every kind of condition, at every level.

`pytest --fresh tests/space/test_five_engines.py` draws 1,000 closed domains anew.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import pytest

from prag_asp import EngineError, TaskSpace, load_domain
from prag_asp.logic.formula.counter import has_counter
from prag_asp.program.paths import shipped_domains
from prag_asp.space.engines import ENGINES, LEVELS
from tests.chance import Chance
from tests.domains import domain_of
from tests.ganak import counting_by, one_process
from tests.orbits.case import Case
from tests.orbits.conditions import KINDS, head
from tests.orbits.domains import draw_closed
from tests.spaces import with_engine

BY_STATES = ("automaton", "symbolic")
"""The engines that go from state to state, and that no condition suits which looks at all of them at once."""

DOMAINS, FRESH_DOMAINS, PARTS = 15, 1000, 5
"""How many domains are drawn, one for each kind of condition; and how many with `pytest --fresh`."""

LENGTHS, LONGER, LONGER_EACH = (0, 1, 2), (0, 1, 2, 3), 20

FEW = 150
"""Plans up to which every engine finds them all of a shipped domain."""

Words = list[tuple[str, ...]]


@pytest.fixture(scope="module")
def engines() -> Iterator[tuple[str, ...]]:
    """Give the names of the engines; those that count models share one process for it."""
    names = ("automaton", "symbolic", "clingo", "sat")
    assert {*names, "sharp"} == {*ENGINES}
    if not has_counter():
        yield names
        return
    with one_process() as count_models, counting_by(count_models):
        yield (*names, "sharp")


def agreed(spaces: dict[str, TaskSpace], length: int, by: Any, found: str) -> Words:
    """Return the words of a level, once all engines have told the same, in the same order."""
    told: dict[str, Words] = {}
    for engine, space in spaces.items():
        here = space.at(length)
        told[engine] = list(here.enumerate(by)) if engine != "sharp" else told["sat"]
        assert here.count(by) == len(told[engine]), (engine, by, length, found)
        assert told[engine] == told["clingo"], (engine, by, length, found)
    return told["clingo"]


def answering(space: TaskSpace, engines: Sequence[str]) -> dict[str, TaskSpace]:
    """Return a space with each engine, clingo first, but those that refuse it; that they do so is tested."""
    refusing = BY_STATES if "loop-free" in str(space.condition) else ()
    for engine in refusing:
        with pytest.raises(EngineError, match=r"loop_free\.lp:"):
            with_engine(space, engine).count()
    return {each: with_engine(space, each) for each in ("clingo", *engines) if each not in refusing}


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_five_engines_agree_with_the_definition_on_random_closed_domains(
    part: int, chance: Chance, engines: tuple[str, ...]
) -> None:
    number = (DOMAINS if chance.base is None else FRESH_DOMAINS) // PARTS
    for seed in range(part * number, (part + 1) * number):
        case = draw_closed(chance.generator(seed), KINDS[seed % len(KINDS)])
        space = TaskSpace(domain_of(case.text()), 0).where(*(clause.words for clause in case.clauses))
        spaces = answering(space, engines)
        for length in LENGTHS if seed % LONGER_EACH else LONGER:
            check(case, spaces, length, f"seed {seed}, {space.condition!s}: {case.text()}")


def check(case: Case, spaces: dict[str, TaskSpace], length: int, found: str) -> None:
    plans = case.plans(length)
    assert {*agreed(spaces, length, "plan", found)} == plans, (length, found)
    tasks = agreed(spaces, length, "task", found)
    orbits = case.orbits(plans)
    assert len(tasks) == len(orbits), (length, found)
    assert case.orbits(tasks) == orbits, (length, found)
    skeletons = {tuple(map(head, plan)) for plan in plans}
    assert agreed(spaces, length, "skeleton", found) == sorted(skeletons), (length, found)


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped_domains())
def test_five_engines_agree_on_shipped_domains_under_conditions(
    name: str, chance: Chance, engines: tuple[str, ...]
) -> None:
    whole = TaskSpace(load_domain(name), 2)
    space = next(each for each in (whole, whole.at(1)) if each.count("plan") <= FEW or each.length == 1)
    facts = whole.domain.facts
    entities = {**facts.entity_names}
    place = [*shipped_domains()].index(name)
    everything = chance.base is not None
    for number, kind in enumerate(KINDS) if everything else [(place, KINDS[place])]:
        drawn = kind(chance.generator(number), tuple(map(str, facts.actions)), tuple(map(str, facts.fluents)), entities)
        asked = space.where(drawn.words)
        for by in LEVELS if everything else [LEVELS[place % len(LEVELS)]]:
            agreed(answering(asked, engines), space.length, by, f"{name}: {drawn.words}")
