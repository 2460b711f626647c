"""Strata divide a space exactly, and samples are allocated to them by largest remainders within their sizes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from fractions import Fraction
from itertools import count, product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import QueryError, Task, TaskSpace, load_domain
from prag_asp.space.strata.allocation import Stratification, StratifiedBy, allocate
from prag_asp.space.strata.stratum import strata_of
from tests.chance import examples

KEYS: dict[StratifiedBy, Callable[[Task], object]] = {
    "length": len,
    "skeleton": lambda task: task.skeleton,
    "goal": lambda task: (len(task), frozenset(task.states[-1].items()) if task.states else None),
}


@pytest.mark.parametrize("name, lengths", [("hanoi", "0..3"), ("two_arms", "1..3"), ("prag", "2")])
def test_strata_are_the_tasks_of_a_length_skeleton_or_goal_each_once(name: str, lengths: str) -> None:
    space = TaskSpace(load_domain(name), lengths)
    for by, key in KEYS.items():
        groups: defaultdict[object, set[tuple[str, ...]]] = defaultdict(set)
        for task in space:
            groups[key(task)].add(tuple(map(str, task.actions)))
        strata = strata_of(space, by, seed=3, most=space.count())
        sampled = [[draw.word for draw in stratum.order.pick(count())] for stratum in strata]
        assert [len(words) for words in sampled] == [stratum.size for stratum in strata]
        assert sorted(map(sorted, sampled)) == sorted(map(sorted, groups.values()))
        assert len({stratum.name for stratum in strata}) == len(strata)
        later = next(strata[-1].order.pick([strata[-1].size - 1]))
        assert later.word == sampled[-1][-1] and later.probability == Fraction(1, space.count())


def test_the_first_task_of_a_stratum_is_uniform() -> None:
    space = TaskSpace(load_domain("hanoi"), "3")
    for by in ("skeleton", "goal"):
        seen: defaultdict[str, set[tuple[str, ...]]] = defaultdict(set)
        for seed in range(60):
            for stratum in strata_of(space, by, seed=seed, most=10):
                seen[stratum.name].add(next(stratum.order.pick([0])).word)
        assert all(len(seen[each.name]) == each.size for each in strata_of(space, by, seed=0, most=10))


@settings(max_examples=examples(60))
@given(st.lists(st.integers(1, 12), min_size=1, max_size=4), st.data())
def test_an_allocation_is_the_nearest_to_its_quotas_among_all_within_the_bounds(
    sizes: list[int], data: st.DataObject
) -> None:
    fewest = [min(2, size) for size in sizes]
    total = data.draw(st.integers(sum(fewest), sum(sizes)))
    shares = [Fraction(data.draw(st.integers(1, 9))) for _ in sizes]
    numbers = allocate(sizes, total, shares)
    assert sum(numbers) == total
    choices = product(*(range(least, size + 1) for least, size in zip(fewest, sizes, strict=True)))

    def remoteness(chosen: tuple[int, ...]) -> Fraction:
        """Return the sum of squares divided by shares, which the exact quotas minimise."""
        return sum((number * number / share for number, share in zip(chosen, shares, strict=True)), start=Fraction(0))

    nearest = min((each for each in choices if sum(each) == total), key=remoteness)
    assert max(abs(one - two) for one, two in zip(numbers, nearest, strict=True)) <= 1


def test_proportional_equal_and_neyman_allocations_have_their_known_numbers() -> None:
    strata = strata_of(TaskSpace(load_domain("hanoi"), "2..4"), "length", seed=0, most=3)
    assert [each.size for each in strata] == [3, 8, 23]
    assert Stratification.parse("length").counts(strata, 17) == [2, 4, 11]  # quotas 2 (at least), 120/31, 345/31
    assert Stratification.parse("length", "equal").counts(strata, 17) == [3, 7, 7]  # the first has only 3
    by_deviation = Stratification.parse("length", "length_2=0,length_3=1/2,length_4=1/4")
    assert by_deviation.counts(strata, 12) == [2, 4, 6]  # quotas 2, 160/39 and 230/39
    assert str(by_deviation) == "length_2=0,length_3=1/2,length_4=1/4"


@pytest.mark.parametrize(
    "allocation, number, message",
    [
        ("fair", 8, "choose proportional or equal"),
        ("length_2=-1", 8, "at least 0"),
        ("length_9=1", 8, "no stratum 'length_9'"),
        ("equal", 5, "request 6 to 34 tasks"),
        ("equal", 35, "request 6 to 34 tasks"),
        ("length_2=1,length_3=0,length_4=0", 8, "allow at most 7"),
    ],
)
def test_an_impossible_allocation_is_refused(allocation: str, number: int, message: str) -> None:
    strata = strata_of(TaskSpace(load_domain("hanoi"), "2..4"), "length", seed=0, most=3)
    with pytest.raises(QueryError, match=message):
        Stratification.parse("length", allocation).counts(strata, number)


def test_too_many_strata_are_refused_before_they_are_listed() -> None:
    with pytest.raises(QueryError, match="4266036480 skeletons"):
        strata_of(TaskSpace(load_domain("prag"), 15), "skeleton", seed=0, most=10)
