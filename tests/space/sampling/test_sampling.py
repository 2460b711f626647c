"""Draws follow the weights exactly, for each kind of weight and on every engine."""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction
from functools import cache
from itertools import islice, pairwise

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.exact_numbers import Number
from prag_asp.space.engines.engine import Level
from tests.chance import Chance
from tests.spaces import with_engine

DRAWS = 8_000
DOMAIN = load_domain("prag")
PAIRS = TaskSpace(DOMAIN, 2)
FIRST, SECOND = "apple_1", "can_1"

ENTITIES = {
    "apple_1": {"apple", "graspable"}, "apple_2": {"apple", "graspable"}, "box_1": {"box", "graspable"},
    "can_1": {"can", "graspable"}, "bowl_1": {"bowl", "location"}, "crate_1": {"crate", "location"},
    "panda": {"gripper"},
}  # fmt: skip
"""The entities of the domain with their classes."""

KINDS: dict[str, dict[str, Number]] = {
    "uniform": {},
    "action": {"grasp": 2, "move": "0.25"},
    "pair": {"grasp>move": "1/2", "withdraw>approach": 5},
    "entity": {SECOND: 3, "bowl_1": "1/3"},
    "class": {"apple": 4, "location": "1/2"},
    "single action": {f"drop(panda,{SECOND})": 7},
    "all kinds": {"grasp": 2, "grasp>move": "0.5", "apple": 3, "graspable": "1/2", "crate_1": 2},
    "never": {"rotate": 0, "move>move": 0},
}


@cache
def pairs(engine: str) -> TaskSpace:
    """Return the space of two actions with an engine."""
    return with_engine(PAIRS, engine)


@cache
def words_of_pairs(engine: str, by: Level) -> list[tuple[str, ...]]:
    return list(pairs(engine).enumerate(by))


def expected_weight(plan: tuple[str, ...], weights: dict[str, Number]) -> Fraction:
    """Weigh a plan by the definition: actions and pairs as often as they occur, entities once."""
    names = [action.partition("(")[0] for action in plan]
    used = {entity for action in plan for entity in ENTITIES if entity in action}
    keys = [*names, *plan, *(f"{a}>{b}" for a, b in pairwise(names)), *used]
    keys += [name for entity in used for name in ENTITIES[entity]]
    return math.prod((Fraction(weights[key]) for key in keys if key in weights), start=Fraction(1))


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("by", ["task", "plan"])
def test_draws_follow_the_weights(kind: str, by: Level, engine: str, chance: Chance) -> None:
    weights = KINDS[kind]
    plans = words_of_pairs(engine, by)
    total = sum(expected_weight(plan, weights) for plan in plans)
    draws = list(islice(pairs(engine).sampling(weights=weights, by=by).draws(seed=chance.seed(11)), DRAWS))
    seen = Counter(draw.word for draw in draws)
    assert set(seen) <= {plan for plan in plans if expected_weight(plan, weights)}
    statistic, cells = 0.0, 0
    for plan in plans:
        expected = float(DRAWS * expected_weight(plan, weights) / total)
        if expected:
            statistic += (seen[plan] - expected) ** 2 / expected
            cells += 1
    freedom = cells - 1
    assert abs(statistic - freedom) < 4.5 * math.sqrt(2 * freedom)
    assert all(draw.probability == expected_weight(draw.word, weights) / total for draw in draws[:50])


def test_the_same_seed_draws_the_same_tasks_and_another_seed_others(chance: Chance) -> None:
    space = TaskSpace(DOMAIN, 6)
    one, other = chance.seed(1), chance.seed(2)
    assert space.sample(30, seed=one) == space.sample(30, seed=one) != space.sample(30, seed=other)


def test_draws_are_exact_where_counts_outgrow_every_machine_word(chance: Chance) -> None:
    """At 200 actions there are 10**125 skeletons; each of the eight names begins as often as it should."""
    space = TaskSpace(DOMAIN, 200)
    total = space.count("plan")
    assert total > 10**130
    draws = islice(space.sampling(weights={}, by="plan").draws(seed=chance.seed(3)), 2000)
    seen = Counter(draw.word[0].partition("(")[0] for draw in draws)
    for name in ("approach", "grasp", "move", "rotate"):
        share = Fraction(space.count("plan", [name]), total)
        assert abs(seen[name] - 2000 * share) < 4.5 * math.sqrt(float(2000 * share))


def test_a_task_carries_the_logarithm_of_its_probability() -> None:
    (task,) = TaskSpace(DOMAIN, 1).sample(1, seed=0, weights={})
    assert task.log_probability == pytest.approx(-math.log(36))


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ({"gras": 2}, "did you mean grasp?"),
        ({"grasp>mve": 2}, "did you mean move?"),
        ({"grasp": -1}, "below 0"),
        ({"grasp": "heavy"}, "not an exact number"),
        ({"grasp": 0.5}, "not an exact number"),
        ({"grasp": "1/0"}, "not an exact number"),
        ({"grasp": "nan"}, "not an exact number"),
        ({FIRST: 2}, "interchangeable"),
        ({f"drop(panda,{FIRST})": 2}, "interchangeable"),
    ],
)
def test_a_weight_that_means_nothing_is_refused(weights: dict[str, Number], message: str) -> None:
    with pytest.raises(QueryError, match=message.replace("?", r"\?")):
        TaskSpace(DOMAIN, 3).sample(1, seed=0, weights=weights)


def test_where_there_is_nothing_to_draw_the_message_says_so() -> None:
    names = ("approach", "withdraw", "grasp", "drop", "move", "transform", "follow", "rotate")
    for engine in ("automaton", "clingo"):
        with pytest.raises(QueryError, match="no task of length 1 to sample"):
            TaskSpace(DOMAIN, 1, engine=engine).sample(1, seed=0, weights=dict.fromkeys(names, 0))


def test_skeletons_are_not_drawn_and_counts_below_zero_are_refused() -> None:
    with pytest.raises(QueryError, match="choose task or plan"):
        next(TaskSpace(DOMAIN, 1).stream(seed=0, by="skeleton"))
    with pytest.raises(QueryError, match="at least 0"):
        TaskSpace(DOMAIN, 1).sample(-1, seed=0)
