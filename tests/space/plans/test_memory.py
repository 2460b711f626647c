"""What is remembered of states that tasks have passed is forgotten in time."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from random import Random

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.logic.step import plan_states
from tests.chance import Chance

BITS, LENGTH, PLANS = 20, 50, 1400

LAMPS = f"""
class(lamp).  entity(lamp(1..{BITS}), lamp).
fluent(on(L)) :- is_a(L,lamp).
initially(F, false) :- fluent(F).
action(set(L,on)) :- is_a(L,lamp).    postcondition(set(L,on), on(L), true) :- is_a(L,lamp).
action(set(L,off)) :- is_a(L,lamp).   postcondition(set(L,off), on(L), false) :- is_a(L,lamp).
"""


def plans(count: int, random: Random) -> Iterator[tuple[str, ...]]:
    """Yield random plans, which pass states that hardly any other one does."""
    for _ in range(count):
        lit: set[int] = set()
        plan = []
        for lamp in random.choices(range(1, BITS + 1), k=LENGTH):
            plan.append(f"set(lamp({lamp}),{'off' if lamp in lit else 'on'})")
            lit ^= {lamp}
        yield tuple(plan)


def test_states_that_are_remembered_are_few_however_many_tasks_are_told(chance: Chance) -> None:
    space = TaskSpace(load_domain(text=LAMPS), LENGTH)
    passed, remembered = set(), []
    for task in space.tasks_of_plans(plans(PLANS, chance.generator(5))):
        passed |= {hash(state) for state in task.states}
        remembered.append(len(space.engines.task_builder._states))
    assert len(passed) > 52_000
    assert max(remembered) < 50_000


def test_tasks_that_are_told_by_turns_are_those_told_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    spaces = TaskSpace(load_domain("prag"), (2, 3))
    words = {length: [*islice(spaces.at(length).enumerate(), 40)] for length in spaces.lengths}
    alone = {length: [*spaces.at(length).tasks_of_plans(iter(words[length]))] for length in spaces.lengths}
    monkeypatch.setattr(plan_states, "ENTRIES", 3)
    by_turns = zip(*(spaces.at(length).tasks_of_plans(iter(words[length])) for length in spaces.lengths), strict=True)
    assert [*by_turns] == [*zip(*alone.values(), strict=True)]


def test_plans_of_several_lengths_are_told_as_they_come(chance: Chance, monkeypatch: pytest.MonkeyPatch) -> None:
    spaces = TaskSpace(load_domain("prag"), (0, 1, 2, 3))
    words = [word for length in spaces.lengths for word in islice(spaces.at(length).enumerate(), 30)]
    chance.generator(3).shuffle(words)
    alone = [task for word in words for task in spaces.at(len(word)).tasks_of_plans(iter([word]))]
    assert [*spaces.at(0).tasks_of_plans(iter(words))] == alone
    monkeypatch.setattr(plan_states, "ENTRIES", 3)
    assert [*TaskSpace(load_domain("prag"), 2).tasks_of_plans(iter(words))] == alone
