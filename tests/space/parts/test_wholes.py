"""Parts of a space have its tasks, each in one of them, whatever is interchangeable in a part alone."""

from __future__ import annotations

import pickle
import random
import warnings
from collections.abc import Callable, Iterator

import pytest

from prag_asp import QueryError, TaskSpace
from prag_asp.space.conditions.whole_skeletons import SharesWarning
from prag_asp.space.engines import ENGINES
from tests.chance import Chance
from tests.domains import domain_of
from tests.orbits.case import Case, Plan
from tests.orbits.conditions import head, named_in
from tests.orbits.domains import draw_case
from tests.orbits.units import draw_units

CUPS = """
class(cup). class(can). entity((cup_1;cup_2),cup). entity(can_1,can). fluent(clean(C)) :- entity(C,_).
action(wash(C)) :- entity(C,_). postcondition(wash(C),clean(C),true) :- entity(C,_).
"""

DOMAINS, LENGTH = 32, 2


@pytest.mark.parametrize("engine", [each for each in ENGINES if each != "sharp"])
def test_an_entity_that_only_a_part_does_not_tell_apart_is_apart_in_it(engine: str) -> None:
    """Where cup_2 is asked for and cup_1 held out, the two are alike in the part that has both, not in the whole."""
    space = TaskSpace(domain_of(CUPS), 3, engine=engine).where("uses cup_2")
    without, having = space.hold_out("cup_1")
    assert (space.count("plan"), without.count("plan"), having.count("plan")) == (19, 7, 12)
    assert space.count() == without.count() + having.count() == 19
    assert sorted([*without.enumerate(), *having.enumerate()]) == sorted(space.enumerate())
    assert space.where("uses cup_1").count() == 6
    assert {having.index(having[rank]) for rank in range(having.count())} == {*range(having.count())}
    sent = pickle.loads(pickle.dumps(having))
    assert list(sent.enumerate()) == list(having.enumerate())
    assert having.same_tasks(sent) and not having.same_tasks(space.where("uses cup_1"))
    assert [part.count() for part in having.hold_out("can_1")] == [6, 6]


def held_out(case: Case, chance: random.Random) -> Iterator[tuple[str, Callable[[Plan], bool]]]:
    """Yield something of each kind that may be held out, with what tells whether a plan has it."""
    entity, kind = chance.choice([*case.entities.items()])
    one, other = (head(chance.choice(case.actions)) for _ in range(2))
    members = {each for each, own in case.entities.items() if own == kind}
    yield entity, lambda plan: any(entity in named_in(action) for action in plan)
    yield kind, lambda plan: any(members & named_in(action) for action in plan)
    yield one, lambda plan: any(head(action) == one for action in plan)
    yield f"{one}>{other}", lambda plan: (one, other) in zip(map(head, plan), map(head, plan[1:]), strict=False)


@pytest.mark.slow
@pytest.mark.parametrize("draw", [draw_case, draw_units])
def test_parts_are_a_partition_of_the_orbits_of_plans_on_random_domains(
    draw: Callable[[random.Random], Case], chance: Chance
) -> None:
    for seed in range(chance.examples(DOMAINS) // 2):
        generator = chance.generator(seed)
        case = draw(generator)
        space = TaskSpace(domain_of(case.text()), LENGTH).where(*(clause.words for clause in case.clauses))
        orbits = case.orbits(case.plans(LENGTH))
        found = f"seed {seed}, {space.condition!s}: {case.text()}"
        for what, has in held_out(case, generator):
            try:
                parts = space.hold_out(what)
            except QueryError as refused:
                assert "is interchangeable with" in str(refused), found
                continue
            for part, wanted in zip(parts, (False, True), strict=True):
                own = {orbit for orbit in orbits if {*map(has, orbit)} == {wanted}}
                assert part.count() == len(own) and case.orbits(part.enumerate()) == own, (what, wanted, found)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SharesWarning)
            split = space.split_skeletons({"a": "1/2", "b": "1/2"}, seed=seed)
        words = [word for part in split.values() for word in part.enumerate()]
        assert len(words) == len(orbits) and case.orbits(words) == orbits, found
