"""Witnesses and episodes in files: read as they were written, and refused with the place of what is wrong."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prag_asp import load_domain, load_scene
from prag_asp.dataset.jsonl import Record, read_lines
from prag_asp.dataset.task_origin import read_witness
from prag_asp.errors import QueryError
from prag_asp.physics import Demonstration, Witness, check_demonstration, check_witness
from prag_asp.scene.scene import Scene

FOLDER = Path(__file__).parent / "episodes"
FILES = ("one_robot", "two_robots")
ROBOTS = {"one_robot": ("panda",), "two_robots": ("left", "right")}


def records(name: str) -> list[tuple[Record, Scene]]:
    """Return the tasks of a file, each with the scene of its domain; the first is performed in an episode."""
    lines = (FOLDER / f"{name}.jsonl").read_text().splitlines()
    return [(each, load_scene(load_domain(each.task.domain))) for each in read_lines(lines, name)]


@pytest.mark.parametrize("name", FILES)
def test_a_witness_in_a_file_passes_its_check_and_is_written_as_it_was(name: str) -> None:
    held = set()
    for record, scene in records(name):
        witness = read_witness(record, scene)
        assert check_witness(record.task, witness, scene) == []
        assert all(sorted(moment.arms) == sorted(ROBOTS[name]) for moment in witness.moments)
        held |= {thing for moment in witness.moments for thing in moment.held}
        written = json.loads(json.dumps(witness.to_json()))
        assert written["version"] == 2 and written == record.witness
        assert all(waypoint["robot"] in ROBOTS[name] for motion in written["motions"] for waypoint in motion)
    assert held


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"moments": [3]}, "witness.moments[0]: needs an object with fields; got 3"),
        ({"moments": [{"poses": {}}]}, "witness.moments[0].arms: is missing"),
        (
            {"moments": [{"poses": {}, "arms": {"panda": {"joints": [0] * 6, "width": 0}}}]},
            "witness.moments[0].arms.panda.joints: needs a list of 7; got [0, 0, 0, 0, 0, 0]",
        ),
        ({"motions": [[{"name": 1}]]}, "witness.motions[0][0].name: needs a string; got 1"),
        ({"sizes": {"a": [1, 2, 3], "b": [1, 2]}}, "witness.sizes.b: needs a list of 3; got [1, 2]"),
        ({"version": "2"}, "witness.version: needs 2; got '2'"),
        ({"version": 1}, "witness.version: needs 2; got 1"),
    ],
)
def test_what_is_wrong_in_a_witness_is_named_by_its_path(change: dict[str, Any], message: str) -> None:
    record, _ = records("one_robot")[0]
    with pytest.raises(QueryError) as caught:
        Witness.from_json({**(record.witness or {}), **change})
    assert str(caught.value) == message


def test_a_witness_without_a_version_is_refused() -> None:
    with pytest.raises(QueryError, match=r"^witness\.version: is missing$"):
        Witness.from_json({"moments": [], "motions": []})


@pytest.mark.parametrize("number", [float("nan"), float("inf"), pytest.param(10**400, id="huge"), True, "1"])
@pytest.mark.parametrize(
    "path", [("poses", "cube_1", 0, 2), ("arms", "panda", "grasp", 1, 3), ("arms", "panda", "joints", 4)]
)
def test_what_is_no_finite_number_is_refused(number: object, path: tuple[str | int, ...]) -> None:
    (record, _), *_ = records("one_robot")
    assert record.witness is not None
    k = next(k for k, moment in enumerate(record.witness["moments"]) if moment["arms"]["panda"]["grasp"])
    data = json.loads(json.dumps(record.witness))
    value = data["moments"][k]
    for step in path[:-1]:
        value = value[step]
    value[path[-1]] = number
    where = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)
    with pytest.raises(QueryError) as caught:
        Witness.from_json(data)
    assert str(caught.value).startswith(f"witness.moments[{k}]{where}: needs a finite number")


@pytest.mark.parametrize("name", FILES)
def test_an_episode_in_a_file_shows_its_task_and_is_written_as_it_was(name: str, tmp_path: Path) -> None:
    record, scene = records(name)[0]
    shown = Demonstration.load(FOLDER / f"{name}.npz")
    # One was recorded when joints were allowed to accelerate more.
    faults = check_demonstration(record.task, shown, scene)
    assert all("accelerates" in fault for fault in faults) and len(faults) == (name == "one_robot")
    robots, frames = len(ROBOTS[name]), len(shown.times)
    assert shown.robots == ROBOTS[name]
    assert (shown.joints.shape, shown.widths.shape) == ((frames, robots, 7), (frames, robots))
    assert shown.commands.shape == (frames, robots, 8)
    assert shown.bodies[:3] == tuple(f"{part} of {ROBOTS[name][0]}" for part in ("arm", "left finger", "right finger"))
    shown.save(tmp_path / "new.npz")
    assert Demonstration.load(tmp_path / "new.npz") == shown


def test_an_episode_of_another_version_or_without_an_axis_is_refused(tmp_path: Path) -> None:
    with np.load(FOLDER / "one_robot.npz") as content:
        whole = dict(content)
    unversioned = {name: array for name, array in whole.items() if name != "version"}
    for arrays, message in (
        ({**whole, "version": np.array(3)}, "of the version 3; this program reads 2"),
        ({**whole, "version": np.array([2])}, r"of the version \[2\]; this program reads 2"),
        ({**whole, "joints": whole["joints"][:, 0]}, r"joints has the shape \(\d+, 7\) in place of \(\d+, 1, 7\)"),
        (unversioned, "it has no version"),
    ):
        np.savez(tmp_path / "it.npz", **arrays)
        with pytest.raises(QueryError, match=message):
            Demonstration.load(tmp_path / "it.npz")
