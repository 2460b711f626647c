"""Draws without replacement: every task once, parts apart, the k-th without those before it, and by weight exactly."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from itertools import count, islice

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.space import distinct_sampling
from prag_asp.space.distinct_sampling import TaskOrder, WeightedOrder
from prag_asp.space.parts.ranked_tasks import RankRange, ShuffledRanks
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.space.sampling.rank_order import EvenOrder, ShareOrder
from prag_asp.space.weights.weights import Weights
from prag_asp.space.without_replacement import Division, ordered_parts, with_tasks
from tests.chance import Chance

SIZES = (3, 0, 17, 1, 5)


def shuffled(size: int, seed: int = 7) -> ShuffledRanks:
    return ShuffledRanks(Shuffle(size, seed), RankRange(range(size)))


@pytest.fixture(scope="module")
def prag() -> TaskSpace:
    return TaskSpace(load_domain("prag"), range(1, 3))


@pytest.fixture(scope="module")
def kitchen() -> TaskSpace:
    return TaskSpace(load_domain("kitchen"), range(1, 4))


@pytest.mark.parametrize("order", [ShareOrder(SIZES, shuffled(26)), EvenOrder(tuple(map(shuffled, SIZES)))])
def test_each_task_has_one_number_and_each_number_one_task(order: ShareOrder | EvenOrder) -> None:
    found = [order[number] for number in range(order.size)]
    assert Counter(stretch for stretch, _ in found) == {i: size for i, size in enumerate(SIZES) if size}
    assert sorted(found) == [(stretch, rank) for stretch, size in enumerate(SIZES) for rank in range(size)]
    assert [order.number(*each) for each in found] == list(range(order.size))


def test_even_stretches_come_by_turns_until_one_is_used_up() -> None:
    order = EvenOrder(tuple(map(shuffled, (2, 1, 4))))
    assert [order[number][0] for number in range(order.size)] == [0, 1, 2, 0, 2, 2, 2]
    with pytest.raises(IndexError):
        order[order.size]


def test_numbers_beyond_64_bits_are_met_as_any_other() -> None:
    order = ShareOrder((10**30, 10**31), shuffled(11 * 10**30))
    stretch, rank = order[10**29 + 3]
    assert order.number(stretch, rank) == 10**29 + 3


def keys(part: TaskOrder, first: int = 0, some: int | None = None) -> list[tuple[int, int]]:
    return [(len(each.word), each.rank) for each in islice(part.pick(count(first)), some)]


@pytest.mark.parametrize("division", ["tasks", "skeletons", "hold out"])
@pytest.mark.parametrize(("weights", "some"), [({}, None), ({"grasp": 3}, 25)])
def test_parts_have_every_task_once_and_go_on_anywhere(
    prag: TaskSpace, division: str, weights: dict[str, int], some: int | None
) -> None:
    ways = {
        "tasks": Division.parse({"a": "2/3", "b": "1/3"}),
        "skeletons": Division.parse({"a": "2/3", "b": "1/3"}, skeletons=True),
        "hold out": Division.parse(None, hold_out="can_1"),
    }
    parts = ordered_parts(prag, ways[division], seed=3, weights=prag.weights(weights))
    found = {name: keys(part, some=some) for name, part in parts.items()}
    every = [key for part in found.values() for key in part]
    assert len(every) == len(set(every)) == (prag.count() if some is None else 2 * some)
    assert sum(part.size for part in parts.values()) == prag.count()
    for name, part in parts.items():
        assert keys(part, 5, 15) == found[name][5:20]
    if division == "skeletons":
        names = [{prag.at(n)[rank].skeleton for n, rank in part} for part in found.values()]
        assert not names[0] & names[1]
    if division == "hold out":
        assert not any("can_1" in str(prag.at(n)[rank]) for n, rank in found["train"])
        assert all("can_1" in str(prag.at(n)[rank]) for n, rank in found["test"])


def test_parts_of_one_length_are_those_of_a_split(prag: TaskSpace) -> None:
    space = prag.at(2)
    split = space.split({"train": "0.8", "test": "0.2"}, seed=4)
    parts = ordered_parts(space, Division.parse({"train": "0.8", "test": "0.2"}), seed=4, weights=Weights())
    for name, part in parts.items():
        assert [task.actions for task in split[name]] == [
            task.actions for _, task in with_tasks(space, part.pick(count()))
        ]


def test_draws_by_weight_come_as_often_as_their_weights_say(kitchen: TaskSpace, chance: Chance) -> None:
    """The first draw, and the second given the first, have the exact probabilities of weighted draws without return."""
    space = kitchen.at(2)
    weights = {"open": 3, "close": "1/2"}
    exact = {
        draw.word: draw.probability for draw in islice(space.sampling(weights=weights).draws(seed=0), 400)
    }  # fmt: skip
    assert sum(exact.values()) == 1
    firsts, seconds = Counter[tuple[str, ...]](), Counter[tuple[str, ...]]()
    times = chance.examples(300)
    for seed in map(chance.seed, range(times)):
        (part,) = ordered_parts(space, Division.parse(None), seed=seed, weights=space.weights(weights)).values()
        first, second = islice(part.pick(count()), 2)
        firsts[first.word] += 1
        seconds[second.word] += 1
    for word, probability in exact.items():
        after = sum(
            other * probability / (1 - other) for each, other in exact.items() if each != word
        )  # Fraction, exactly
        for counted, expected in ((firsts, probability), (seconds, after)):
            deviation = float(times * expected * (1 - expected)) ** 0.5
            assert abs(counted[word] - times * Fraction(expected)) < 5 * deviation


def test_what_weighs_nothing_is_never_drawn_and_the_rest_ends(
    kitchen: TaskSpace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(distinct_sampling, "MISSES", 300)
    drawn = [task.skeleton for task in kitchen.stream(seed=2, weights={"close": 0}, distinct=True)]
    expected = [task.skeleton for task in kitchen if "close" not in task.skeleton]
    assert sorted(drawn) == sorted(expected) and 0 < len(drawn) < kitchen.count()


def test_weights_are_obeyed_or_refused(kitchen: TaskSpace) -> None:
    parts = ordered_parts(kitchen, Division.parse(None), seed=0, weights=kitchen.weights())
    assert all(isinstance(part, WeightedOrder) for part in parts.values())
    with pytest.raises(QueryError, match="uniform"):
        ordered_parts(kitchen, Division.parse(None), seed=0, weights=kitchen.weights(), evenly=True)
    with pytest.raises(QueryError, match="juggle"):
        kitchen.stream(seed=0, weights={"juggle": 2}, distinct=True)


def test_an_empty_part_and_an_empty_space_are_told(kitchen: TaskSpace) -> None:
    with pytest.raises(QueryError, match="no tasks to sample for the part b"):
        ordered_parts(kitchen.at(1), Division.parse({"a": "99/100", "b": "1/100"}), seed=0, weights=Weights())
    with pytest.raises(QueryError, match="no tasks to sample"):
        ordered_parts(kitchen.where("uses apple", "avoids apple"), Division.parse(None), seed=0, weights=Weights())
