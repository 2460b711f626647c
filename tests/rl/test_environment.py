from __future__ import annotations

import copy
import json
import math
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray

import prag_asp.rl
from prag_asp import Dataset, Task, TaskSpace, load_domain
from prag_asp.errors import QueryError
from prag_asp.physics import Budget, Validator, Witness
from prag_asp.rl import AdaptiveCurriculum, TaskEnv, oracle
from prag_asp.rl.goals import PLACES
from prag_asp.rl.observations import FACTS
from prag_asp.rl.tasks import episode_sampler
from prag_asp.rl.tasks.task_sources import assign_witness
from prag_asp.scene.geometry import yaw_of
from tests.chance import Chance
from tests.rl.conftest import DOMAINS, Given

STILL = np.zeros(5, dtype=np.float32)


@pytest.fixture(scope="module")
def space() -> TaskSpace:
    return TaskSpace(load_domain("tabletop"), length=2)


@pytest.fixture
def env(space: TaskSpace) -> Iterator[TaskEnv]:
    found = TaskEnv(space, goals=True, observation="poses")
    yield found
    found.close()


@pytest.mark.filterwarnings("ignore:.*infinity.*", "ignore:.*not within the observation space.*")
@pytest.mark.filterwarnings("ignore:.*symmetric and normalized space.*")  # absolute values have their own units
@pytest.mark.parametrize(
    ("name", "control"), [*zip(DOMAINS, ("ee_delta_upright", "joint_position", "joint_delta", "ee_delta"), strict=True)]
)
def test_gymnasium_finds_nothing_wrong(name: str, control: Any, given: Mapping[str, list[Given]]) -> None:
    task, witness = given[name][0]
    everything, goals = control == "joint_delta", control == "ee_delta_upright"
    env = TaskEnv(task=task, witness=witness, control=control, everything=everything, goals=goals)
    check_env(env, skip_render_check=True)
    env.close()


def test_it_is_made_by_its_name(space: TaskSpace) -> None:
    assert prag_asp.rl.TaskEnv is TaskEnv
    env = gymnasium.make("prag_asp/Task-v0", space=space, reward="sparse", stage=-1)
    observation, info = env.reset(seed=3)
    assert info["stage"] == 1 and env.observation_space.contains(observation)
    env.close()


def test_the_same_seed_gives_the_same_episodes_in_any_environment(chance: Chance, space: TaskSpace) -> None:
    def told(env: TaskEnv) -> list[Any]:
        found: list[Any] = []
        rng = np.random.default_rng(chance.seed(1))
        for seed in (7, None, None):
            observation, info = env.reset(seed=seed)
            found += [info["task"], info["stage"], info["log_probability"]]
            for _ in range(5):
                observation, *rest = env.step(rng.uniform(-1.0, 1.0, 5))
                found += [observation.tobytes(), *rest]
        return found

    one, two = TaskEnv(space, stage="any"), TaskEnv(space, stage="any")
    first = told(one)
    assert told(two) == first == told(one)
    one.close()
    two.close()


def test_compute_reward_is_what_a_step_earns_alone_and_in_batches(chance: Chance, env: TaskEnv) -> None:
    rng = np.random.default_rng(chance.seed(2))
    env.reset(seed=1)
    goals, gains = [], []
    for _ in range(30):
        observation, gain, *_, info = env.step(rng.uniform(-1.0, 1.0, 5))
        goal = observation["achieved_goal"], observation["desired_goal"]
        assert env.compute_reward(*goal, info) == gain
        assert env.compute_terminated(*goal, info) is False
        goals.append(goal)
        gains.append(gain)
    achieved, desired = map(np.stack, zip(*goals, strict=True))
    assert env.compute_reward(achieved, desired, [{}] * 30).tolist() == gains
    assert not env.compute_terminated(achieved, desired, [{}] * 30).any()
    assert env.compute_terminated(achieved, achieved, None).all(), "any moment can serve as a goal"


