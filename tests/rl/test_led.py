"""Environments that are led by curricula: what they tell, keep and resume."""

from __future__ import annotations

import gc
import json
import tracemalloc
from collections.abc import Mapping
from fractions import Fraction
from functools import _lru_cache_wrapper
from typing import Any

import gymnasium
import numpy as np
import pytest

from prag_asp import Dataset, Task, TaskSpace, load_domain
from prag_asp.errors import QueryError
from prag_asp.physics import Witness
from prag_asp.rl import (
    AdaptiveCurriculum,
    BanditCurriculum,
    LengthCurriculum,
    NoveltyCurriculum,
    ReverseCurriculum,
    TaskEnv,
)
from tests.chance import Chance
from tests.rl.conftest import Given

STILL = np.zeros(5, dtype=np.float32)


@pytest.fixture(scope="module")
def space() -> TaskSpace:
    return TaskSpace(load_domain("tabletop"), length=2)


def begun(env: TaskEnv, count: int, seed: int | None = None) -> list[dict[str, Any]]:
    """Return what is told of some episodes, of which each lasts until its time is over."""
    found = []
    for number in range(count):
        _, info = env.reset(seed=seed if number == 0 else None)
        found.append(info)
        late = False
        while not late:
            _, _, done, late, _ = env.step(STILL)
            assert not done
    return found


@pytest.mark.parametrize(
    "curriculum", [(ReverseCurriculum(window=2), AdaptiveCurriculum(lot=4)), NoveltyCurriculum("tasks")]
)
def test_an_environment_that_is_resumed_begins_the_same_episodes(curriculum: Any, space: TaskSpace) -> None:
    def made() -> TaskEnv:
        return TaskEnv(space, curriculum=curriculum, steps=1, reward="faded", fade=5, stage="any")

    one, two = made(), made()
    with pytest.raises(QueryError, match="no state yet"):
        one.state_dict()
    begun(one, 5, seed=3)
    two.load_state_dict(json.loads(json.dumps(one.state_dict())))
    assert begun(one, 4) == begun(two, 4) and one.state_dict() == two.state_dict()
    state = json.loads(json.dumps(one.state_dict()))
    for wrong in ({"rng": state["rng"], "source": {}}, {**state, "spec": "another"}, "state"):
        with pytest.raises(QueryError, match="another environment"):
            two.load_state_dict(wrong)
    for wrong in (
        {**state, "source": {**state["source"], "number": -1}},
        {**state, "subgoals": {1, 2}},
        {**state, "checksum": 1},
    ):
        with pytest.raises(QueryError, match="damaged"):
            two.load_state_dict(wrong)
    assert two.state_dict() == state, "what is refused changes nothing"
    one.close()
    two.close()


def test_an_environment_of_a_dataset_or_of_one_task_is_resumed(
    dataset: Dataset, given: Mapping[str, list[Given]]
) -> None:
    task, witness = given["tabletop"][0]
    for asked in ({"dataset": dataset}, {"task": task, "witness": witness}):
        one, two = (TaskEnv(**asked, stage="any", steps=1) for _ in range(2))  # type: ignore[arg-type]
        begun(one, 5, seed=3)
        two.load_state_dict(json.loads(json.dumps(one.state_dict())))
        told = begun(one, 8)
        assert told == begun(two, 8) and one.state_dict() == two.state_dict()
        assert len({(each["task"], each["stage"]) for each in told}) > 2
        one.close()
        two.close()


def test_tasks_that_options_name_are_not_held_against_the_curriculum_of_tasks(space: TaskSpace) -> None:
    env = TaskEnv(space, curriculum=AdaptiveCurriculum(lot=2), steps=1)
    env.reset(seed=0)
    for options, noted in (({"rank": 100}, 0), ({"task": env.task}, 0), ({}, 1)):
        env.reset(options=options)
        while not env.step(STILL)[3]:
            pass
        course = env.state_dict()["source"]["sampler"]
        assert course["reported"] == noted and bool(course["ends"]) == bool(noted)
    env.close()


def test_each_draw_has_its_exact_probability_and_says_how_many_were_rejected(space: TaskSpace) -> None:
    env = TaskEnv(space, stage="any", steps=1)
    tried = [0]
    find = env._sampler.finder.witness

    def found(task: Task, **asked: int) -> Witness | None:
        tried[0] += 1
        return find(task, **asked) if tried[0] % 3 else None

    env._sampler.finder.witness = found  # type: ignore[method-assign]
    told = begun(env, 12, seed=1)
    assert {info["probability"] for info in told} == {Fraction(1, space.count())}
    assert {info["stage_probability"] for info in told} == {Fraction(1, 2)}
    # As many draws as were given and rejected lead to the last task.
    draws = sum(1 + info["rejected"] for info in told)
    source = env.state_dict()["source"]
    assert source["number"] == source["sampler"]["taken"] == draws > 12
    env._sampler.finder.witness = find  # type: ignore[method-assign]
    _, info = env.reset(options={"rank": 100, "stage": 0})
    assert info["probability"] is None and info["stage_probability"] is None and info["rejected"] == 0
    env.close()


