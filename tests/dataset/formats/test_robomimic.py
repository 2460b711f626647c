"""HDF5 in robomimic's layout: what its documentation says is where it says, and is what was recorded."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from prag_asp import Dataset
from prag_asp.dataset import export
from prag_asp.dataset.formats.episode_source import EpisodeSource
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.scene.robots import PANDA, robot_of
from tests.dataset.formats.conftest import RATE, SIZE


@pytest.fixture(scope="module")
def written(filmed: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(filmed, "robomimic", tmp_path_factory.mktemp("robomimic") / "out.hdf5")


def test_each_sample_is_that_of_the_recording(filmed: Dataset, written: Path) -> None:
    lower, upper = np.array([*PANDA.lower, 0.0]), np.array([*PANDA.upper, PANDA.opening])
    total = 0
    with h5py.File(written) as file:
        for number, (entry, start, shown) in enumerate(filmed.demonstrations()):
            demo, footage = file[f"data/demo_{number}"], shown.footage
            assert footage is not None
            frames, steps = footage.frames, len(footage.frames) - 1
            total += steps
            assert demo.attrs["num_samples"] == steps == len(demo["actions"]) == len(demo["states"])
            assert np.array_equal(demo["action_dict/targets"], shown.commands[frames[1:], 0])
            scaled = demo["actions"][()]
            assert np.abs(scaled).max() <= 1
            assert np.allclose(lower + (scaled + 1) / 2 * (upper - lower), shown.commands[frames[1:], 0], atol=1e-6)
            assert demo["rewards"][()].tolist() == [0.0] * (steps - 1) + [1.0]
            assert demo["dones"][()].tolist() == [0] * (steps - 1) + [1]
            assert np.array_equal(demo["subgoals"], footage.subgoals[:-1])
            expected = {
                "panda_joint_pos": shown.joints[frames, 0],
                "panda_gripper_width": shown.widths[frames],
                "panda_eef_pos": footage.tools[:, 0, :3],
                "panda_eef_quat": footage.tools[:, 0, 3:],
            }
            for camera, seen in footage.videos.items():
                expected[f"{camera}_image"] = seen.rgb
                expected[f"{camera}_depth"] = seen.depth.astype(np.float32)[..., None]
            for name, values in expected.items():
                assert np.allclose(demo[f"obs/{name}"], values[:-1], rtol=0, atol=1e-6), name
                assert np.array_equal(demo[f"next_obs/{name}"][:-1], demo[f"obs/{name}"][1:]), name
            assert {*demo["obs"]} == {*demo["next_obs"]} == {
                *expected, "object", "front_segmentation", "wrist_segmentation"
            }  # fmt: skip
            assert demo["obs/front_image"].shape[1:] == (*SIZE[::-1], 3)
            told = json.loads(demo.attrs["ep_meta"])
            assert told["lang"] == entry.instruction["default"] and told["plan"] == [*map(str, entry.task.actions)]
            assert (told["part"], told["task"], told["start"]) == (entry.part, entry.number, start)
        assert file["data"].attrs["total"] == total
        assert [*file["mask/train"]] == [b"demo_0"] and [*file["mask/test"]] == [b"demo_1"]


def test_objects_and_entities_of_pixels_have_the_same_places_in_all_episodes(filmed: Dataset, written: Path) -> None:
    with h5py.File(written) as file:
        told = json.loads(file["data"].attrs["env_args"])
        assert told["env_name"] == "prag_asp/tabletop" and {*told} == {"env_name", "type", "env_kwargs"}
        kept = told["env_kwargs"]
        assert (kept["rate"], kept["joints"][-1]) == (RATE, "panda/gripper")
        for number, (_, _, shown) in enumerate(filmed.demonstrations()):
            assert shown.footage is not None
            rows = file[f"data/demo_{number}/obs/object"][()].reshape(-1, len(kept["objects"]), 8)
            for at, name in enumerate(kept["objects"]):
                there = name in shown.objects
                assert (rows[:, at, 0] == there).all()
                poses = shown.poses[shown.footage.frames[:-1], shown.objects.index(name)] if there else 0
                assert np.array_equal(rows[:, at, 1:], np.broadcast_to(poses, rows[:, at, 1:].shape))
            states = np.concatenate([file[f"data/demo_{number}/obs/{name}"] for name in
                                     ("panda_joint_pos", "panda_gripper_width", "object")], 1)  # fmt: skip
            assert np.array_equal(file[f"data/demo_{number}/states"], states)
            pixels = file[f"data/demo_{number}/obs/wrist_segmentation"][..., 0]
            legend = np.array(shown.footage.legend)[shown.footage.videos["wrist"].segmentation[:-1]]
            assert np.array_equal(np.array(kept["legend"])[pixels], legend)


def test_a_legend_in_another_order_means_the_same(filmed: Dataset) -> None:
    source = EpisodeSource(filmed)
    episode = next(source.episodes())
    footage = episode.demonstration.footage
    assert footage is not None
    turned = replace(footage, legend=(footage.legend[0], *footage.legend[:0:-1]))
    other = replace(episode, demonstration=replace(episode.demonstration, footage=turned))
    names = np.array(turned.legend)[footage.videos["front"].segmentation]
    assert np.array_equal(np.array(source.legend)[source.segmentation_of(other, "front")], names)
    assert not np.array_equal(source.segmentation_of(other, "front"), source.segmentation_of(episode, "front"))


def test_two_robots_without_cameras_have_their_own_keys(arms: Dataset, tmp_path: Path) -> None:
    with h5py.File(export(arms, "robomimic", tmp_path / "arms.hdf5")) as file:
        (_, _, first), (_, _, second) = arms.demonstrations()
        assert [file[f"data/demo_{number}"].attrs["num_samples"] for number in (0, 1)] == [
            len(first.times) - 1,
            len(second.times) - 1,
        ]
        demo = file["data/demo_1"]
        assert {*demo["obs"]} == {
            "left_joint_pos", "left_gripper_width", "right_joint_pos", "right_gripper_width", "object",
            "left_eef_pos", "left_eef_quat", "right_eef_pos", "right_eef_quat",
        }  # fmt: skip
        assert np.array_equal(demo["obs/right_joint_pos"], second.joints[:-1, second.robots.index("right")])
        assert demo["actions"].shape[1] == 16
        joints = second.joints[0, second.robots.index("right")].tolist()
        tool = tool_pose(robot_of(scene_of(arms.domain), "right"), tuple(joints))
        assert demo["obs/right_eef_pos"][0] == pytest.approx(tool.position, abs=1e-6)


def test_the_same_data_set_gives_the_same_bytes_at_another_time(filmed: Dataset, written: Path, tmp_path: Path) -> None:
    time.sleep(max(0.0, 1.1 - (time.time() - written.stat().st_mtime)))
    assert export(filmed, "robomimic", tmp_path / "again.hdf5").read_bytes() == written.read_bytes()


def test_other_actions_are_scaled_by_the_bounds_in_the_file(filmed: Dataset, tmp_path: Path) -> None:
    with h5py.File(export(filmed, "robomimic", tmp_path / "out.hdf5", action="ee_position")) as file:
        told = json.loads(file["data"].attrs["env_args"])["env_kwargs"]
        lower, upper = np.array(told["lower"]), np.array(told["upper"])
        demo = file["data/demo_0"]
        assert (told["control"], told["names"][:2], told["units"][2:4]) == (
            "ee_position", ["panda/x", "panda/y"], ["m", "rad"],
        )  # fmt: skip
        assert np.abs(demo["actions"][()]).max() <= 1
        scaled = lower + (demo["actions"][()] + 1) / 2 * (upper - lower)
        assert np.allclose(scaled, demo["action_dict/targets"], atol=1e-6)
        assert np.abs(demo["action_dict/targets"][:-1, :3] - demo["obs/panda_eef_pos"][1:]).max() < 0.1
