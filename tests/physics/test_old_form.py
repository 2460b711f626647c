"""Files of the form before, in which a single robot had no name, say what they said; what is written has a version."""

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
from prag_asp.scene.scene import Mount, Scene

FOLDER = Path(__file__).parent / "old_form"
FILES = ("one_robot", "two_robots")
ROBOTS = {"one_robot": ("panda",), "two_robots": ("left", "right")}


def records(name: str) -> list[tuple[Record, Scene]]:
    """Return the tasks of a file, each with the scene of its domain; the first is performed in a recording."""
    lines = (FOLDER / f"{name}.jsonl").read_text().splitlines()
    return [(each, load_scene(load_domain(each.task.domain))) for each in read_lines(lines, name)]


@pytest.mark.parametrize("name", FILES)
def test_a_witness_of_the_form_before_passes_its_check_and_is_written_in_that_of_today(name: str) -> None:
    held = set()
    for record, scene in records(name):
        witness = read_witness(record, scene)
        assert check_witness(record.task, witness, scene) == []
        assert all(sorted(moment.arms) == sorted(ROBOTS[name]) for moment in witness.moments)
        held |= {thing for moment in witness.moments for thing in moment.held}
        written = json.loads(json.dumps(witness.to_json()))
        assert written["version"] == 2 and Witness.from_json(written) == witness
        assert all(set(moment) <= {"poses", "arms", "openings"} for moment in written["moments"])
        assert all(waypoint["robot"] in ROBOTS[name] for motion in written["motions"] for waypoint in motion)
    assert held


def test_all_that_a_witness_of_the_form_before_says_is_read() -> None:
    (record, _), *_ = records("two_robots")
    assert record.witness is not None
    before = record.witness["moments"][1]
    arm, robot = Witness.from_json(record.witness).moments[1].arms[before["robot"]], before["robot"]
    assert (list(arm.joints), arm.width, arm.held) == (before["joints"], before["width"], before["held"])
    [(other, told)] = before["others"].items()
    assert {robot, other} == {"left", "right"}
    assert list(Witness.from_json(record.witness).moments[1].arms[other].joints) == told["joints"]
    *_, (kitchen, scene) = records("one_robot")
    assert kitchen.witness is not None
    openings = [moment["openings"] for moment in kitchen.witness["moments"]]
    assert [moment.openings for moment in read_witness(kitchen, scene).moments] == openings


def test_a_single_robot_gets_the_name_that_the_scene_has_for_it() -> None:
    record, scene = records("one_robot")[0]
    called = Scene(scene.shapes, robots={"arm_7": Mount("panda")})
    assert list(read_witness(record, called).moments[0].arms) == ["arm_7"]
    assert read_witness(record, called).motions[0][0].robot == "arm_7"
    assert Demonstration.load(FOLDER / "one_robot.npz", robot="arm_7").robots == ("arm_7",)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"moments": [3]}, "witness.moments[0]: needs an object with fields; got 3"),
        ({"moments": [{"poses": {}}]}, "witness.moments[0].joints: is missing"),
        ({"motions": [[{"name": 1}]]}, "witness.motions[0][0].name: needs a string; got 1"),
        ({"sizes": {"a": [1, 2, 3], "b": [1, 2]}}, "witness.sizes.b: needs a list of 3; got [1, 2]"),
        ({"version": "2"}, "witness.version: needs 2; got '2'"),
        ({"version": 2}, "witness.moments[0].arms: is missing"),
    ],
)
def test_what_is_wrong_in_a_witness_of_the_form_before_is_named_where_it_stands(
    change: dict[str, Any], message: str
) -> None:
    record, _ = records("one_robot")[0]
    with pytest.raises(QueryError) as caught:
        Witness.from_json({**(record.witness or {}), **change})
    assert str(caught.value) == message


@pytest.mark.parametrize("number", [float("nan"), float("inf"), pytest.param(10**400, id="huge"), True, "1"])
def test_what_is_no_finite_number_is_refused_in_both_forms(number: object) -> None:
    (record, scene), *_ = records("one_robot")
    for data in (json.loads(json.dumps(record.witness)), read_witness(record, scene).to_json()):
        data["moments"][0]["poses"]["cube_1"][0][2] = number
        with pytest.raises(QueryError, match=r"^witness\.moments\[0\]\.poses\.cube_1\[0\]\[2\]: needs a finite number"):
            Witness.from_json(data)


@pytest.mark.parametrize("name", FILES)
def test_a_recording_of_the_form_before_shows_its_task_and_is_written_in_that_of_today(
    name: str, tmp_path: Path
) -> None:
    record, scene = records(name)[0]
    shown = Demonstration.load(FOLDER / f"{name}.npz")
    assert check_demonstration(record.task, shown, scene) == []
    robots, frames = len(ROBOTS[name]), len(shown.times)
    assert shown.robots == ROBOTS[name]
    assert (shown.joints.shape, shown.widths.shape) == ((frames, robots, 7), (frames, robots))
    assert shown.commands.shape == (frames, robots, 8)
    assert shown.bodies[:3] == tuple(f"{part} of {ROBOTS[name][0]}" for part in ("arm", "left finger", "right finger"))
    shown.save(tmp_path / "new.npz")
    assert Demonstration.load(tmp_path / "new.npz", robot="nobody") == shown
    with np.load(FOLDER / f"{name}.npz") as before, np.load(tmp_path / "new.npz") as today:
        assert today["version"] == 2 and today["robots"].tolist() == list(ROBOTS[name])
        for each in set(before.files) - {"bodies"}:
            assert np.array_equal(today[each].ravel(), before[each].ravel()), each


def test_a_recording_of_another_version_or_without_an_axis_is_refused(tmp_path: Path) -> None:
    shown = Demonstration.load(FOLDER / "one_robot.npz")
    shown.save(tmp_path / "it.npz")
    with np.load(tmp_path / "it.npz") as content:
        whole = dict(content)
    for change, message in (
        ({"version": np.array(3)}, "a recording of the version 3; this program reads 2"),
        ({"version": np.array([2])}, r"a recording of the version \[2\]; this program reads 2"),
        ({"joints": whole["joints"][:, 0]}, r"joints has the shape \(\d+, 7\) in place of \(\d+, 1, 7\)"),
    ):
        np.savez(tmp_path / "it.npz", **{**whole, **change})
        with pytest.raises(QueryError, match=message):
            Demonstration.load(tmp_path / "it.npz")