@pytest.mark.parametrize("name", DOMAINS)
def test_the_oracle_reaches_the_subgoals_and_whole_tasks(name: str, given: Mapping[str, list[Given]]) -> None:
    ends = []
    for task, witness in given[name][:2]:
        env = TaskEnv(task=task, witness=witness, reward="sparse", steps=300)
        _, info = env.reset()
        total, ended = 0.0, False
        for action in oracle(env):
            _, gain, ended, late, info = env.step(action)
            total += gain
            if ended or late:
                break
        assert total == info["stage"] + ended, "1 for each subgoal"
        assert info["is_success"] is ended
        ends.append(ended)
        env.close()
    assert all(ends)


def test_info_has_the_same_keys_at_a_reset_and_at_each_step_and_arrays_hold_it(space: TaskSpace) -> None:
    env = TaskEnv(space, stage="any", curriculum=AdaptiveCurriculum(), steps=8)
    _, info = env.reset(seed=1)
    infos = [info, *(env.step(np.eye(5)[2])[4] for _ in range(8))]
    assert all(set(each) == set(info) for each in infos) and {"task", "probability", "curriculum"} <= set(info)
    assert [each["steps_left"] for each in infos] == [info["steps_left"] - i for i in range(9)]
    assert {each["task"] for each in infos} == {str(env.task)}
    for name in set(info) - {"rank", "curriculum"}:
        assert np.asarray([each[name] for each in infos]).dtype.kind in "biufU", name
    assert info["probability"] == Fraction(1, space.count()) == Fraction(str(info["probability"]))
    infos[0]["curriculum"].clear()
    assert env.reset()[1]["curriculum"], "each info is the reader's own"
    env.close()


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copy_continues_the_episode_and_those_after_it_in_the_same_way(
    chance: Chance, space: TaskSpace, copied: Callable[[Any], Any]
) -> None:
    env = gymnasium.make("prag_asp/Task-v0", space=space, stage="any", curriculum=AdaptiveCurriculum(), steps=20)
    untouched = copied(env)
    env.reset(seed=chance.seed(8))
    env.action_space.seed(chance.seed(9))
    for _ in range(9):
        env.step(env.action_space.sample())
    other = copied(env)

    def continued(one: Any) -> list[Any]:
        found: list[Any] = []
        for _ in range(60):
            observation, *rest = one.step(one.action_space.sample())
            found += [observation.tobytes(), *rest]
            if rest[1] or rest[2]:
                found.append(one.reset()[1])
        return found

    assert continued(other) == continued(env)
    with pytest.raises(QueryError, match="no episode has begun"):
        untouched.unwrapped.step(STILL)
    env.close()
    again = copied(env)
    with pytest.raises(QueryError, match="no episode has begun"):
        again.unwrapped.step(STILL)
    for each in (untouched, other, again):
        each.close()


def test_compute_truncated_is_what_a_step_says_alone_and_in_batches(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, steps=2, until="subgoal", goals=True)
    env.reset()
    rows = []
    for _ in range(2):
        observation, _, _, truncated, info = env.step(STILL)
        goal = observation["achieved_goal"], observation["desired_goal"]
        assert env.compute_truncated(*goal, info) is truncated
        rows.append((*goal, info, truncated))
    achieved, desired, infos, truncated = zip(*rows, strict=True)
    stacked = np.stack(achieved), np.stack(desired)
    assert truncated == (False, True)
    assert env.compute_truncated(*stacked, infos).tolist() == [*truncated]
    together = {"steps_left": np.array([info["steps_left"] for info in infos])}
    assert env.compute_truncated(*stacked, together).tolist() == [*truncated]
    assert not env.compute_truncated(*stacked, [{}] * 2).any(), "goals alone end nothing"
    assert env.compute_truncated(achieved[1], achieved[1], infos[1]) is False, "it is reached"
    env.close()


def test_any_subgoal_can_be_begun_with_and_is_the_end_where_that_is_asked(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, until="subgoal", reward="sparse", goals=True)
    for stage in (0, 1, 2, 3, -1):
        observation, info = env.reset(options={"stage": stage})
        assert info["stage"] == stage % 4 and info["action"] == str(task.actions[stage])
        assert observation["desired_goal"][0] == observation["achieved_goal"][0] == stage % 4
        gains = []
        for action in oracle(env):
            _, gain, ended, _, _ = env.step(action)
            gains.append(gain)
            if ended:
                break
        assert ended and sum(gains) == 1.0
    env.close()


