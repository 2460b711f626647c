from __future__ import annotations

import json
import pickle
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec

import prag_asp.rl  # noqa: F401 - registers the environments
from prag_asp import Dataset, TaskSpace, load_domain, shipped_domains
from prag_asp.dataset import generate
from prag_asp.dataset.store.instructions import LEVELS
from prag_asp.errors import PragError, QueryError
from prag_asp.rl import TaskEnv
from prag_asp.rl.tasks.task_origin import Split
from prag_asp.space.without_replacement import Division
from tests.chance import Chance

STILL = np.zeros(5, dtype=np.float32)
MOVES = 6


def made(name: str, **options: Any) -> Any:
    return gymnasium.make(name, disable_env_checker=True, **options)


@pytest.fixture
def env() -> Iterator[TaskEnv]:
    found = TaskEnv(domain="tabletop", length=2)
    yield found
    found.close()


def test_each_domain_with_a_scene_has_a_name_and_no_other() -> None:
    named = {
        spec.kwargs["domain"]
        for name, spec in gymnasium.registry.items()
        if name.startswith("prag_asp/") and spec.kwargs
    }
    assert named == {name for name in shipped_domains() if load_domain(name).settings.scene}


def test_a_description_in_json_makes_the_same_environment_again() -> None:
    options = {"length": "1..2", "where": ["uses can"], "split": "test", "hold_out": "cube", "reward": "sparse"}
    env = made("prag_asp/Tabletop-v0", **options)
    text = env.spec.to_json()
    assert json.loads(text)["kwargs"]["where"] == ["uses can"]
    again = gymnasium.make(EnvSpec.from_json(text))
    first, second = env.reset(seed=3), again.reset(seed=3)
    assert first[1] == second[1] and "can" in first[1]["task"] and "cube" in first[1]["task"]
    assert np.array_equal(first[0], second[0])
    env.close()
    again.close()


@pytest.mark.parametrize("options", [{}, {"skeletons": True}, {"hold_out": "can_1"}, {"split_seed": 5}])
def test_the_parts_of_a_split_are_those_of_a_dataset(tmp_path: Any, options: dict[str, Any]) -> None:
    space = TaskSpace(load_domain("prag"), "2..3")
    shares = None if "hold_out" in options else {"train": "0.7", "test": "0.3"}
    own = {"skeletons": False, "hold_out": None} | {
        name: each for name, each in options.items() if name != "split_seed"
    }
    seed = options.get("split_seed", 0)
    dataset = generate(space, tmp_path / "data", tasks=40, seed=seed, split=shares, physics=False, **own)
    parts = {name: Split(name, Division.parse(shares, **own), seed).of(space) for name in ("train", "test")}
    assert sum(part.size for part in parts.values()) == space.count()
    for name, part in parts.items():
        words = {part.word(number) for number in range(part.size)}
        assert len(words) == part.size and all(word in part for word in words)
        for task in dataset.part(name).tasks():
            held = [each for each, other in parts.items() if tuple(map(str, task.actions)) in other]
            assert held == [name]


def test_tasks_come_from_the_part_alone(chance: Chance) -> None:
    parts = {}
    for name in ("train", "test"):
        env = made(
            "prag_asp/Task-v0",
            domain="prag",
            length="1..2",
            split=name,
            skeletons=True,
            shares={"train": "0.6", "test": "0.4"},
        )
        drawn = [env.reset(seed=chance.seed(1) if number == 0 else None)[1]["task"] for number in range(8)]
        parts[name] = {" ".join(action.split("(")[0] for action in task.split()) for task in drawn}
        env.close()
    assert parts["train"] and parts["test"] and not parts["train"] & parts["test"]


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"domain": "tabletop"}, "length="), ({"length": 2}, "give it with a domain"), ({}, "one origin"),
        ({"domain": "table", "length": 2}, "no such domain"), ({"domain": "tabletop", "length": "x"}, "length"),
        ({"domain": "tabletop", "length": 2, "where": "uses can"}, "a list of conditions"),
        ({"domain": "tabletop", "length": 2, "where": ["uses cn"]}, "cn"),
        ({"domain": "tabletop", "length": 2, "split": "dev"}, "dev"),
        ({"domain": "tabletop", "length": 2, "shares": {"train": 1}}, "no part is named"),
        ({"domain": "tabletop", "length": 2, "split": "train", "shares": "0.5"}, "give the share of each part"),
        ({"domain": "tabletop", "length": 2, "split": "test", "shares": {"test": "0.3"}}, "add up"),
        ({"domain": "tabletop", "length": 2, "split": "test", "split_seed": 0.5}, "whole number"),
        ({"domain": "tabletop", "length": 2, "everything": "maybe"}, "everything 'maybe': give True or False"),
        ({"domain": "tabletop", "length": 2, "split": "test", "hold_out": "moon"}, "moon"),
        ({"domain": "tabletop", "length": "0..2", "split": "test"}, "lengths from 1"),
        ({"domain": "blocks", "length": 2}, "scene"), ({"dataset": "no such folder"}, "no such folder"),
        ({"domain": "tabletop", "length": 2, "language": "xx"}, "xx"),
    ],
)  # fmt: skip
def test_values_that_name_no_environment_are_refused(options: dict[str, Any], told: str) -> None:
    with pytest.raises(PragError, match=told):
        TaskEnv(**options).reset(seed=0)


