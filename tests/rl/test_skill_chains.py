from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

import gymnasium
import numpy as np
import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.errors import QueryError
from prag_asp.rl import OraclePolicy, Rate, Rollouts, TaskEnv, run
from prag_asp.rl.goal_env import Observation
from prag_asp.rl.skill_chains import Rollout
from tests.rl.conftest import Given

STILL = np.zeros(5, dtype=np.float32)


@pytest.fixture
def env(given: Mapping[str, list[Given]]) -> Iterator[TaskEnv]:
    task, witness = given["tabletop"][0]
    found = TaskEnv(task=task, witness=witness, reward="sparse", steps=10)
    yield found
    found.close()


def runs_of(given: Given, *reached: int) -> Rollouts:
    """Rollouts of a task of four actions that came so far each."""
    task, _ = given
    return Rollouts(tuple(
        Rollout(task, 0, task.actions, (1,) * min(count + 1, 4), (9,) * min(count + 1, 4), count) for count in reached
    ))  # fmt: skip


def test_policies_take_over_from_each_other_where_the_predicates_say_so(env: TaskEnv) -> None:
    called: list[str] = []

    def told(name: str) -> Any:
        expert = OraclePolicy(env)

        def policy(observation: Observation) -> Any:
            called.append(name)
            assert env.action.name == name
            return expert(observation)

        policy.begin = expert.begin  # type: ignore[attr-defined]
        return policy

    runs = run(env, {name: told(name) for name in ("pick", "place", "stack", "insert")}, 1, patience=300)
    assert runs.rollouts[0].success and runs.rollouts[0].tries == (1, 1, 1, 1)
    assert len(called) == sum(runs.rollouts[0].steps) and len(set(called)) > 1
    assert runs.whole() == (1, 1) and runs.by_length() == (1, 1, 1, 1)


def test_a_subgoal_is_tried_again_from_where_it_stands(env: TaskEnv) -> None:
    class Late:
        """Moves the arm somewhere before it gives up, and acts where it takes over again."""

        def __init__(self, moves: int) -> None:
            self.expert, self.begun, self.moves = OraclePolicy(env), 0, [np.full(5, -0.3)] * moves

        def begin(self) -> None:
            self.begun += 1
            self.expert.begin()

        def __call__(self, observation: Observation) -> Any:
            if self.begun > 1:
                return self.expert(observation)
            return self.moves.pop() if self.moves else None

    for moves in (0, 20):
        late = Late(moves)
        found = run(env, late, 1, tries=2, patience=200).rollouts[0]
        assert found.tries == (2, 1, 1, 1) and found.success and found.steps[0] > moves
        assert late.begun == sum(found.tries)
    failed = run(env, lambda observation: STILL, 2, tries=3, patience=5)
    assert [(each.tries, each.steps, each.reached) for each in failed.rollouts] == [((3,), (15,), 0)] * 2
    assert failed.whole() == (0, 2) and failed.by_length() == (0,)


def test_policies_see_what_wrappers_show(env: TaskEnv) -> None:
    wrapped = gymnasium.wrappers.DtypeObservation(env, np.float64)
    seen: list[Any] = []
    runs = run(wrapped, seen.append, 1)
    assert runs.rollouts[0].steps == (0,) and [each.dtype for each in seen] == [np.float64]


def test_an_environment_says_which_subgoals_are_pursued(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, stage=1, until="subgoal", reward="sparse")
    found = run(env, OraclePolicy(env), [(task, witness)], patience=300).rollouts[0]
    assert (found.first, found.actions, found.reached) == (1, task.actions[1:2], 1)
    env.close()


def test_the_whole_is_the_product_of_its_stages_exactly(given: Mapping[str, list[Given]]) -> None:
    runs = runs_of(given["tabletop"][0], 4, 4, 0, 1, 1, 2, 3, 4, 4, 3, 3)
    rates = runs.by_stage()
    assert rates == ((10, 11), (8, 10), (7, 8), (4, 7))
    assert math.prod(rate.share for rate in rates) == runs.whole().share == Fraction(4, 11)
    assert runs.by_length() == (Fraction(10, 11), Fraction(8, 11), Fraction(7, 11), Fraction(4, 11))
    total = sum(rate.trials for rate in runs.by_action().values())
    assert total == sum(rate.trials for rate in rates)
    assert runs.table().splitlines()[-1].split() == ["whole", "36", "%", "(15", "to", "65;", "4", "of", "11)"]


@pytest.mark.parametrize(
    ("rate", "interval"),
    # Newcombe, "Two-sided confidence intervals for the single proportion" (1998), table I, method 3.
    [(Rate(81, 263), (0.2553, 0.3662)), (Rate(15, 148), (0.0624, 0.1605)), (Rate(0, 20), (0.0, 0.1611)),
     (Rate(1, 29), (0.0061, 0.1718)), (Rate(0, 0), (0.0, 1.0)), (Rate(20, 20), (0.8389, 1.0))],
)  # fmt: skip
def test_intervals_are_those_of_the_literature(rate: Rate, interval: tuple[float, float]) -> None:
    assert rate.interval() == pytest.approx(interval, abs=1e-4)


def test_what_means_nothing_is_refused(env: TaskEnv, given: Mapping[str, list[Given]]) -> None:
    with pytest.raises(QueryError, match="no policy 'pick'; did you mean pik"):
        run(env, {"pik": OraclePolicy(env)}, 1)
    for wrong in ({"tries": 0}, {"patience": 2.5}, {"tries": True}):
        with pytest.raises(QueryError, match="whole number from 1 on"):
            run(env, OraclePolicy(env), 1, **wrong)  # type: ignore[arg-type]
    for tasks in (-1, True, ["pick(panda,can_1,table_1)"], 1.5):
        with pytest.raises(QueryError, match="tasks"):
            run(env, OraclePolicy(env), tasks)  # type: ignore[arg-type]
    with pytest.raises(QueryError, match="in a TaskEnv, or in a task space; got 'tabletop'"):
        run("tabletop", OraclePolicy(env), 1)  # type: ignore[arg-type]
    with pytest.raises(QueryError, match="confidence"):
        Rate(1, 2).interval(95)


def test_a_space_is_drawn_from_and_the_same_seed_gives_the_same_runs() -> None:
    space = TaskSpace(load_domain("tabletop"), length=1)
    one, two = (run(space, lambda observation: STILL, 2, patience=2, seed=3) for _ in range(2))
    assert one == two and len(one.rollouts) == 2
    assert run(space, lambda observation: STILL, [one.rollouts[0].task], patience=1).whole() == (0, 1)
