"""Behaviour cloning from an export: what the networks of benchmarks/learning/imitation.py see and predict."""

from __future__ import annotations

import math
import sys
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prag_asp import Dataset, TaskSpace, load_domain
from prag_asp.dataset import export, generate
from prag_asp.dataset.scenes import scene_of
from prag_asp.evaluation import StoredScenarios, evaluate
from prag_asp.evaluation.lerobot_view import LeRobotView
from tests.docs.pages import ROOT

torch = pytest.importorskip("torch", reason="PyTorch is installed with the extra learning")
torch.set_num_threads(1)


@pytest.fixture(scope="module")
def imitation() -> Any:
    """The module of the benchmark."""
    sys.path.insert(0, str(ROOT / "benchmarks" / "learning"))
    yield import_module("imitation")
    sys.path.pop(0)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """A task of two actions with a recording, exported to the folder `export` beside it."""
    folder = tmp_path_factory.mktemp("imitation")
    dataset = generate(TaskSpace(load_domain("tabletop"), 2), folder / "data", tasks=1, seed=1, demonstrate=True)
    export(dataset, "lerobot", folder / "export", action="ee_position", state=["ee_position"], objects=True)
    return dataset


@pytest.fixture(scope="module")
def frames(imitation: Any, data: Dataset) -> Any:
    domain = data.domain
    return imitation.Frames.read(Path(data.folder).parent / "export", scene_of(domain), domain.facts.actions)


def test_frames_have_the_goals_and_the_ends_of_the_recording(imitation: Any, data: Dataset, frames: Any) -> None:
    first, second = data.task(0).actions
    count, vocabulary = len(frames.state), frames.vocabulary
    switch = int(frames.subgoal_end[0]) + 1
    assert 0 < switch < count and set(frames.end) == {count - 1} and frames.subgoal_end[switch] == count - 1
    for begin, end, action in ((0, switch, first), (switch, count, second)):
        assert {tuple(row) for row in frames.goals[begin:end].tolist()} == {vocabulary.action(str(action))}
    skill, body, other = vocabulary.action("pick(panda,cube_1,table_1)")
    assert (vocabulary.skills[skill], vocabulary.objects[body], other) == ("pick(panda,_,_)", "cube_1", -1)
    known = vocabulary.sentence("Please, " + data.entry(0).instruction["default"].lower())
    assert 0 not in known[: known.index(0)] and vocabulary.sentence("xylophone")[:2] == [1, 0]
    assert np.allclose(frames.commanded[1:], frames.actions[:-1, 6])


def test_relative_poses_are_those_of_plane_geometry(imitation: Any) -> None:
    yaw, turn = 0.7, 0.2
    body = [[[1.0, 0.5, 0.1, 0.02, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)], [0.0] * 8]]
    seen = imitation.relative(np.array([[0.4, 0.3, 0.12, 0.0, 0.0, turn, 0.08]]), np.array(body))
    angles = [function(times * (yaw - turn)) for times in (2, 4) for function in (math.cos, math.sin)]
    assert np.allclose(seen[0, 0], [1.0, 1.0, -2.0, -1.0, *angles]) and not seen[0, 1].any()


def test_a_network_that_knows_the_recording_repeats_it(imitation: Any, data: Dataset, frames: Any) -> None:
    """The targets of a frame, through the policy, are the recorded actions, also where the turn exceeds half a turn."""
    every = np.arange(len(frames.state))
    targets = frames.targets(every, frames.state, "sentence")
    policy = imitation.Imitator(imitation.Network("sentence", np.zeros((2, 1), np.float32), 1), frames.vocabulary)
    step = {"at": 0}
    policy._network.forward = lambda inputs, sentences: torch.from_numpy(targets[[step["at"]]])
    info = {"action": str(data.task(0).actions[0]), "instruction": ""}
    for at in range(0, len(every) - imitation.CHUNK, imitation.EXECUTED):
        step["at"] = at
        observation = {"agent_pos": frames.state[at], "environment_state": frames.bodies[at].ravel()}
        actions = [policy(observation, info) for _ in range(imitation.EXECUTED)]
        off = np.array(actions) - frames.actions[at : at + imitation.EXECUTED]
        off[:, 5] = imitation.wrapped(off[:, 5])
        assert np.abs(off).max() < 1e-5


@pytest.mark.parametrize("kind", ["objects", "names", "sentence"])
def test_each_kind_of_network_is_determined_by_its_seed(imitation: Any, frames: Any, kind: str) -> None:
    one, two, other = (imitation.imitated(frames, kind, steps=2, seed=seed) for seed in (0, 0, 1))
    assert all(torch.equal(*pair) for pair in zip(one.parameters(), two.parameters(), strict=True))
    assert not torch.equal(one.layers[0].weight, other.layers[0].weight)


def test_a_policy_acts_in_the_environment(imitation: Any, data: Dataset, frames: Any) -> None:
    policy = imitation.Imitator(imitation.imitated(frames, "sentence", steps=1, seed=0), frames.vocabulary)
    view = partial(LeRobotView, steps=6, state=("ee_position",))
    results = evaluate(policy, StoredScenarios.open(data.folder), control="ee_position", wrapper=view, steps=3)
    assert [each.steps for each in results.episodes] == [6]