def test_an_episode_is_saved_and_restored_bit_for_bit(chance: Chance, env: TaskEnv) -> None:
    with pytest.raises(QueryError, match="no episode has begun"):
        env.save_state()
    rng = np.random.default_rng(chance.seed(2))
    env.reset(seed=chance.seed(3))
    moves = rng.uniform(-1.0, 1.0, (3 * MOVES, 5))
    for move in moves[:MOVES]:
        observation, *_, info = env.step(move)
    state = env.save_state()

    def continued(one: TaskEnv) -> list[Any]:
        steps = [one.step(move) for move in moves[MOVES:]]
        return [[seen.tobytes(), *rest] for seen, *rest in steps]

    expected = continued(env)
    env.reset()
    seen, told = env.restore_state(state)
    assert told == info and np.array_equal(seen, observation)
    assert continued(env) == expected
    other = TaskEnv(domain="tabletop", length=2)
    other.restore_state(pickle.loads(pickle.dumps(state)))
    assert continued(other) == expected
    other.close()
    with pytest.raises(QueryError, match="not a state of an episode"):
        env.restore_state({"stage": 1})


@pytest.mark.parametrize("options", [{"control": "ee_delta"}, {"rate": 10}, {"observation": "poses"}])
def test_the_state_of_an_environment_with_other_arguments_is_refused(env: TaskEnv, options: dict[str, Any]) -> None:
    env.reset(seed=0)
    other = TaskEnv(domain="tabletop", length=2, **options)
    with pytest.raises(QueryError, match="the state belongs to another environment"):
        other.restore_state(env.save_state())
    other.close()


def test_info_has_instructions_at_three_levels_and_the_sentence_of_the_subgoal(env: TaskEnv) -> None:
    _, info = env.reset(options={"rank": 100})
    assert info["instruction_vague"] != info["instruction_exact"] != info["instruction"]
    assert (info["subgoals"], info["stage"]) == (2, 0)
    sentences = [info["subgoal"], env.reset(options={"rank": 100, "stage": 1})[1]["subgoal"]]
    assert len({*sentences}) == 2 and all(text.endswith(".") for text in sentences)
    german = TaskEnv(domain="tabletop", length=2, language="de")
    assert "Klotz" in german.reset(options={"rank": 100})[1]["instruction_exact"]
    german.close()


def test_instructions_of_a_dataset_are_its_own(dataset: Dataset) -> None:
    env = made("prag_asp/Dataset-v0", dataset=str(dataset.folder))
    for number, entry in enumerate(dataset.entries()):
        _, info = env.reset(options={"rank": number})
        levels = [info["instruction" if level == "default" else f"instruction_{level}"] for level in LEVELS]
        assert levels == [entry.instruction[level] for level in LEVELS] and info["subgoal"] == entry.subgoals[0]
    env.close()


def test_a_reset_can_give_the_episode_other_steps(env: TaskEnv) -> None:
    for steps in (1, 3):
        _, info = env.reset(seed=0, options={"steps": steps})
        assert info["steps_left"] == 2 * steps
    with pytest.raises(QueryError, match="at least 1 step"):
        env.reset(options={"steps": 0})
    for _ in range(6):
        *_, truncated, _ = env.step(STILL)
    assert truncated


def test_the_scenario_of_an_episode_begins_it_again(dataset: Dataset) -> None:
    env, data = TaskEnv(domain="tabletop", length=2), TaskEnv(dataset=dataset)
    for each in (env, data):
        observation, info = each.reset(seed=3)
        again, same = env.reset(options={"scenario": info["scenario"]})
        assert same["task"] == info["task"] and same["scenario"] == info["scenario"]
        assert np.array_equal(observation, again)
    for wrong in ({"scenario": "tabletop:2"}, {"scenario": info["scenario"], "rank": 1}):
        with pytest.raises(QueryError):
            env.reset(options=wrong)
    env.close()
    data.close()
