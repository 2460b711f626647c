"""Rerun's own reader finds the recorded bodies, contacts, subgoals, joints and images in the exported files."""

from __future__ import annotations

import json
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from prag_asp import Dataset, OutputError
from prag_asp.dataset import export
from tests.commands import ok, run
from tests.output.faults import Disk

chunks = pytest.importorskip("rerun.chunk", exc_type=ImportError)


class RerunFile:
    """The rows of a recording by entity and component."""

    def __init__(self, path: Path) -> None:
        reader = chunks.RrdReader(path)
        (self.store,) = reader.recordings()
        self.blueprints = reader.blueprints()
        self.batches: dict[str, list[Any]] = {}
        for chunk in reader.stream().to_chunks():
            self.batches.setdefault(chunk.entity_path, []).append(chunk.to_record_batch())

    def column(self, entity: str, component: str) -> list[Any]:
        """Return the values of a component in all rows of an entity, in the order of time."""
        rows: list[tuple[float, Any]] = []
        for batch in self.batches[entity]:
            names = batch.schema.names
            found = [name for name in names if name.endswith(f":{component}")]
            if found:
                times = batch.column("time").to_pylist() if "time" in names else [None] * batch.num_rows
                seconds = [0.0 if time is None else time.total_seconds() for time in times]
                rows += zip(seconds, batch.column(found[0]).to_pylist(), strict=True)
        return [value for _, value in sorted(rows, key=lambda row: row[0])]

    def times(self, entity: str) -> np.ndarray:
        """Return the times of the rows of an entity in seconds."""
        batches = [batch for batch in self.batches[entity] if "time" in batch.schema.names]
        return np.sort([time.total_seconds() for batch in batches for time in batch.column("time").to_pylist()])


@pytest.fixture(scope="module")
def folder(filmed: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(filmed, "rerun", tmp_path_factory.mktemp("rerun") / "out")


@pytest.fixture(scope="module")
def file(folder: Path) -> RerunFile:
    return RerunFile(folder / "train-000000-0.rrd")


def test_there_is_a_file_for_each_episode(folder: Path, file: RerunFile) -> None:
    names = {path.name for path in folder.iterdir()}
    assert names == {"export.json", "train-000000-0.rrd", "test-000000-0.rrd"}
    assert json.loads((folder / "export.json").read_text())["form"] == "rerun"
    assert file.store.application_id == "prag_asp" and len(file.blueprints) == 1


def test_bodies_joints_and_contacts_are_those_of_the_recording(filmed: Dataset, file: RerunFile) -> None:
    entry, _, shown = next(filmed.part("train").demonstrations())
    for i, entity in enumerate(shown.objects):
        path = f"/world/{entity}"
        positions = np.array(file.column(path, "translation"), np.float32).reshape(-1, 3)
        turns = np.array(file.column(path, "quaternion"), np.float32).reshape(-1, 4)
        assert (positions == shown.poses[:, i, :3]).all() and (turns == shown.poses[:, i, 3:]).all()
        assert len(positions) in (1, len(shown.times))
    assert np.allclose(file.times("/world/panda/panda_hand"), shown.times, atol=1e-6)
    for joint in range(7):
        angles = np.array(file.column(f"/robots/panda/joint_{joint + 1}", "scalars")).ravel()
        assert (angles == shown.joints[:, 0, joint]).all()
    assert (np.array(file.column("/robots/panda/gripper", "scalars")).ravel() == shown.widths[:, 0]).all()
    held = entry.task.actions[0].arguments[1]
    forces = np.array(file.column(rf"/contacts/{held}/left\ finger\ of\ panda", "scalars")).ravel()
    expected = np.zeros(len(shown.times))
    for (frame, one, two), force in zip(shown.contacts.tolist(), shown.forces.tolist(), strict=True):
        if {shown.bodies[one], shown.bodies[two]} == {held, "left finger of panda"}:
            expected[frame] = max(expected[frame], force)
    assert expected.max() > 1.0 and np.allclose(forces, expected)


def test_subgoals_stand_where_their_actions_begin(filmed: Dataset, file: RerunFile) -> None:
    entry, _, shown = next(filmed.part("train").demonstrations())
    texts = [text for (text,) in file.column("/subgoal", "text")]
    actions = list(map(str, entry.task.actions))
    assert [text.partition("[")[2].rstrip("]") for text in texts] == [*actions, ""]
    assert texts[0].startswith(f"1. {entry.subgoals[0]}") and texts[-1] == "The task is done."
    assert np.allclose(file.times("/subgoal"), shown.times[shown.ends], atol=1e-6)
    assert file.column("/instruction", "text") == [[entry.instruction["default"]]]


def test_images_are_those_of_the_cameras(filmed: Dataset, file: RerunFile) -> None:
    _, _, shown = next(filmed.part("train").demonstrations())
    for camera, video in shown.footage.videos.items():
        images = file.column(f"/world/cameras/{camera}/rgb", "blob")
        assert len(images) == len(video.rgb)
        for (blob,), rgb in zip(images, video.rgb, strict=True):
            with Image.open(BytesIO(bytes(blob))) as image:
                assert (np.asarray(image) == rgb).all()
        assert np.allclose(file.times(f"/world/cameras/{camera}/depth"), shown.times[shown.footage.frames], atol=1e-6)
        places = np.array(file.column(f"/world/cameras/{camera}", "translation"), np.float32).reshape(-1, 3)
        assert (places == video.extrinsics[:, :3, 3]).all()


def test_two_robots_without_cameras_are_exported_by_the_command(arms: Dataset, tmp_path: Path) -> None:
    assert ok("export", "rerun", str(arms.folder), "-o", "out", cwd=tmp_path) == "out\n"
    files = sorted(path.name for path in (tmp_path / "out").glob("*.rrd"))
    assert files == ["train-000000-0.rrd", "train-000000-1.rrd"]
    file = RerunFile(tmp_path / "out" / files[0])
    assert {"/robots/left/joint_1", "/robots/right/joint_1", "/world/left_side"} <= file.batches.keys()
    assert "rerun" in ok("export", "--help").split()


def test_a_full_disk_leaves_nothing_and_a_missing_package_is_told(
    arms: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Disk(2, 10**6).working(), pytest.raises(OutputError, match=r"cannot be (written|made): No space"):
        export(arms, "rerun", tmp_path / "out")
    assert not (tmp_path / "out").exists()
    monkeypatch.setitem(sys.modules, "rerun", None)
    done = run("export", "rerun", str(arms.folder), "-o", str(tmp_path / "out"))
    told = 'the format rerun needs rerun; install it: pip install "prag_asp[rerun]"\n'
    assert (done.returncode, done.stderr) == (2, told)
