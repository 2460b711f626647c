"""Ranks and tasks are inverse to each other, at any size; distinct draws are distinct and uniform."""

from __future__ import annotations

from typing import get_args

import pytest

from prag_asp import QueryError, Task, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space.automaton import automaton
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.engine import Level
from tests.chance import Chance

DOMAIN = load_domain("prag")


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
def test_ranks_count_through_a_small_space_in_its_order(engine: str) -> None:
    space = TaskSpace(DOMAIN, 2, engine=engine)
    tasks = list(space)
    assert len(tasks) == space.count() == 265
    for rank in (0, 1, 99, 264):
        assert space[rank] == tasks[rank]
        assert space.index(tasks[rank]) == rank
    assert space[-1] == tasks[-1]


def test_ranks_and_tasks_are_inverse_in_a_space_above_any_machine_word(chance: Chance) -> None:
    space = TaskSpace(DOMAIN, 120)
    total = space.count()
    assert total > 10**100
    generator = chance.generator(0)
    for rank in (0, total - 1, *(generator.randrange(total) for _ in range(chance.examples(5)))):
        assert space.index(space[rank]) == rank


@pytest.mark.parametrize("name", ["prag", "blocks", "hanoi", "tabletop"])
@pytest.mark.parametrize("by", get_args(Level))
def test_ranks_and_words_are_inverse_over_whole_small_spaces(name: str, by: Level) -> None:
    length = 2
    engine = AutomatonEngine(DomainLogic(load_domain(name)), by)
    words = list(engine.words(length))
    assert [engine.unrank(length, rank) for rank in range(len(words))] == words
    assert [engine.rank(word) for word in words] == list(range(len(words)))
    assert sorted(words, key=lambda word: [engine.letters.index(letter) for letter in word]) == words


@pytest.mark.parametrize(("by", "length", "least"), [("skeleton", 1000, 628), ("plan", 1000, 910), ("task", 300, 100)])
def test_ranks_and_words_are_inverse_at_random_ranks_of_vast_spaces(
    by: Level, length: int, least: int, chance: Chance
) -> None:
    engine = AutomatonEngine(DomainLogic(DOMAIN), by)
    total = engine.count(length)
    assert total > 10**least
    generator = chance.generator(2)
    for rank in (0, total - 1, *(generator.randrange(total) for _ in range(chance.examples(20)))):
        word = engine.unrank(length, rank)
        assert len(word) == length and engine.contains(word) and engine.rank(word) == rank


def test_ranks_are_the_same_where_memory_holds_few_rows(monkeypatch: pytest.MonkeyPatch, chance: Chance) -> None:
    spaces = TaskSpace(DOMAIN, 60), TaskSpace(DOMAIN, 60, engine="automaton")
    rank = spaces[0].count() // 3
    task = spaces[0][rank]
    drawn = spaces[0].sampling().array(300, seed=chance.seed(1))
    monkeypatch.setattr(automaton, "KEPT_BYTES", 3000)
    completions = spaces[1].engines.engine("task", spaces[1].length).explored(60).completions  # type: ignore[attr-defined]
    assert spaces[1][rank] == task and spaces[1].index(task) == rank
    assert (spaces[1].sampling().array(300, seed=chance.seed(1)) == drawn).all()
    assert 1 < len(completions._kept) < 10


def test_a_task_with_other_names_has_the_same_rank() -> None:
    space = TaskSpace(DOMAIN, 3)
    one, other = (
        next(space.tasks_of_plans(iter([tuple(f"{name}(panda,{apple})" for name in ("approach", "grasp", "drop"))])))
        for apple in ("apple_1", "apple_2")
    )
    assert one != other and space.index(one) == space.index(other)


def test_what_is_no_task_has_no_rank() -> None:
    space = TaskSpace(DOMAIN, 2)
    task = space[0]
    for actions in ((), task.actions[:1], (task.actions[0],) * 2):
        wrong = Task("prag", actions, {}, {}, (), (), {})
        with pytest.raises(QueryError, match="no task of"):
            space.index(wrong)
    for rank in (265, -266):
        with pytest.raises(IndexError, match="of 265 tasks"):
            space[rank]


def test_distinct_draws_are_distinct_and_may_take_the_whole_space(chance: Chance) -> None:
    space = TaskSpace(DOMAIN, 1)
    tasks = space.sample(36, seed=chance.seed(4), weights={}, distinct=True)
    assert sorted(task.actions for task in tasks) == sorted(task.actions for task in space)
    assert tasks != list(space)
    with pytest.raises(QueryError, match="there are 36"):
        space.sample(37, seed=4, weights={}, distinct=True)
