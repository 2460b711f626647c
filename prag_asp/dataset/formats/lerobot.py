"""LeRobotDataset v3.0: chunked tables of frames, videos of many episodes, and the metadata of both in ``meta``.

The layout is that of https://huggingface.co/docs/lerobot/lerobot-dataset-v3; subtasks are as in
https://huggingface.co/docs/lerobot/dataset_subtask. Segmentation is not exported.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from prag_asp.dataset.formats.chunks import CHUNK, MEGABYTE, ChunkedTable, places, texts_table, write_table
from prag_asp.dataset.formats.episode_source import EpisodeSource, ExportEpisode
from prag_asp.dataset.formats.export_format import Progress
from prag_asp.dataset.formats.feature_statistics import (
    NAMES,
    Aggregate,
    Colours,
    Statistics,
    as_lists,
    flattened,
    statistics_of,
)
from prag_asp.dataset.formats.provenance import write_provenance
from prag_asp.dataset.formats.video import Video, video_info
from prag_asp.errors import QueryError
from prag_asp.output import make_folder, new_folder, replace_file
from prag_asp.physics.control.names import STATES, ControlName
from prag_asp.physics.control.recorded_actions import state_names
from prag_asp.wording import plural, unknown

VERSION = "v3.0"
PLACE = "chunk-{chunk_index:03d}/file-{file_index:03d}"
DATA, EPISODES = f"data/{PLACE}.parquet", f"meta/episodes/{PLACE}.parquet"
VIDEOS = f"videos/{{video_key}}/{PLACE}.mp4"

DEPTH = "depth."
"""The prefix of the features for depth images. It does not begin with ``observation``, because LeRobot's policies would
use such features as inputs.
"""

CARD = """---
tags: [LeRobot]
task_categories: [robotics]
configs:
- {{config_name: default, data_files: data/*/*.parquet}}
---

# {name}

A LeRobotDataset {version}: {episodes} of `{name}`, written by prag_asp. `subtask_index` is a row of
`meta/subtasks.parquet`, `subgoal_index` the number of the action in the plan of the episode.
"""


@dataclass(frozen=True)
class LeRobot:
    """The format of a LeRobotDataset; a data or video file that reaches its size limit in megabytes is full.

    `state` holds the conventions of ``observation.state``; with `objects`, the default if there are no cameras,
    ``observation.environment_state`` has the poses of objects; with `depth`, ``depth.CAMERA`` has the depth images.

    Raises:
        QueryError: there is no such convention of states.
    """

    state: tuple[ControlName, ...] = ("joint_position",)
    objects: bool | None = None
    depth: bool = False
    data_megabytes: int = 100
    video_megabytes: int = 200

    def __post_init__(self) -> None:
        for name in self.state:
            if name not in STATES:
                raise QueryError(unknown(name, STATES, "state"))
        if not self.state:
            raise QueryError(f"a state needs a convention; give {' or '.join(STATES)}")

    def has_objects(self, source: EpisodeSource) -> bool:
        """Return whether the poses of objects are exported."""
        return not source.cameras if self.objects is None else self.objects

    def write(self, source: EpisodeSource, target: Path, progress: Progress) -> None:
        """Write a folder with ``meta``, ``data`` and, if there are cameras, ``videos``.

        Raises:
            QueryError: there are no recordings.
            OutputError: the folder cannot be written.
        """
        with new_folder(target) as folder, closing(_LeRobotWriter(self, source, folder)) as run:
            for episode in source.episodes():
                run.add(episode)
                progress(plural(run.episodes, "episode"), run.episodes, source.count)
            run.finish()
            write_provenance(folder, source, "lerobot")


class _LeRobotWriter:
    """A writer of one dataset, episode by episode."""

    def __init__(self, form: LeRobot, source: EpisodeSource, folder: Path) -> None:
        self._form, self._source, self._folder = form, source, folder
        self.episodes = self._frames = 0
        self._tasks: dict[str, int] = {}
        self._subtasks: dict[str, int] = {}
        self._splits: dict[str, tuple[int, int]] = {}
        self._statistics: dict[str, Aggregate] = {}
        self._features = _features(form, source)
        # The features in the table of frames: all features except videos.
        columns = [(name, _column(each)) for name, each in self._features.items() if each["dtype"] != "video"]
        self._data = ChunkedTable(folder, DATA, pa.schema(columns), form.data_megabytes)
        self._rows = ChunkedTable(folder, EPISODES, _episode_schema(self._features), form.data_megabytes)
        self._videos = {
            f"observation.images.{name}": _VideoFeature(form, source, folder, name) for name in source.cameras
        }

    def add(self, episode: ExportEpisode) -> None:
        """Write an episode."""
        values = self._values(episode)
        statistics: dict[str, Statistics] = {
            name: statistics_of(value) for name, value in values.items() if has_statistics(name)
        }
        arrays = [_nested(values[column.name], column.type) for column in self._data.schema]
        chunk, file = self._data.add(pa.Table.from_arrays(arrays, schema=self._data.schema))
        row: dict[str, Any] = {
            "episode_index": self.episodes,
            "tasks": [episode.instruction],
            "length": episode.length,
            "data/chunk_index": chunk,
            "data/file_index": file,
            "dataset_from_index": self._frames,
            "dataset_to_index": self._frames + episode.length,
        }
        for key, video in self._videos.items():
            place, statistics[key] = video.add(episode)
            row |= {f"videos/{key}/{name}": value for name, value in place.items()}
        row |= flattened(statistics)
        entry = episode.entry  # the origin of the episode, an addition to the format
        row |= {"prag_asp/part": entry.part, "prag_asp/task": entry.number, "prag_asp/start": episode.start}
        self._rows.add_row({**row, "prag_asp/rank": str(entry.rank), "prag_asp/plan": episode.plan})
        for name, each in statistics.items():
            self._statistics.setdefault(name, Aggregate()).add(each)
        begin, _ = self._splits.get(episode.entry.part, (self.episodes, 0))
        self.episodes, self._frames = self.episodes + 1, self._frames + episode.length
        self._splits[episode.entry.part] = begin, self.episodes

    def finish(self) -> None:
        """Write the metadata of all episodes, and the card."""
        self.close()
        meta = make_folder(self._folder / "meta")
        write_table(meta / "tasks.parquet", texts_table("task", self._tasks))
        write_table(meta / "subtasks.parquet", texts_table("subtask", self._subtasks))
        _write_json(meta / "info.json", self._info())
        statistics = {name: as_lists(each.statistics()) for name, each in self._statistics.items()}
        _write_json(meta / "stats.json", statistics)
        card = CARD.format(
            name=self._source.data.domain.name, version=VERSION, episodes=plural(self.episodes, "episode")
        )
        replace_file(self._folder / "README.md", card.encode())

    def close(self) -> None:
        """Close all files."""
        self._data.close()
        self._rows.close()
        for video in self._videos.values():
            video.close()

    def _values(self, episode: ExportEpisode) -> dict[str, NDArray[Any]]:
        """Return the values of each feature in each frame of an episode."""
        length = episode.length
        frame = np.arange(length)
        task = self._tasks.setdefault(episode.instruction, len(self._tasks))
        subtasks = [self._subtasks.setdefault(text, len(self._subtasks)) for text in episode.subgoals]
        values = {
            "observation.state": self._source.states_of(episode, self._form.state),
            "action": self._source.actions_of(episode),
            "subtask_index": np.array(subtasks)[episode.subgoal],
            "subgoal_index": episode.subgoal,
            "next.reward": episode.rewards,
            "next.done": frame == length - 1,
            "timestamp": (frame / self._source.rate).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(length, self.episodes),
            "index": frame + self._frames,
            "task_index": np.full(length, task),
        }
        if self._form.has_objects(self._source):
            values["observation.environment_state"] = self._source.bodies_of(episode)
        if self._form.depth:
            for camera, video in episode.videos.items():
                values[DEPTH + camera] = np.round(1000 * video.depth.astype(np.float32)).astype(np.uint16)
        return values

    def _info(self) -> dict[str, Any]:
        source, form = self._source, self._form
        return {
            "codebase_version": VERSION,
            "robot_type": "+".join(mount.kind for mount in source.scene.robots.values()),
            "total_episodes": self.episodes,
            "total_frames": self._frames,
            "total_tasks": len(self._tasks),
            "chunks_size": CHUNK,
            "data_files_size_in_mb": form.data_megabytes,
            "video_files_size_in_mb": form.video_megabytes,
            "fps": source.rate,
            "splits": {name: f"{begin}:{end}" for name, (begin, end) in self._splits.items()},
            "data_path": DATA,
            "video_path": VIDEOS if self._videos else None,
            "features": self._features,
        }


class _VideoFeature:
    """A writer of the videos of one camera."""

    def __init__(self, form: LeRobot, source: EpisodeSource, folder: Path, camera: str) -> None:
        self._form, self._source, self._folder, self._camera = form, source, folder, camera
        self._places = places()
        self._place = next(self._places)
        self._video: Video | None = None

    def add(self, episode: ExportEpisode) -> tuple[dict[str, Any], Statistics]:
        """Add the video of an episode, and return its location in the files and the statistics of its colours."""
        if self._video is not None and self._video.size >= self._form.video_megabytes * MEGABYTE:
            self.close()
            self._place = next(self._places)
        if self._video is None:
            name = VIDEOS.format(
                video_key=f"observation.images.{self._camera}", chunk_index=self._place[0], file_index=self._place[1]
            )
            self._video = Video(self._folder / name, self._source.cameras[self._camera], self._source.rate)
        colours, begin = Colours(), self._video.seconds
        for number, picture in enumerate(episode.videos[self._camera].packed[0].rows()):
            colours.add(picture)
            self._video.add(picture, key=number == 0)  # viewers open an episode without the episodes before it
        place = {
            "chunk_index": self._place[0],
            "file_index": self._place[1],
            "from_timestamp": begin,
            "to_timestamp": self._video.seconds,
        }
        return place, colours.statistics()

    def close(self) -> None:
        """Close the current video."""
        if self._video is not None:
            video, self._video = self._video, None
            video.close()


def _features(form: LeRobot, source: EpisodeSource) -> dict[str, Any]:
    """Return the features as info.json describes them; LeRobot ignores the additional key `prag_asp`."""
    control = source.control
    action = {
        "control": control.name,
        "rate": control.rate,
        "units": list(control.units),
        "lower": control.lower.tolist(),
        "upper": control.upper.tolist(),
    }
    vectors = {
        "observation.state": state_names(form.state, source.scene),
        "action": list(control.names),
        **({"observation.environment_state": source.body_names} if form.has_objects(source) else {}),
    }
    kinds = {
        **dict.fromkeys(("subtask_index", "subgoal_index"), "int64"),
        "next.reward": "float32",
        "next.done": "bool",
        "timestamp": "float32",
        **dict.fromkeys(("frame_index", "episode_index", "index", "task_index"), "int64"),
    }
    features: dict[str, Any] = {
        name: {"dtype": "float32", "shape": [len(names)], "names": names} for name, names in vectors.items()
    }
    features["action"]["prag_asp"] = action
    features["observation.state"]["prag_asp"] = {"states": list(form.state)}
    features |= {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in kinds.items()}
    for name, (width, height) in source.cameras.items():
        features[f"observation.images.{name}"] = {
            "dtype": "video",
            "shape": [height, width, 3],
            "names": ["height", "width", "channels"],
            "info": video_info((width, height), source.rate),
        }
        if form.depth:
            shape = {"shape": [height, width], "names": ["height", "width"]}
            features[DEPTH + name] = {"dtype": "uint16", **shape, "prag_asp": {"unit": "mm"}}
    return features


def has_statistics(name: str) -> bool:
    """Return whether a feature has statistics; depth images have none, because they would be as large as an image."""
    return not name.startswith(DEPTH)


def _column(feature: Mapping[str, Any]) -> pa.DataType:
    """Return the type of the column for a feature."""
    kind, shape = pa.type_for_alias(feature["dtype"]), feature["shape"]
    if feature["names"] is None:
        return kind
    return pa.list_(kind, shape[0]) if len(shape) == 1 else pa.list_(pa.list_(kind))


def _nested(values: NDArray[Any], kind: pa.DataType) -> pa.Array:
    """Return the column for an array of N values, lists or images."""
    if values.ndim == 1:
        return pa.array(values, kind)
    if values.ndim == 2:
        return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel(), kind.value_type), values.shape[1])
    count, height, width = values.shape
    rows = pa.ListArray.from_arrays(np.arange(0, values.size + 1, width, dtype=np.int32), pa.array(values.ravel()))
    return pa.ListArray.from_arrays(np.arange(0, count * height + 1, height, dtype=np.int32), rows)


def _episode_schema(features: Mapping[str, Any]) -> pa.Schema:
    """Return the schema of the table of episodes."""
    numbers, texts = ("episode_index", "length", "dataset_from_index", "dataset_to_index"), pa.list_(pa.string())
    columns = [("tasks", texts), *((name, pa.int64()) for name in numbers)]
    columns += [
        (f"{room}/{each}_index", pa.int64()) for room in ("data", "meta/episodes") for each in ("chunk", "file")
    ]
    for name, feature in features.items():
        if not has_statistics(name):
            continue
        value = pa.list_(pa.float64())
        if feature["dtype"] == "video":
            columns += [(f"videos/{name}/{each}_index", pa.int64()) for each in ("chunk", "file")]
            columns += [(f"videos/{name}/{each}_timestamp", pa.float64()) for each in ("from", "to")]
            value = pa.list_(pa.list_(value))
        columns += [(f"stats/{name}/{each}", pa.list_(pa.int64()) if each == "count" else value) for each in NAMES]
    columns += [(f"prag_asp/{name}", pa.int64()) for name in ("task", "start")]
    columns += [(f"prag_asp/{name}", pa.string()) for name in ("part", "rank")]
    return pa.schema([*columns, ("prag_asp/plan", texts)])


def _write_json(path: Path, value: Any) -> None:
    replace_file(path, f"{json.dumps(value, indent=4, ensure_ascii=False)}\n".encode())
