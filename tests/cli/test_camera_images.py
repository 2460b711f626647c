"""The options of cameras, and of what varies, of the commands that demonstrate."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from prag_asp import QueryError, TaskSpace, load_domain, load_scene
from prag_asp.dataset import feasible, read_tasks, recheck
from prag_asp.physics import Demonstration, Staging, Witness, check_demonstration, demonstrate
from tests.commands import ok, run

SAMPLE = ("sample", "tabletop", "--length", "1", "--count", "1", "--seed", "3")
FILMED = ("--cameras", "front,wrist", "--size", "32x24", "--rate", "4", "--vary", "friction,mass,colour")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a task that was demonstrated and filmed in a world that varies."""
    here = tmp_path_factory.mktemp("filmed")
    ok(*SAMPLE, *FILMED, "--demonstrate", "shown", "--format", "jsonl", "-o", "shown.jsonl", cwd=here)
    return here


def test_a_recording_has_the_films_that_were_asked_for_and_what_was_drawn(folder):
    shown = Demonstration.load(folder / "shown" / "000001.npz")
    assert shown.footage is not None and shown.variation is not None
    assert list(shown.footage.videos) == ["front", "wrist"]
    assert shown.footage.videos["wrist"].rgb.shape[1:] == (24, 32, 3)
    assert (shown.footage.frames == range(0, len(shown.times), 5)).all()
    assert shown.variation.friction and shown.variation.mass and shown.variation.colours
    assert not shown.variation.cameras and shown.variation.light is None


def test_a_recording_is_judged_and_repeated_in_the_world_that_was_drawn_for_it(folder):
    shown, scene = Demonstration.load(folder / "shown" / "000001.npz"), load_scene(load_domain("tabletop"))
    (record,) = read_tasks(folder / "shown.jsonl")
    assert check_demonstration(record.task, shown, scene) == []
    witness = Witness.from_json(record.witness)
    again = demonstrate(record.task, witness, scene, shown.variation)
    assert again == replace(shown, footage=None)
    assert demonstrate(record.task, witness, scene) != replace(again, variation=None)


def test_a_world_in_which_nothing_can_be_held_is_judged_so(folder):
    scene = load_scene(load_domain("tabletop"))
    (record,) = read_tasks(folder / "shown.jsonl")
    shown = Demonstration.load(folder / "shown" / "000001.npz")
    slippery = replace(shown.variation, friction=dict.fromkeys(shown.variation.friction, 0.01))
    failed = demonstrate(record.task, Witness.from_json(record.witness), scene, slippery)
    assert not failed.success and failed.variation == slippery


def test_tasks_of_a_file_are_filmed_too_by_their_witnesses(folder):
    how = ("--cameras", "front", "--size", "16x16", "--rate", "1", "--vary", "mass", "--demonstrate", "again")
    ok("validate", "shown.jsonl", "--witness-only", *how, cwd=folder)
    again = Demonstration.load(folder / "again" / "000001.npz")
    assert list(again.footage.videos) == ["front"] and again.variation.mass and not again.variation.friction


def test_an_unknown_camera_is_told_before_tasks_of_a_file_are_filmed(folder):
    done = run("validate", "shown.jsonl", "--cameras", "side", "--demonstrate", "never", cwd=folder)
    assert done.returncode == 2 and done.stderr.startswith("the scene has no camera side; ")
    assert not (folder / "never").exists()
    done = run("validate", "shown.jsonl", "--cameras", "front", cwd=folder)
    assert done.returncode == 2 and "add --demonstrate" in done.stderr


def test_in_python_cameras_without_demonstrations_are_refused_at_once():
    space = TaskSpace(load_domain("tabletop"), 1)
    with pytest.raises(QueryError, match="cameras record demonstrations; request them with `demonstrate`"):
        feasible(space, staging=Staging(("front",)))
    with pytest.raises(QueryError, match="mass varies in demonstrations"):
        next(recheck([], staging=Staging(vary=("mass",))))


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--cameras", "frnt", "--demonstrate", "new"), "the scene has no camera frnt; did you mean front?"),
        (("--cameras", "front"), "--cameras front is for demonstrations; add --demonstrate"),
        (("--vary", "mass"), "--vary mass is for demonstrations; add --demonstrate"),
        (("--size", "64x64", "--demonstrate", "new"), "--size 64x64 is for --cameras; name some"),
        (("--rate", "5", "--demonstrate", "new"), "--rate 5 is for --cameras; name some"),
        (("--cameras", "front", "--size", "64", "--demonstrate", "new"), "--size 64: write WIDTHxHEIGHT in pixels"),
        (("--cameras", "front", "--size", f"{'9' * 30}x1", "--demonstrate", "new"), "write WIDTHxHEIGHT in pixels"),
        (("--cameras", "front", "--size", "4x4", "--demonstrate", "new"), "16 to 2048 pixels a side; got 4x4"),
        (("--cameras", "front", "--rate", "7", "--demonstrate", "new"), "record at 1, 2, 4, 5, 10, 20; got 7"),
        (("--cameras", "front,,wrist", "--demonstrate", "new"), "--cameras front,,wrist: write names with commas"),
        (("--cameras", "", "--demonstrate", "new"), "write names with commas"),
        (("--vary", "colr", "--demonstrate", "new"), "colr cannot vary; did you mean colour?"),
    ],
)
def test_what_cannot_be_filmed_is_told_in_a_line_before_anything_is_made(tmp_path, options, told):
    done = run(*SAMPLE, *options, "-o", "out.jsonl", cwd=tmp_path)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert told in line
    assert list(tmp_path.iterdir()) == []