def test_only_tasks_of_the_part_are_given(space: TaskSpace) -> None:
    part = space[:150]
    env = TaskEnv(space, part=part, steps=1)
    told = begun(env, 6, seed=2)
    assert {info["task"] for info in told} <= set(map(str, part)) and sum(info["rejected"] for info in told)
    assert env.state_dict()["source"]["number"] == sum(1 + info["rejected"] for info in told), "each draw has a number"
    with pytest.raises(QueryError, match="not in the part"):
        env.reset(options={"rank": 200})
    env.close()


def test_what_options_ask_for_is_not_held_against_the_curriculum(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(
        task=task, witness=witness, curriculum=ReverseCurriculum(threshold=1, window=1), steps=1, until="subgoal"
    )
    _, info = env.reset(seed=0)
    assert info["stage"] == 3 and info["curriculum"] == {"back": 1} and info["probability"] == 1
    env.reset(options={"stage": 0})
    env.step(STILL)
    assert env.state_dict()["subgoals"]["ends"] == []
    env.reset()
    env.step(STILL)
    assert env.state_dict()["subgoals"]["ends"] == [False]
    env.close()


def test_several_processes_have_their_own_curricula_and_hand_on_fractions(space: TaskSpace) -> None:
    made = gymnasium.make_vec(
        "prag_asp/Task-v0",
        2,
        vectorization_mode="async",
        space=space,
        steps=1,
        curriculum=(BanditCurriculum(), ReverseCurriculum()),
    )
    _, infos = made.reset(seed=4)
    assert all(isinstance(each, Fraction) for each in infos["probability"])
    assert infos["curriculum"]["arm"].shape == (2,) and infos["curriculum"]["back"].tolist() == [1, 1]
    for _ in range(3):
        made.step(made.action_space.sample())
    states = made.call("state_dict")
    assert states[0]["source"]["seed"] != states[1]["source"]["seed"]
    made.close()


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"curriculum": "adaptive"}, "not a curriculum"),
        ({"curriculum": AdaptiveCurriculum}, "not a curriculum"),
        ({"curriculum": (AdaptiveCurriculum(), BanditCurriculum())}, "of one kind"),
        ({"curriculum": (ReverseCurriculum(), ReverseCurriculum())}, "of one kind"),
        ({"part": "train"}, "not an origin"),
        (lambda space: {"space": TaskSpace(space.domain, range(1, 3)), "part": space.at(1)[:2]}, "part belongs to"),
        (lambda space: {"part": space.at(1)[:2]}, "of length|length=1"),
        (lambda space: {"part": TaskSpace(load_domain("prag"), 2)[:2]}, "the part belongs to TaskSpace"),
        (lambda space: {"part": space.where("has at least 1 stack")[:2]}, "not TaskSpace"),
        ({"domain": "kitchen"}, "have their own"),
        ({"render_mode": "film"}, "render mode"),
        ({"cameras": "front"}, "give their names"),
        ({"cameras": ("back",)}, "no camera back"),
        ({"cameras": ("front", "front")}, "twice|2 times"),
        ({"size": 8}, "pixels"), ({"size": (64,)}, "pixels"), ({"size": True}, "pixels"), ({"size": 1.5}, "pixels"),
    ],
)  # fmt: skip
def test_what_means_nothing_is_refused(space: TaskSpace, asked: Any, told: str) -> None:
    given = asked(space) if callable(asked) else asked
    with pytest.raises(QueryError, match=told):
        TaskEnv(**{"space": space, **given})


def test_an_episode_ends_once_and_steps_after_it_are_refused(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, curriculum=ReverseCurriculum(), steps=1, reward="faded", until="subgoal")
    env.reset(seed=0)
    env.reset()  # what is cut off is not heard of
    env.step(STILL)
    with pytest.raises(QueryError, match="the episode has ended"):
        env.step(STILL)
    state = env.state_dict()
    assert state["subgoals"]["ends"] == state["annealing"]["ends"] == [False]
    env.close()


def test_curricula_of_tasks_need_a_space(given: Mapping[str, list[Given]], space: TaskSpace) -> None:
    task, witness = given["tabletop"][0]
    for curriculum in (LengthCurriculum(), (ReverseCurriculum(), NoveltyCurriculum())):
        with pytest.raises(QueryError, match="needs a space"):
            TaskEnv(task=task, witness=witness, curriculum=curriculum)
    with pytest.raises(QueryError, match="give the space"):
        TaskEnv(task=task, part=space[:3])


@pytest.mark.slow
def test_memory_does_not_grow_with_steps(chance: Chance, given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, curriculum=ReverseCurriculum(), steps=10)
    rng = np.random.default_rng(chance.seed(9))
    env.reset(seed=0)

    gc.unfreeze()  # so that caches are among the objects
    # isinstance would look at __class__ of all objects, and proxies of PyTorch warn when one does
    caches = [each for each in gc.get_objects() if type(each) is _lru_cache_wrapper]
    gc.freeze()
    bounded = [each for each in caches if each.cache_parameters()["maxsize"] is not None]

    def run(steps: int) -> int:
        for _ in range(steps):
            _, _, done, late, _ = env.step(rng.uniform(-1.0, 1.0, 5))
            if done or late:
                env.reset()
        for each in bounded:  # poses that were seen, up to a bound, are not lost memory
            each.cache_clear()
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        first = run(100)
        assert run(200) - first < 33_000, "bytes: an observation has more than 200"
    finally:
        tracemalloc.stop()
        env.close()
