"""A reader of LeRobotDataset v3.0, from what is published of its layout; it shares nothing with what writes it.

https://huggingface.co/docs/lerobot/lerobot-dataset-v3 and https://huggingface.co/docs/lerobot/dataset_subtask.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas as pd

USUAL = ("timestamp", "frame_index", "episode_index", "index", "task_index")
TOLERANCE = 1e-4
"""Seconds by which a picture may be early or late, as LeRobot has it."""


class Published:
    """A dataset in a folder."""

    def __init__(self, folder: Path) -> None:
        import pandas as pd  # takes long, and each process imports all tests

        self.folder = folder
        self.info: dict[str, Any] = json.loads((folder / "meta/info.json").read_text())
        self.statistics: dict[str, Any] = json.loads((folder / "meta/stats.json").read_text())
        assert self.info["codebase_version"] == "v3.0"
        self.tasks = pd.read_parquet(folder / "meta/tasks.parquet")
        self.subtasks = pd.read_parquet(folder / "meta/subtasks.parquet")
        self.episodes = pd.concat(map(pd.read_parquet, sorted(folder.glob("meta/episodes/*/*.parquet"))))
        self.cameras = [name for name, each in self.info["features"].items() if each["dtype"] == "video"]
        assert {*USUAL} <= {*self.info["features"]}

    def frames(self, number: int) -> pd.DataFrame:
        """Return the rows of an episode, whose types and shapes are those of the features."""
        import pandas as pd

        episode = self.episodes.iloc[number]
        path = self.info["data_path"].format(
            chunk_index=episode["data/chunk_index"], file_index=episode["data/file_index"]
        )
        rows = pd.read_parquet(self.folder / path)
        rows = rows[rows["episode_index"] == number]
        assert [*rows["index"]] == [*range(episode["dataset_from_index"], episode["dataset_to_index"])]
        assert {*rows.columns} == {*self.info["features"]} - {*self.cameras}
        for name in rows.columns:
            feature = self.info["features"][name]
            values = np.stack(rows[name].to_numpy())
            assert values.dtype == feature["dtype"], name
            assert [*values.shape[1:]] in (feature["shape"], []), name
            assert feature["names"] is None or len(feature["names"]) == values.shape[1]
        return rows

    def pictures(self, number: int, camera: str) -> Iterator[NDArray[np.uint8]]:
        """Yield the picture of each frame of an episode, found by its time."""
        episode, rows = self.episodes.iloc[number], self.frames(number)
        path = self.info["video_path"].format(
            video_key=camera,
            chunk_index=episode[f"videos/{camera}/chunk_index"],
            file_index=episode[f"videos/{camera}/file_index"],
        )
        begin, end = (episode[f"videos/{camera}/{side}_timestamp"] for side in ("from", "to"))
        import av

        with av.open(str(self.folder / path)) as file:
            assert file.streams.video[0].codec_context.name in ("libdav1d", "av1", "libaom-av1")
            shown = {float(frame.time or 0): frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)}
        for time in rows["timestamp"]:
            nearest = min(shown, key=lambda each: abs(each - begin - time))
            assert abs(nearest - begin - time) < TOLERANCE and begin - TOLERANCE <= nearest < end
            yield shown[nearest]
