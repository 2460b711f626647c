"""When a subgoal is reached: where the predicates say that all of its facts hold, and nowhere else."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
import pytest

from prag_asp.physics import Situation, Witness, physical_task
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.rl import TaskEnv, oracle
from prag_asp.rl.goals import BROUGHT, PLACES, Subgoal, subgoals_of
from prag_asp.scene.geometry import Pose
from prag_asp.scene.scene import Scene
from tests.chance import Chance
from tests.rl.conftest import DOMAINS, Given


def moments(witness: Witness, scene: Scene) -> Iterator[Situation]:
    for moment in witness.moments[1:]:
        yield Situation(scene, moment.poses, moment.arms, moment.openings)


@pytest.mark.parametrize("name", DOMAINS)
def test_a_subgoal_is_reached_where_all_that_is_known_after_its_action_holds(
    name: str, chance: Chance, scenes: Mapping[str, Scene], given: Mapping[str, list[Given]]
) -> None:
    scene, lost, spoilt = scenes[name], 0, 0
    for task, witness in given[name]:
        states = physical_task(task, scene).states[1:]
        for subgoal, facts, situation in zip(
            subgoals_of(task, scene), states, moments(witness, scene.with_sizes(witness.sizes)), strict=True
        ):
            assert set(facts) <= {*subgoal.achieved, *subgoal.unchanged} and max(reached_by(subgoal, situation)) <= 0.0
            assert set(subgoal.reached(subgoal.measured(situation))) == set(subgoal.names)
            for moved in pushed(situation, chance.generator(len(situation.poses))):
                holding = [fact.is_satisfied(moved) for fact in (*subgoal.achieved, *subgoal.unchanged)]
                assert (max(reached_by(subgoal, moved)) <= 0.0) == all(holding)
                told = subgoal.reached(subgoal.measured(moved))
                assert list(told) == [text for text, holds in zip(subgoal.names, holding, strict=True) if holds]
                lost += not all(holding)
                spoilt += not all(holding) and all(holding[: len(subgoal.achieved)])
    assert lost > 20 and spoilt > 5, "what shall stay is lost, too"


def pushed(situation: Situation, rng: random.Random) -> Iterator[Situation]:
    """Yield what becomes of a situation where each of its bodies is somewhere else, several times."""
    for entity, ((x, y, z), turned) in 4 * list(situation.poses.items()):
        if not situation.shape(entity).traits.furniture:
            at = (x + rng.uniform(-0.2, 0.2), y + rng.uniform(-0.2, 0.2), z + rng.choice((0.0, 0.1)))
            yield replace(situation, poses={**situation.poses, entity: Pose(at, turned)}, measured={})


def reached_by(subgoal: Subgoal, situation: Situation) -> list[float]:
    found = subgoal.placed(subgoal.measured(situation))
    assert len(found) == PLACES - 1
    return found


def test_facts_without_a_place_of_their_own_count_by_the_worst_of_them() -> None:
    facts = [Fact(PREDICATES["upright"], (f"body_{number}",), True) for number in range(BROUGHT + 3)]
    many = Subgoal(tuple(facts[: BROUGHT + 2]), tuple(facts[BROUGHT + 2 :]), ())
    measured = [0.1 * number for number in range(BROUGHT)] + [-0.5, -0.3, -0.4]
    assert many.placed(measured) == [*measured[:BROUGHT], -0.3]
    few = Subgoal(tuple(facts[:2]), tuple(facts[2:4]), ())
    assert few.placed([0.3, -0.2, -0.1, 0.4]) == [0.3, -0.2, *[0.0] * (BROUGHT - 2), 0.4]
    assert Subgoal((facts[0],), (), ()).placed([0.3]) == [0.3, *[0.0] * BROUGHT]


def test_what_is_told_as_reached_is_what_holds(chance: Chance, given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, steps=1000)
    rng = np.random.default_rng(chance.seed(2))
    subgoal = subgoals_of(task, env.scene)[0]
    _, info = env.reset()
    for _ in range(20):
        holding = [fact.is_satisfied(env.situation) for fact in (*subgoal.achieved, *subgoal.unchanged)]
        reached = info["reached"].split()
        assert reached == [name for name, holds in zip(subgoal.names, holding, strict=True) if holds]
        assert 0 < len(reached) < len(subgoal.names)
        *_, info = env.step(rng.uniform(-1.0, 1.0, 5))
    env.close()


@pytest.mark.parametrize("name", ["kitchen", "tabletop"])
def test_what_is_remembered_of_bodies_changes_no_distance(name: str, given: Mapping[str, list[Given]]) -> None:
    opened, last = 0, None
    for task, witness in given[name][:3]:
        env = TaskEnv(task=task, witness=witness, reward="sparse", steps=1000)
        env.reset()
        for action in itertools.islice(oracle(env), 150):
            ended = env.step(action)[2]
            subgoal = subgoals_of(task, env.scene)[env.stage]
            anew = replace(env.situation, measured={})
            assert subgoal.measured(env.situation) == subgoal.measured(anew) and env.situation.bodies == anew.bodies
            opened += env.situation.openings != last
            last = env.situation.openings
            if ended:
                break
        env.close()
    assert (opened > 30) is (name == "kitchen")


@pytest.mark.parametrize("domain", ["tabletop", "kitchen"])
def test_distances_that_are_kept_between_steps_are_those_computed_anew(domain: str, chance: Chance) -> None:
    env, rng = TaskEnv(domain=domain, length=2, steps=60), chance.generator(3)
    for episode in range(2):
        env.reset(seed=episode)
        for _ in range(25):
            low, high = env.action_space.low, env.action_space.high
            _, _, done, late, _ = env.step(np.array([rng.uniform(*pair) for pair in zip(low, high, strict=True)]))
            subgoal, situation, measured = env._measured
            anew = Situation(situation.scene, situation.poses, situation.arms, situation.openings, situation.tools)
            assert measured == subgoal.measured(anew)
            if done or late:
                break
    env.close()


@pytest.mark.parametrize("domain", ["tabletop", "prag"])
def test_distances_that_are_only_compared_change_neither_goals_nor_facts(domain: str, chance: Chance) -> None:
    env, rng, bounded = TaskEnv(domain=domain, length=2, stage="any", steps=60), chance.generator(5), 0
    for episode in range(3):
        env.reset(seed=episode)
        for _ in range(15):
            low, high = env.action_space.low, env.action_space.high
            _, _, done, late, _ = env.step(np.array([rng.uniform(*pair) for pair in zip(low, high, strict=True)]))
            subgoal, situation, measured = env._measured
            exact = [fact.way(situation) for fact in (*subgoal.achieved, *subgoal.unchanged)]
            assert subgoal.placed(measured) == subgoal.placed(exact)
            assert subgoal.reached(measured) == subgoal.reached(exact)
            assert all(bound >= distance for bound, distance in zip(measured, exact, strict=True))
            bounded += measured != exact
            if done or late:
                break
    env.close()
    assert bounded > 0