def test_an_episode_ends_after_its_steps_and_standing_still_earns_nothing(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, steps=3, discount=0.99)
    env.reset()
    found = [env.step(STILL) for _ in range(12)]
    assert [(ended, late) for _, _, ended, late, _ in found] == [(False, False)] * 11 + [(False, True)]
    assert all(gain < 0.0 for _, gain, *_ in found)
    env.close()


def test_going_to_and_fro_and_pushing_what_is_in_the_way_earns_nothing(
    chance: Chance, given: Mapping[str, list[Given]]
) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, steps=1000, goals=True, discount=1.0)
    rng = np.random.default_rng(chance.seed(5))
    for _ in range(3):
        first, _ = env.reset()
        total, begun = 0.0, first["achieved_goal"][:PLACES]
        for move in rng.uniform(-1.0, 1.0, (10, 5)):
            for action in (move, -move):
                observation, gain, ended, *_ = env.step(action.astype(np.float32))
                total += gain
        last = observation["achieved_goal"][:PLACES]
        # What is earned is no more than what has been come nearer by, whatever was done in between.
        nearer = env.compute_reward(np.concatenate([last, begun]), observation["desired_goal"], {})
        assert not ended and total <= nearer + 1e-6
    env.close()


def moved_to(env: TaskEnv, place: Sequence[float]) -> tuple[float, NDArray[np.floating]]:
    """Move the closed hand to a place; return what that earns, and what is achieved then."""
    total = 0.0
    for _ in range(40):
        off = np.subtract(place, env.situation.tool("panda").position)
        observation, gain, ended, *_ = env.step(np.array([*(off / env.control.upper[0]), 0.0, -1.0]))
        total += gain
        assert not ended
        if np.abs(off).max() < 0.006:
            break
    return total, observation["achieved_goal"]


def test_to_push_what_the_subgoal_does_not_refer_to_earns_nothing(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, steps=1000, goals=True, discount=1.0)
    first, _ = env.reset()
    others = {"can_1", "cube_2"}.difference(task.actions[0].arguments)
    assert others
    for other in sorted(others):
        begun, home = env.reset()[0]["achieved_goal"][:PLACES], env.situation.tool("panda").position
        x, y, _ = env.situation.pose(other).position
        places = [(x - 0.12, y, 0.3), (x - 0.12, y, 0.03), (x + 0.05, y, 0.03), (x + 0.05, y, 0.3), home]
        gains, achieved = zip(*[moved_to(env, place) for place in places], strict=True)
        assert math.dist(env.situation.pose(other).position, (x, y, 0.0)) > 0.05, "it was not pushed"
        nearer = env.compute_reward(np.concatenate([achieved[-1][:PLACES], begun]), first["desired_goal"], {})
        assert sum(gains) <= nearer + 1e-5 and sum(gains) < 0.0, "the fingers are closed"
    env.close()


def test_what_the_options_say_is_begun(space: TaskSpace, given: Mapping[str, list[Given]], env: TaskEnv) -> None:
    _, info = env.reset(options={"rank": 100})
    assert info["task"] == str(space[100]) and info["rank"] == 100
    task, witness = given["tabletop"][1]
    _, info = env.reset(options={"task": task, "witness": witness, "stage": 2})
    assert info["task"] == str(task) and info["stage"] == 2 and info["reached"]


def test_options_that_mean_nothing_are_refused_and_the_episode_goes_on(env: TaskEnv) -> None:
    one, other = (next(iter(TaskSpace(load_domain(name), 1))) for name in ("tabletop", "prag"))
    refused: list[tuple[Any, str]] = [
        ({"stag": 1}, "stage"), ({"stage": 2}, "0 to 1"), ({"stage": "last"}, "0 to 1"), ({"stage": True}, "0 to 1"),
        ({"rank": 10**9}, "rank"), ({"rank": 1, "task": one}, "one of them"),
        ({"task": other}, "give a task of that domain"), (5, "by name"), ({1: 2}, "no option '1'"),
        ({"witness": None, "task": None, "rank": -1}, "rank"),
    ]  # fmt: skip
    _, info = env.reset(options={"rank": 100, "stage": 1})
    for options, words in refused:
        with pytest.raises(QueryError, match=words):
            env.reset(options=options)
        after = env.step(STILL)[4]
        assert str(env.task) == info["task"]
        assert (after["action"], after["reached"]) == (info["action"], info["reached"])


