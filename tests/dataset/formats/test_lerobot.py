"""LeRobotDatasets, read by what is published of them, and by LeRobot itself where it is installed."""

from __future__ import annotations

import json
from itertools import islice
from pathlib import Path

import av
import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from prag_asp import Dataset
from prag_asp.dataset import export
from prag_asp.dataset.formats.chunks import places
from prag_asp.dataset.formats.episode_source import EpisodeSource
from prag_asp.dataset.formats.feature_statistics import Aggregate, Colours, statistics_of
from prag_asp.dataset.formats.lerobot import LeRobot
from prag_asp.dataset.formats.video import Video
from prag_asp.dataset.scenes import scene_of
from prag_asp.errors import QueryError
from prag_asp.physics import Staging, render_cameras
from tests.chance import Chance
from tests.dataset.formats.conftest import RATE, SIZE, of
from tests.dataset.formats.published import Published

JOINTS = [*(f"joint_{number}" for number in range(1, 8)), "gripper"]
CAMERAS = ["observation.images.front", "observation.images.wrist"]
ALLOWED = 350_000
"""Bytes of an episode of 185 frames with two cameras of 128 x 128 pixels."""


@pytest.fixture(scope="module")
def written(filmed: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(filmed, "lerobot", tmp_path_factory.mktemp("lerobot") / "out")


def assert_same(data: Dataset, folder: Path) -> None:
    """Check each frame of each episode against its recording."""
    read = Published(folder)
    number = 0
    for number, (entry, start, shown) in enumerate(data.demonstrations(), 1):
        footage = shown.footage
        frames = np.arange(len(shown.times)) if footage is None else footage.frames
        rows, episode = read.frames(number - 1), read.episodes.iloc[number - 1]
        assert len(rows) == episode["length"] == len(frames)
        assert np.allclose(rows["timestamp"], shown.times[frames] - shown.times[0], atol=1e-6)
        assert [*rows["frame_index"]] == [*range(len(frames))]
        arms = np.concatenate([shown.joints, shown.widths[..., None]], axis=2).reshape(len(shown.times), -1)
        assert np.array_equal(np.stack(rows["observation.state"].to_numpy()), arms[frames])
        driven = shown.commands.reshape(len(shown.times), -1)
        after = [*frames[1:], len(shown.times) - 1]
        assert np.array_equal(np.stack(rows["action"].to_numpy()), driven[after])
        ends = shown.ends.tolist()
        at = [min(sum(end < frame for end in ends[1:]), len(ends) - 2) for frame in frames]
        assert [*rows["subgoal_index"]] == at and (footage is None or at == footage.subgoals.tolist())
        assert [read.subtasks.index[each] for each in rows["subtask_index"]] == [entry.subgoals[each] for each in at]
        assert [*read.subtasks["subtask_index"]] == [*range(len(read.subtasks))]
        assert {read.tasks.index[each] for each in rows["task_index"]} == {entry.instruction["default"]}
        assert [*episode["tasks"]] == [entry.instruction["default"]]
        assert [*rows["next.done"]] == [False] * (len(rows) - 1) + [True]
        assert [*rows["next.reward"]] == [0.0] * (len(rows) - 1) + [1.0] and ends[-1] == len(shown.times) - 1
        assert (episode["prag_asp/part"], episode["prag_asp/task"]) == (entry.part, entry.number)
        assert episode["prag_asp/start"] == start and [*episode["prag_asp/plan"]] == [*map(str, entry.task.actions)]
        for camera in read.cameras:
            assert footage is not None
            seen = footage.videos[camera.rpartition(".")[2]].rgb
            for frame, picture in enumerate(read.pictures(number - 1, camera)):
                assert far(picture, seen[frame]) < 12
                nearest = min(range(len(seen)), key=lambda each: far(picture, seen[each]))
                assert far(seen[nearest], seen[frame]) < 1.5
    assert number == read.info["total_episodes"] == len(read.episodes)
    assert read.info["total_frames"] == read.episodes["length"].sum()
    assert read.info["total_tasks"] == len(read.tasks)


def far(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    """Return how far two pictures are from each other, on average over pixels."""
    return float(np.abs(one.astype(int) - other).mean())


def test_each_frame_is_that_of_its_recording_with_its_time_words_and_pictures(filmed: Dataset, written: Path) -> None:
    assert_same(filmed, written)
    info = Published(written).info
    assert (info["fps"], info["robot_type"], info["splits"]) == (RATE, "panda", {"train": "0:1", "test": "1:2"})
    assert info["features"]["action"]["names"] == [f"panda/{joint}" for joint in JOINTS]
    width, height = SIZE
    for camera in CAMERAS:
        feature = info["features"][camera]
        assert feature["shape"] == [height, width, 3] and feature["info"]["video.fps"] == RATE
    provenance = json.loads((written / "export.json").read_text())
    assert (provenance["form"], provenance["identity"]) == ("lerobot", filmed.manifest.identity)
    assert "2 episodes of `tabletop`" in (written / "README.md").read_text()


def test_files_that_are_full_are_followed_by_others(filmed: Dataset, tmp_path: Path) -> None:
    LeRobot(data_megabytes=0, video_megabytes=0).write(EpisodeSource(filmed), tmp_path / "out", lambda *_: None)
    assert_same(filmed, tmp_path / "out")
    for pattern in ("data/chunk-000/*", *(f"videos/{camera}/chunk-000/*" for camera in CAMERAS)):
        assert len(list((tmp_path / "out").glob(pattern))) == 2
    assert [*islice(places(), 998, 1002)] == [(0, 998), (0, 999), (1, 0), (1, 1)]


def test_two_robots_without_cameras_have_states_and_actions_of_each_joint(arms: Dataset, tmp_path: Path) -> None:
    folder = export(arms, "lerobot", tmp_path / "out")
    assert_same(arms, folder)
    info = Published(folder).info
    names = [f"{robot}/{joint}" for robot in ("left", "right") for joint in JOINTS]
    assert info["features"]["observation.state"]["names"] == info["features"]["action"]["names"] == names
    poses = np.stack(Published(folder).frames(0)["observation.environment_state"].to_numpy())
    (_, _, shown), *_ = arms.demonstrations()
    names = info["features"]["observation.environment_state"]["names"]
    for at, name in enumerate(names):
        entity, _, number = name.partition("/")
        assert number != "there" or (poses[:, at] == (entity in shown.objects)).all()
    assert poses.shape[1] == len(names)
    assert (info["fps"], info["video_path"], info["total_episodes"]) == (20, None, 2)
    assert not (folder / "videos").exists()


def test_actions_states_objects_and_depth_are_those_that_were_chosen(filmed: Dataset, tmp_path: Path) -> None:
    chosen = {"action": "ee_delta", "state": ("ee_position", "joint_position"), "objects": True, "depth": True}
    folder = export(filmed, "lerobot", tmp_path / "out", **chosen)
    info = json.loads((folder / "meta/info.json").read_text())["features"]
    told = info["action"]["prag_asp"]
    assert (told["control"], told["rate"], told["units"]) == ("ee_delta", RATE, [*("m",) * 3, *("rad",) * 3, "m"])
    tool = [f"panda/{name}" for name in ("x", "y", "z", "rx", "ry", "rz")]
    assert info["action"]["names"] == [*tool, "panda/gripper"]
    assert info["observation.state"]["names"] == [*tool, "panda/gripper", *(f"panda/{each}" for each in JOINTS[:7])]
    rows = pd.concat(map(pd.read_parquet, sorted((folder / "data").glob("*/*.parquet"))))
    rows = rows[rows["episode_index"] == 0]
    states, actions = (np.stack(rows[name].to_numpy()) for name in ("observation.state", "action"))
    lower, upper = np.array(told["lower"]), np.array(told["upper"])
    (_, _, shown), *_ = filmed.demonstrations()
    footage = shown.footage
    assert footage is not None
    assert np.allclose(states[:, :3], footage.tools[:, 0, :3], atol=1e-6)
    assert np.array_equal(states[:, 7:], shown.joints[footage.frames, 0])
    moved = np.cumsum((lower + (actions + 1) / 2 * (upper - lower))[:, :3], axis=0)
    assert np.abs(moved[:-1] - (states[1:, :3] - states[0, :3])).max() < 0.1, "the tool follows what it is told to"
    depth = np.array([np.stack(image) for image in rows["depth.front"]])
    assert depth.shape == (len(rows), *SIZE[::-1]) and depth.dtype == np.uint16
    assert np.abs(depth / 1000 - footage.videos["front"].depth.astype(float)).max() <= 0.00051
    assert info["depth.front"] == {
        "dtype": "uint16", "shape": [*SIZE[::-1]], "names": ["height", "width"], "prag_asp": {"unit": "mm"},
    }  # fmt: skip
    with pytest.raises(QueryError, match="minari has all observations"):
        export(filmed, "minari", tmp_path / "other", depth=True)
    with pytest.raises(QueryError, match="no state 'ee_delta'"):
        export(filmed, "lerobot", tmp_path / "other", state=["ee_delta"])


def test_statistics_are_those_of_all_frames_and_of_each_episode(filmed: Dataset, written: Path) -> None:
    read = Published(written)
    parts = [np.stack(read.frames(number)["observation.state"].to_numpy()) for number in range(2)]
    whole, told = np.concatenate(parts).astype(float), read.statistics["observation.state"]
    assert np.allclose(told["mean"], whole.mean(0)) and np.allclose(told["std"], whole.std(0))
    assert np.allclose(told["min"], whole.min(0)) and np.allclose(told["max"], whole.max(0))
    assert told["count"] == [len(whole)]
    for share, name in ((0.01, "q01"), (0.5, "q50"), (0.99, "q99")):
        each = [np.quantile(part, share, axis=0) for part in parts]
        assert np.allclose(told[name], np.min(each, 0) if share <= 0.5 else np.max(each, 0))
    first = read.episodes.iloc[0]
    assert np.allclose(first["stats/observation.state/q90"], np.quantile(parts[0], 0.9, axis=0))
    seen = [shown.footage.videos["wrist"].rgb / 255 for _, _, shown in filmed.demonstrations() if shown.footage]
    colours = read.statistics["observation.images.wrist"]
    assert np.allclose(np.ravel(colours["mean"]), np.concatenate(seen).mean((0, 1, 2)))
    assert np.shape(colours["std"]) == (3, 1, 1) and colours["count"] == [sum(map(len, seen))]
    assert np.allclose(np.ravel(colours["std"]), np.concatenate(seen).std((0, 1, 2)))
    assert {*read.statistics} == {*read.info["features"]}


def test_statistics_of_one_value_and_of_one_colour() -> None:
    (alone,) = statistics_of(np.array([2.5]))["q50"]
    assert alone == 2.5
    colours = Colours()
    colours.add(np.full((2, 2, 3), 255, dtype=np.uint8))
    assert {float(each) for name, found in colours.statistics().items() if name not in ("std", "count") for each in
            found.ravel()} == {1.0}  # fmt: skip
    sums = Aggregate()
    for values in ([0.0, 2.0], [4.0]):
        sums.add(statistics_of(np.array(values)))
    assert sums.statistics()["mean"] == pytest.approx(2.0)
    assert sums.statistics()["std"] == pytest.approx(np.std([0.0, 2.0, 4.0]))


def test_datasets_and_pandas_read_the_tables(written: Path, tmp_path: Path) -> None:
    import datasets
    import pandas

    rows = datasets.Dataset.from_parquet(str(written / "data/chunk-000/file-000.parquet"), cache_dir=str(tmp_path))
    assert len(rows[0]["action"]) == 8 and rows[0]["subgoal_index"] == 0
    assert pandas.read_parquet(written / "meta/tasks.parquet").index.name == "task"
    assert pandas.read_parquet(written / "meta/subtasks.parquet").index.name == "subtask"


def test_the_same_data_set_gives_the_same_bytes(filmed: Dataset, written: Path, tmp_path: Path) -> None:
    assert of(export(filmed.folder, "lerobot", tmp_path / "again")) == of(written)


def test_an_episode_of_185_frames_is_small(filmed: Dataset, written: Path, tmp_path: Path) -> None:
    _, _, shown = next(filmed.demonstrations())
    large = render_cameras(shown, scene_of(filmed.domain), Staging(("front", "wrist"), (128, 128), 10)).footage
    assert large is not None
    total = 0
    for camera, each in large.videos.items():
        video = Video(tmp_path / f"{camera}.mp4", (128, 128), 10)
        for picture in each.rgb:
            video.add(picture)
        video.close()
        assert video.seconds == len(large.frames) / 10
        total += video.size
    rows, about = (
        sum(path.stat().st_size for path in written.glob(f"{room}/**/*.parquet")) for room in ("data", "meta")
    )
    frames = Published(written).info["total_frames"]
    assert (total / len(large.frames) + rows / frames) * 185 + about / 2 < ALLOWED


def test_each_episode_begins_at_a_key_frame_and_is_decoded_alone(tmp_path: Path, chance: Chance) -> None:
    """The lengths are no multiples of ten, the greatest distance of key frames."""
    rng = np.random.default_rng(chance.seed(3))
    lengths, path = (7, 16, 5), tmp_path / "episodes.mp4"
    video = Video(path, SIZE, 5)
    for length in lengths:
        for number in range(length):
            video.add(rng.integers(256, size=(*SIZE[::-1], 3), dtype=np.uint8), key=number == 0)
    video.close()
    with av.open(str(path)) as file:
        whole = [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]
    begin = 0
    for length in lengths:
        with av.open(str(path)) as file:
            (stream,) = file.streams.video
            packets = sorted((p for p in file.demux(stream) if p.pts is not None), key=lambda packet: packet.dts)
            numbers = [round(float(packet.pts * stream.time_base) * 5) for packet in packets]
            own = packets[numbers.index(begin) :]
            assert own[0].is_keyframe and own[0].pts == min(packet.pts for packet in own)
            decoder = av.CodecContext.create("libdav1d", "r")
            decoder.extradata = stream.codec_context.extradata
            frames = [frame for packet in own for frame in decoder.decode(packet)] + decoder.decode(None)
            alone = [frame.to_ndarray(format="rgb24") for frame in frames[:length]]
        assert len(alone) == length
        assert all((one == two).all() for one, two in zip(alone, whole[begin:], strict=False))
        begin += length
    assert len(whole) == begin


def test_every_episode_of_an_export_begins_at_a_key_frame(written: Path) -> None:
    for _, row in Published(written).episodes.iterrows():
        for camera in CAMERAS:
            place = {each: row[f"videos/{camera}/{each}"] for each in ("chunk_index", "file_index", "from_timestamp")}
            name = f"videos/{camera}/chunk-{place['chunk_index']:03d}/file-{place['file_index']:03d}.mp4"
            with av.open(str(written / name)) as file:
                (stream,) = file.streams.video
                keys = [float(p.pts * stream.time_base) for p in file.demux(stream) if p.is_keyframe]
            assert any(abs(key - place["from_timestamp"]) < 1e-6 for key in keys)


def test_lerobot_itself_loads_it(filmed: Dataset, written: Path) -> None:
    try:
        from lerobot.datasets import lerobot_dataset as lerobot  # type: ignore[import-not-found,unused-ignore]
    except Exception as error:  # PyTorch and torchvision that do not fit raise whatever they like
        pytest.skip(f"LeRobot cannot be loaded ({error}): it asks for older versions of PyTorch and NumPy than we do")
    found = lerobot.LeRobotDataset("prag_asp/tabletop", root=written)
    assert (len(found), found.num_episodes) == (Published(written).info["total_frames"], 2)
    entry = filmed.entry(0)
    assert found[0]["task"] == entry.instruction["default"] and tuple(found[0][CAMERAS[0]].shape) == (3, *SIZE[::-1])
