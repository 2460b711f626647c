"""Ranges of tasks and parts of a split: lazy, disjoint, and right at any size."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.space.parts.ranked_tasks import RankRange
from prag_asp.space.parts.shuffle import Shuffle
from tests.chance import Chance


@pytest.fixture(scope="module")
def space() -> TaskSpace:
    return TaskSpace(load_domain("prag"), 3)


@pytest.fixture(scope="module")
def texts(space: TaskSpace) -> list[str]:
    return [str(task) for task in space]


@given(st.slices(2092), st.slices(100))
def test_an_interval_is_cut_as_a_list_is(first: slice, second: slice) -> None:
    numbers = list(range(2092))
    interval = RankRange(range(2092)).cut(range(*first.indices(2092)))
    assert [interval[place] for place in range(interval.size)] == numbers[first]
    twice = interval.cut(range(*second.indices(interval.size)))
    assert [twice[place] for place in range(twice.size)] == numbers[first][second]
    assert all(twice.place(number) == place for place, number in enumerate(numbers[first][second]))


@pytest.mark.parametrize("places", [slice(5, 9), slice(-3, None), slice(None, None, 700), slice(9, 5), slice(3, 0, -1)])
def test_a_range_of_tasks_is_that_of_their_list(space: TaskSpace, texts: list[str], places: slice) -> None:
    assert [str(task) for task in space[places]] == texts[places]
    assert space[places].count() == len(texts[places])


@given(st.integers(1, 300), st.integers(0, 3))
def test_a_shuffle_is_a_permutation_and_can_be_undone(size: int, seed: int) -> None:
    order = Shuffle(size, seed)
    numbers = [order[place] for place in range(size)]
    assert sorted(numbers) == list(range(size))
    assert [order.place(number) for number in numbers] == list(range(size))


@given(st.integers(0, 10**120 - 1))
def test_a_shuffle_of_any_size_can_be_undone(place: int) -> None:
    order = Shuffle(10**120, 7)
    assert order.place(order[place]) == place


def test_a_shuffle_looks_random(chance: Chance) -> None:
    """The mean of a uniform order's first places is within five standard errors of the middle."""
    size, taken = 10_000, 1000
    mean = sum(Shuffle(size, chance.seed(3))[place] for place in range(taken)) / taken
    assert abs(mean - size / 2) < 5 * size / (12 * taken) ** 0.5


def test_parts_have_their_shares_and_no_task_in_common(space: TaskSpace, texts: list[str], chance: Chance) -> None:
    parts = space.split({"train": 0.7, "check": "1/10", "test": 0.2}, seed=chance.seed(5))
    assert [part.count() for part in parts.values()] == [1464, 210, 418]
    found = {name: [str(task) for task in part] for name, part in parts.items()}
    assert sorted(text for part in found.values() for text in part) == sorted(texts)
    assert found["train"] != sorted(found["train"])
    again = space.split({"train": 0.7, "check": "1/10", "test": 0.2}, seed=chance.seed(6))
    assert [str(task) for task in again["test"]] != found["test"]


def test_a_part_is_indexed_sliced_tested_and_drawn(space: TaskSpace, chance: Chance) -> None:
    parts = space.split({"train": 0.8, "test": 0.2}, seed=chance.seed(1))
    test = parts["test"]
    task = test[17]
    assert test.index(task) == 17 and task in test and task not in parts["train"]
    assert [str(each) for each in test[10:20]][7] == str(task)
    assert all(each in test for each in test.sample(20, seed=chance.seed(2)))
    assert len({str(each) for each in test.sample(test.count(), seed=chance.seed(2), distinct=True)}) == test.count()
    with pytest.raises(QueryError, match="not one of these"):
        parts["train"].index(task)
    with pytest.raises(QueryError, match="cannot sample"):
        test.sample(test.count() + 1, seed=chance.seed(2), distinct=True)
    with pytest.raises(IndexError):
        test[test.count()]


def test_a_split_works_where_no_list_would_fit() -> None:
    big = TaskSpace(load_domain("prag"), 150)
    assert big.count() > 10**100
    parts = big.split({"train": 0.8, "test": 0.2})
    assert sum(part.count() for part in parts.values()) == big.count()
    task = parts["test"][10**90]
    assert parts["test"].index(task) == 10**90
    assert task not in parts["train"]


def test_a_split_of_skeletons_shares_none(space: TaskSpace, chance: Chance) -> None:
    parts = space.split_skeletons({"train": 0.8, "test": 0.2}, seed=chance.seed(3))
    skeletons = [set(part.enumerate("skeleton")) for part in parts.values()]
    assert not skeletons[0] & skeletons[1]
    assert sum(map(len, skeletons)) == space.count("skeleton")
    assert sum(part.count() for part in parts.values()) == space.count()
    long = space.at(12).split_skeletons({"train": 0.8, "test": 0.2}, seed=chance.seed(3))
    share = long["test"].count("skeleton") / space.at(12).count("skeleton")
    assert 0.15 < share < 0.25


@pytest.mark.parametrize("what", ["can_1", "apple", "grasp", "grasp>move", "rotate(panda, can_1, straight)"])
def test_what_is_held_out_is_in_the_second_part_only(space: TaskSpace, what: str) -> None:
    train, test = space.hold_out(what)
    assert train.count("plan") + test.count("plan") == space.count("plan")
    assert train.count("plan") and test.count("plan")
    assert not set(train.enumerate("plan")) & set(test.enumerate("plan"))


@pytest.mark.parametrize("what", ["apple_1", "grasp(panda,apple_1)"])
def test_an_entity_that_another_replaces_cannot_be_held_out(space: TaskSpace, what: str) -> None:
    with pytest.raises(QueryError, match="interchangeable with apple_2"):
        space.hold_out(what)


@pytest.mark.parametrize("shares", [{"train": 0.8}, {"a": 1.5, "b": -0.5}, {"a": "much"}, {}, {"a": "1e999999999"}])
def test_shares_that_do_not_add_up_are_refused(space: TaskSpace, shares: dict[str, float | str]) -> None:
    with pytest.raises(QueryError, match=r"^shares? "):
        space.split(shares)