@pytest.mark.parametrize(
    "arguments",
    [
        {"space": "tabletop"}, {"space": None, "dataset": "data"}, {"space": None, "task": "pick(panda,can_1,table_1)"},
        {"steps": True}, {"steps": 1.5}, {"discount": "x"}, {"witness": "x"},
        {"stage": "last"}, {"stage": None}, {"stage": 0.0}, {"budget": 3}, {"discount": True},
        {"reward": "dens"}, {"until": "never"}, {"control": "legs"}, {"steps": 0}, {"discount": 0.0},
        {"reward": "faded", "fade": 0}, {"reward": "faded", "fade": "soon"}, {"space": None}, {"fade": 1.5},
        {"steps": np.int64(0)}, {"discount": np.float64(1.5)}, {"observation": "pixels"}, {"action_scale": 0},
    ],
)  # fmt: skip
def test_environments_that_mean_nothing_are_refused(space: TaskSpace, arguments: dict[str, Any]) -> None:
    with pytest.raises(QueryError):
        TaskEnv(**{"space": space, **arguments})


def test_numbers_of_numpy_are_numbers(space: TaskSpace) -> None:
    asked = {"steps": np.int64(2), "fade": np.int32(4), "discount": np.float32(0.5), "stage": np.int8(1)}
    env = TaskEnv(space, reward="faded", **asked)  # type: ignore[arg-type]
    env.reset(seed=0)
    assert [env.step(STILL)[3] for _ in range(2)] == [False, True]
    assert env.reset()[1]["stage"] == 1 and type(env.step(STILL)[1]) is float
    state = env.state_dict()
    env.load_state_dict(json.loads(json.dumps(state)))
    env.close()


def test_a_faded_reward_goes_from_dense_to_sparse_over_its_steps(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, reward="faded", fade=20, steps=5, until="subgoal", discount=0.9)
    gains = []
    for _ in range(6):
        env.reset()
        gains.append(sum(env.step(STILL)[1] for _ in range(5)))
    assert gains[0] < gains[1] < gains[3] < 0.0 == gains[4] == gains[5]
    env.close()


def test_tasks_of_a_dataset_are_begun_from_its_witnesses(dataset: Dataset) -> None:
    env = TaskEnv(dataset=dataset)
    found = {env.reset(seed=0 if i == 0 else None)[1]["task"] for i in range(20)}
    assert found == {str(task) for task in dataset.tasks()}
    env.close()


def test_each_number_of_an_observation_has_a_name(env: TaskEnv) -> None:
    observation, info = env.reset(seed=1)
    seen = dict(zip(env.layout.names, observation["observation"].tolist(), strict=True))
    assert observation["achieved_goal"].shape == (2 * PLACES,)
    robot, (x, y, z) = env.situation.arm("panda"), env.situation.tool("panda").position
    assert [seen[f"panda: {what}"] for what in "xyz"] == pytest.approx([x, y, z], abs=1e-6)
    assert seen["panda: width"] == pytest.approx(robot.width, abs=1e-6)
    assert seen["pick(panda,_,_)"] == 1.0 and sum(seen[name] for name in env.layout.skills) == 1.0
    thing = info["action"].removeprefix("pick(").split(",")[1]
    at = env.situation.pose(thing).position
    assert [seen[f"body 1: {what}"] for what in ("x", "y", "z")] == pytest.approx(list(at), abs=1e-6)
    turn = 2.0 * (yaw_of(env.situation.pose(thing).quaternion) - yaw_of(env.situation.tool("panda").quaternion))
    told = seen["body 1: cos turn"], seen["body 1: sin turn"]
    assert told == pytest.approx((math.cos(turn), math.sin(turn)), abs=1e-6)
    assert seen["body 1: dz"] == pytest.approx(at[2] - z, abs=1e-6)


