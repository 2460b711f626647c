"""Minari's own loader reads back what was recorded, and recovers an environment that takes its actions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prag_asp import Dataset
from prag_asp.dataset import export
from tests.dataset.formats.conftest import SIZE, of

NAME = "prag_asp/tabletop-v0"


@pytest.fixture(scope="module")
def written(filmed: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(filmed, "minari", tmp_path_factory.mktemp("minari") / "out")


def load(name: str, folder: Path, patch: pytest.MonkeyPatch) -> Any:
    import minari

    patch.setenv("MINARI_DATASETS_PATH", str(folder))
    assert [*minari.list_local_datasets()] == [name]
    return minari.load_dataset(name)


def test_steps_texts_and_spaces_are_those_of_the_recordings(
    filmed: Dataset, written: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = load(NAME, written, monkeypatch)
    legend = json.loads((written / NAME / "data/metadata.json").read_text())["legend"]
    recorded = [*filmed.demonstrations()]
    assert found.total_episodes == len(recorded)
    assert found.total_steps == sum(len(shown.footage.frames) - 1 for _, _, shown in recorded if shown.footage)
    for episode, (_, _, shown) in zip(found.iterate_episodes(), recorded, strict=True):
        footage = shown.footage
        assert footage is not None
        seen, frames = episode.observations, footage.frames
        assert np.array_equal(seen["state"], np.column_stack([shown.joints[frames, 0], shown.widths[frames]]))
        assert np.array_equal(episode.actions, shown.commands[frames[1:], 0])
        assert np.allclose(seen["tools"], footage.tools, atol=1e-6)
        assert np.array_equal(episode.infos["subgoal"], footage.subgoals)
        steps = len(frames) - 1
        assert episode.rewards.tolist() == [0.0] * (steps - 1) + [1.0]
        assert episode.terminations.tolist() == [False] * (steps - 1) + [True] and not episode.truncations.any()
        for camera, pictures in footage.videos.items():
            assert seen[f"{camera}_rgb"].shape == (len(frames), *SIZE[::-1], 3)
            assert np.abs(seen[f"{camera}_rgb"].astype(int) - pictures.rgb).mean() < 4  # they are JPEG
            assert np.array_equal(seen[f"{camera}_depth"], pictures.depth)
            entities = np.array(footage.legend)[pictures.segmentation]
            assert np.array_equal(np.array(legend)[seen[f"{camera}_segmentation"]], entities)
        assert {*episode.observations} == {*found.observation_space}
        for moment in range(len(episode)):
            assert found.action_space.contains(episode.actions[moment])
            for name, values in episode.observations.items():
                assert found.observation_space[name].contains(values[moment]), name
    for told, (entry, _, _) in zip(found.storage.get_episode_metadata(range(2)), recorded, strict=True):
        assert told["instruction"] == entry.instruction["default"] and told["part"] == entry.part
        assert json.loads(told["plan"]) == [*map(str, entry.task.actions)]
        assert json.loads(told["subgoals"]) == [*entry.subgoals]


def test_two_robots_without_cameras_load_too(arms: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = load("prag_asp/two_arms-v0", export(arms, "minari", tmp_path / "out"), monkeypatch)
    assert found.action_space.shape == (16,) and {*found.observation_space} == {"state", "objects", "tools"}
    assert [len(episode) for episode in found] == [len(shown.times) - 1 for _, _, shown in arms.demonstrations()]


def test_the_same_data_set_gives_the_same_bytes(filmed: Dataset, written: Path, tmp_path: Path) -> None:
    assert of(export(filmed, "minari", tmp_path / "again")) == of(written)


def test_the_recovered_environment_takes_the_actions_of_an_episode(
    arms: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = load("prag_asp/two_arms-v0", export(arms, "minari", tmp_path / "out", action="ee_delta"), monkeypatch)
    env = found.recover_environment()
    assert env.action_space == found.action_space
    assert env.spec.kwargs == {"domain": "two_arms", "length": [1], "where": [], "control": "ee_delta", "rate": 20}
    (entry, _, witness), *_ = arms.witnesses()
    env.reset(options={"task": entry.task, "witness": witness})
    for action in next(found.iterate_episodes()).actions:
        _, _, done, _, info = env.step(action)
        if done:
            break
    assert info["is_success"]
    env.close()
