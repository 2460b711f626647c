"""Task spaces of several lengths: counts add up, and each task is drawn with its share of all of them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from itertools import islice

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.errors import LimitReached
from prag_asp.space.engines.engine import Level
from prag_asp.space.limits import Limits
from tests.sharing import logic_shared
from tests.space.sampling.test_sampling import DOMAIN, KINDS, expected_weight

DRAWS = 8_000
SPACES = TaskSpace(DOMAIN, range(3))


@pytest.fixture(scope="module", autouse=True)
def logic() -> Iterator[None]:
    """Compute once what logic says of a domain."""
    with logic_shared():
        yield


@cache
def spaces_of(engine: str) -> TaskSpace:
    return TaskSpace(DOMAIN, range(3), engine=engine)


@cache
def words_of(by: Level, length: int) -> list[tuple[str, ...]]:
    return list(spaces_of("clingo").at(length).enumerate(by))


def weighed(by: Level, weights: dict[str, object], lengths: range = range(3)) -> dict[tuple[str, ...], Fraction]:
    """Return every word of some lengths with its weight by the definition, those that weigh nothing left out."""
    found = {
        word: expected_weight(word, weights)  # type: ignore[arg-type]
        for length in lengths
        for word in words_of(by, length)
    }
    return {word: weight for word, weight in found.items() if weight}


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
@pytest.mark.parametrize("kind", ["uniform", "all kinds", "never"])
@pytest.mark.parametrize("by", ["task", "plan"])
def test_draws_follow_the_weights_of_all_tasks_of_all_lengths(kind: str, by: Level, engine: str) -> None:
    weights = KINDS[kind]
    expected = weighed(by, dict(weights))
    total = sum(expected.values())
    draws = list(islice(spaces_of(engine).sampling(weights=weights, by=by).draws(seed=5), DRAWS))
    seen = Counter(draw.word for draw in draws)
    assert set(seen) <= set(expected)
    assert all(draw.probability == expected[draw.word] / total for draw in draws)
    shares = {word: float(DRAWS * weight / total) for word, weight in expected.items()}
    statistic = sum((seen[word] - share) ** 2 / share for word, share in shares.items())
    freedom = len(shares) - 1
    assert abs(statistic - freedom) < 4.5 * math.sqrt(2 * freedom)


def test_the_probabilities_of_all_tasks_add_up_to_one() -> None:
    draws = islice(TaskSpace(DOMAIN, range(1, 3)).sampling(weights={"grasp": 2, "apple": "1/3"}).draws(seed=1), 12_000)
    probabilities = {draw.word: draw.probability for draw in draws}
    assert len(probabilities) == SPACES.at(1).count() + SPACES.at(2).count()  # so many draws show each of 301
    assert sum(probabilities.values()) == 1


def test_a_skeleton_of_any_length_is_drawn_uniformly_where_skeletons_come_first() -> None:
    weights = {"rotate": 0, "can_1": 3}
    expected = weighed("task", dict(weights))
    by_skeleton: dict[tuple[str, ...], Fraction] = {}
    for word, weight in expected.items():
        skeleton = tuple(action.partition("(")[0] for action in word)
        by_skeleton[skeleton] = by_skeleton.get(skeleton, Fraction(0)) + weight
    draws = list(islice(SPACES.sampling(weights=weights, over="skeletons").draws(seed=2), 4000))
    seen = Counter(tuple(action.partition("(")[0] for action in draw.word) for draw in draws)
    assert set(seen) == set(by_skeleton)
    statistic = sum((count - 4000 / len(seen)) ** 2 / (4000 / len(seen)) for count in seen.values())
    assert abs(statistic - len(seen)) < 4.5 * math.sqrt(2 * len(seen))
    for draw in draws[:500]:
        skeleton = tuple(action.partition("(")[0] for action in draw.word)
        assert draw.probability == expected[draw.word] / by_skeleton[skeleton] / len(by_skeleton)


def test_draws_depend_on_the_seed_and_their_place_alone() -> None:
    spaces = TaskSpace(DOMAIN, range(2, 6))
    many = spaces.sample(300, seed=7)
    assert spaces.sample(5, seed=7) == many[:5] and spaces.sample(120, seed=7) == many[:120]
    assert spaces.sample(300, seed=8) != many
    assert {len(task) for task in many} == {3, 4, 5} or {len(task) for task in many} == {2, 3, 4, 5}
    assert all(task in spaces for task in many)


def test_every_engine_draws_the_same() -> None:
    one, *others = [TaskSpace(DOMAIN, range(1, 3), engine=engine) for engine in ("automaton", "clingo", "sat")]
    assert all(other.sample(50, seed=3) == one.sample(50, seed=3) for other in others)


def test_lengths_do_not_share_random_bits() -> None:
    # The k-th draws of two lengths would begin alike if both read the same bits.
    spaces = TaskSpace(DOMAIN, range(4, 6))
    first: dict[int, list[str]] = {4: [], 5: []}
    for draw in islice(spaces.sampling(weights={"move": 8}).draws(seed=1), 4000):
        first[len(draw.word)].append(draw.word[0])
    pairs = list(zip(first[4], first[5], strict=False))
    assert len(pairs) > 30
    shares = Counter(first[4] + first[5])
    by_chance = sum((count / shares.total()) ** 2 for count in shares.values())
    alike = sum(one == other for one, other in pairs)
    assert abs(alike - by_chance * len(pairs)) < 4.5 * math.sqrt(by_chance * len(pairs))


def test_one_length_draws_as_its_space_does() -> None:
    spaces, space = TaskSpace(DOMAIN, [4]), TaskSpace(DOMAIN, 4)
    assert spaces.sample(20, seed=3) == space.sample(20, seed=3)
    assert [*islice(spaces.sampling().draws(seed=3), 9)] == [*islice(space.sampling().draws(seed=3), 9)]
    assert spaces.sample(5, seed=3, over="goals") == space.sample(5, seed=3, over="goals")


def test_tasks_carry_the_logarithm_of_their_probability_in_the_union() -> None:
    total = sum(SPACES.at(length).count() for length in range(3))
    for task in SPACES.sample(20, seed=0, weights={}):
        assert task.log_probability == pytest.approx(-math.log(total))


def test_counts_add_up_and_words_come_length_by_length() -> None:
    lengths = range(1, 4)
    spaces = TaskSpace(DOMAIN, lengths)
    assert spaces.count() == 36 + 265 + 2092 and spaces.count("skeleton") == 8 + 30 + 124
    expected = [word for length in lengths for word in TaskSpace(DOMAIN, length).enumerate("skeleton")]
    assert list(spaces.enumerate("skeleton")) == expected
    begun = [word for word in expected if word[:2] == ("grasp", "rotate")]
    assert spaces.count("skeleton", ["grasp", "rotate"]) == len(begun)
    assert list(spaces.enumerate("skeleton", ["grasp", "rotate"])) == begun
    tasks = [task for length in (1, 2) for task in TaskSpace(DOMAIN, length)]
    assert list(TaskSpace(DOMAIN, (1, 2))) == tasks
    assert list(islice(TaskSpace(DOMAIN, (2, 1)), 1)) == [TaskSpace(DOMAIN, 2)[0]]
    assert tasks[0] in spaces and TaskSpace(DOMAIN, 4)[0] not in spaces and "task" not in spaces
    assert repr(spaces) == "TaskSpace('prag', length='1..3')"


def test_conditions_keep_the_tasks_of_each_length_that_satisfy_them() -> None:
    spaces = TaskSpace(DOMAIN, range(1, 4)).where("uses apple", "has at least 1 grasp")
    each = [TaskSpace(DOMAIN, length).where("uses apple", "has at least 1 grasp") for length in range(1, 4)]
    assert spaces.count() == sum(space.count() for space in each)
    drawn = spaces.sample(200, seed=4, weights={})
    assert {task.actions for task in drawn} <= {task.actions for task in spaces}
    assert Counter(map(len, drawn))[3] > 100


def test_a_length_without_tasks_is_never_drawn() -> None:
    spaces = TaskSpace(DOMAIN, range(4)).where("has at least 2 grasp")
    assert spaces.at(2).count() == 0 < spaces.count()
    assert {len(task) for task in spaces.sample(50, seed=1)} == {3}


def test_what_cannot_be_asked_is_refused() -> None:
    for lengths in ((), (2, 2)):
        with pytest.raises(QueryError, match="give at least one, and each once"):
            TaskSpace(DOMAIN, lengths)
    with pytest.raises(QueryError, match="length -1: a plan has at least 0 actions"):
        TaskSpace(DOMAIN, range(-1, 2))
    with pytest.raises(QueryError, match="at least 0"):
        SPACES.sample(-1, seed=0)
    with pytest.raises(QueryError, match="over goals, tasks of one length are sampled"):
        SPACES.sample(1, seed=0, over="goals")
    with pytest.raises(QueryError, match="choose task or plan"):
        SPACES.stream(seed=0, by="skeleton")
    with pytest.raises(QueryError, match=r"there is no task of the lengths 1, 2 to sample"):
        TaskSpace(DOMAIN, (1, 2)).where("has at least 3 grasp").sample(1, seed=0)
    with pytest.raises(QueryError, match=r"did you mean grasp\?"):
        SPACES.sample(1, seed=0, weights={"gras": 2})
    with pytest.raises(QueryError, match=r"did you mean grasp\?"):
        SPACES.enumerate(prefix=["gras"])


def test_a_limit_ends_a_count_of_several_lengths() -> None:
    with pytest.raises(LimitReached):
        TaskSpace(load_domain("tabletop"), range(1, 9), limits=Limits(seconds=1e-9, cached=False)).count()


def test_lengths_may_be_written_as_text_and_one_length_is_asked_for_where_ranks_are() -> None:
    assert TaskSpace(DOMAIN, "1..3").lengths == TaskSpace(DOMAIN, range(1, 4)).lengths == (1, 2, 3)
    assert TaskSpace(DOMAIN, "2").length == 2
    for ask in (lambda: SPACES.length, lambda: SPACES[0], SPACES.statistics, lambda: SPACES.split({"a": 1})):
        with pytest.raises(QueryError, match=r"the lengths 0(\.\.|, 1, )2: choose one, such as space\.at\(0\)"):
            ask()
    for length in ("x", "3..1", "1..", -1, 2.5, "1..9999999"):
        with pytest.raises(QueryError, match="length"):
            TaskSpace(DOMAIN, length)  # type: ignore[arg-type]