def test_a_relative_observation_has_numbers_of_the_poses_by_their_scales(
    chance: Chance, given: Mapping[str, list[Given]]
) -> None:
    task, witness = given["prag"][0]
    envs = [TaskEnv(task=task, witness=witness, observation=kind) for kind in ("relative", "poses")]
    rng = np.random.default_rng(chance.seed(4))
    scales, names = (env.layout.scales for env in envs)
    assert set(scales) < set(names) and set(names.values()) == {1.0}
    found = [env.reset()[0] for env in envs]
    for _ in range(20):
        seen, poses = (
            dict(zip(env.layout.names, each.tolist(), strict=True)) for env, each in zip(envs, found, strict=True)
        )
        for name, scale in scales.items():
            bounds = (-0.1, 0.5) if "fact" in name else (-np.inf, np.inf)
            assert seen[name] == pytest.approx(scale * np.clip(poses[name], *bounds), abs=1e-5)
        measured = envs[0].save_state()["_before"][1:]
        assert [poses[name] for name in FACTS] == pytest.approx(measured.tolist(), abs=1e-6)
        assert max(map(abs, seen.values())) < 10.0
        move = rng.uniform(-1.0, 1.0, 5)
        found = [env.step(move)[0] for env in envs]
    for env in envs:
        env.close()


def test_a_stage_can_be_that_of_an_action_and_tasks_have_it(space: TaskSpace) -> None:
    env = TaskEnv(TaskSpace(load_domain("prag"), length=3), stage="grasp")
    probabilities = set()
    for number in range(8):
        info = env.reset(seed=0 if number == 0 else None)[1]
        stages = [i for i, action in enumerate(env.task.actions) if action.name == "grasp"]
        assert info["stage"] in stages and info["stage_probability"] == Fraction(1, len(stages))
        probabilities.add(info["probability"])
    assert probabilities == {Fraction(1, TaskSpace(load_domain("prag"), length=3).where("has grasp").count())}
    env.close()
    env = TaskEnv(space)
    assert env.reset(options={"rank": 0, "stage": "pick"})[1]["action"].startswith("pick(")
    with pytest.raises(QueryError, match="the name of an action"):
        env.reset(options={"rank": 0, "stage": "grasp"})
    env.close()


@pytest.mark.parametrize("name", ["two_arms", "kitchen"])
def test_bodies_are_seen_from_the_arm_that_acts_and_all_of_them_where_asked(
    name: str, given: Mapping[str, list[Given]]
) -> None:
    acted, opened = set(), False
    for task, witness in given[name]:
        env = TaskEnv(task=task, witness=witness, everything=True, observation="poses")
        for stage, action in enumerate(task.actions):
            observation, _ = env.reset(options={"stage": stage})
            seen = dict(zip(env.layout.names, observation.tolist(), strict=True))
            robot = next(argument for argument in action.arguments if argument in env.layout.robots)
            tool = env.situation.tool(robot).position
            assert env.layout.bodies
            for entity in env.layout.bodies:
                assert (seen[f"{entity}: is there"] == 1.0) is (entity in env.situation.poses)
                if entity in env.situation.poses:
                    at = env.situation.part(entity).position
                    told = [seen[f"{entity}: {what}"] for what in ("x", "y", "z", "dx", "dy", "dz", "opening")]
                    opening = env.situation.opening(entity)
                    assert told == pytest.approx([*at, *np.subtract(at, tool), opening], abs=1e-6)
                    opened |= opening > 0.1
            acted.add(robot)
        env.close()
    assert acted == set(env.layout.robots) and opened is (name == "kitchen")


def test_witnesses_are_looked_for_within_the_budget(space: TaskSpace, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    validate = Validator.validate
    monkeypatch.setattr(
        Validator, "validate", lambda own, task, **more: asked.append(more["budget"]) or validate(own, task, **more)
    )
    env = TaskEnv(space, budget=Budget(restarts=7))
    env.reset(seed=1)
    env.reset(options={"rank": 3})
    assert set(asked) == {Budget(restarts=7)}
    env.close()


def test_an_environment_loads_no_torch_and_leaves_nothing_behind_and_prints_nothing(tmp_path: Path) -> None:
    code = (
        "import os, sys, prag_asp.dataset, prag_asp.physics\n"
        "assert 'gymnasium' not in sys.modules\n"
        "import gymnasium\n"
        "env = gymnasium.make('prag_asp.rl:prag_asp/Tabletop-v0', length=1)\n"
        "env.reset(seed=0); env.step(env.action_space.sample())\n"
        f"assert os.listdir({str(tmp_path)!r}) == []; env.close(); env.close()\n"
        f"assert os.listdir({str(tmp_path)!r}) == [] and 'torch' not in sys.modules\n"
    )
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert (run.stdout, run.stderr) == ("", "")


def test_several_processes_act_at_once(space: TaskSpace) -> None:
    made = gymnasium.make_vec(
        "prag_asp/Task-v0", num_envs=2, vectorization_mode="async", space=space, reward="sparse", stage="any"
    )
    observations, infos = made.reset(seed=4)
    assert observations.shape[0] == 2 and len(infos["task"]) == 2
    for _ in range(3):
        made.step(made.action_space.sample())
    made.close()


def test_what_is_no_action_and_steps_outside_an_episode_are_refused(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness)
    with pytest.raises(QueryError, match="no episode has begun"):
        env.step(STILL)
    for of_an_episode in ("commanded_openings", "last", "action"):
        with pytest.raises(QueryError, match="no episode has begun"):
            getattr(env, of_an_episode)
    env.reset()
    for action in (
        np.zeros(4),
        np.zeros((5, 1)),
        np.full(5, np.nan),
        np.array([0.0, np.inf, 0.0, 0.0, 0.0]),
        np.full(5, -np.inf, dtype=np.float32),
        "up",
        None,
        [[1], [1, 2]],
        [1j] * 5,
        np.zeros(5, dtype=complex),
        np.array(["1"] * 5),
        np.ma.masked_all(5),
        [10**400] * 5,
    ):
        with pytest.raises(QueryError, match=r"an action has the shape \(5,\) and finite numbers"):
            env.step(action)
    assert env.step(np.full(5, 1e300))[0].shape == (44,)
    env.close()
    with pytest.raises(QueryError, match="no episode has begun"):
        env.step(STILL)


def test_a_closed_environment_can_be_begun_with_again(space: TaskSpace) -> None:
    env = TaskEnv(space)
    first = env.reset(seed=3)[1]["task"]
    env.close()
    assert env.reset(seed=3)[1]["task"] == first
    env.close()


def test_tasks_of_no_action_are_passed_over() -> None:
    domain = load_domain("tabletop")
    with pytest.raises(QueryError, match="have no subgoal"):
        TaskEnv(TaskSpace(domain, 0))
    env = TaskEnv(TaskSpace(domain, range(2)), stage="any")
    assert all(env.reset(seed=0 if number == 0 else None)[1]["task"] for number in range(8))
    with pytest.raises(QueryError, match="has no subgoal"):
        env.reset(options={"task": next(iter(TaskSpace(domain, 0)))})
    env.close()


def test_the_witness_of_another_task_is_refused(given: Mapping[str, list[Given]]) -> None:
    (task, witness), (_, other) = given["tabletop"][:2]
    short = Witness(witness.moments[:3], witness.motions[:2])
    for wrong, told in (
        (other, "of the witness, this fact does not hold:"),
        (short, "has 3 states, the task 5"),
    ):
        with pytest.raises(QueryError, match=told):
            TaskEnv(task=task, witness=wrong)


def test_a_task_with_its_witness_is_judged_once_and_only_so_many_are_kept(
    given: Mapping[str, list[Given]], monkeypatch: pytest.MonkeyPatch
) -> None:
    judged: list[Task] = []
    monkeypatch.setattr(
        episode_sampler, "assign_witness", lambda task, *more: judged.append(task) or assign_witness(task, *more)
    )
    (one, first), (two, second), (three, third) = given["tabletop"][:3]
    env = TaskEnv(task=one, witness=first)
    monkeypatch.setattr(episode_sampler, "CACHED", 6)
    for task, witness in ((one, first), (two, second), (two, second), (one, first)):
        env.reset(options={"task": task, "witness": witness})
    assert judged == [one, two]
    env.reset(options={"task": three, "witness": third})
    env.reset(options={"task": two, "witness": second})
    assert judged == [one, two, three, two], "what was begun with longest ago is forgotten"
    env.close()


def test_environments_without_a_seed_draw_different_tasks(space: TaskSpace) -> None:
    drawn = set()
    for _ in range(3):
        env = TaskEnv(space)
        drawn.add(env.reset()[1]["task"])
        env.close()
    assert len(drawn) > 1
