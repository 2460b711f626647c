"""Pictures of tasks from a file: strips, single states and animations."""

from __future__ import annotations

import json
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

from tests.commands import ok, run


@pytest.fixture(scope="module")
def tasks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two feasible tasks of three actions; the second has lost its witness."""
    file = tmp_path_factory.mktemp("tasks") / "tasks.jsonl"
    lines = ok("sample", "tabletop", "-n", "3", "--count", "2", "--seed", "7", "--format", "jsonl").splitlines()
    second = json.loads(lines[1])
    file.write_text(f"{lines[0]}\n{json.dumps({**second, 'witness': None})}\n")
    return file


def pixels(path: Path) -> np.ndarray:
    """Return the colours of a picture, shape (height, width, 3)."""
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def frames(path: Path) -> int:
    """Return how many frames an animation has."""
    with Image.open(path) as image:
        return image.n_frames


def test_every_task_of_a_file_gets_a_strip_of_all_its_states(tasks: Path, tmp_path: Path) -> None:
    assert ok("render", str(tasks), "--size", "90x80", "--columns", "4", cwd=tmp_path).splitlines() == [
        "pictures/000001.png",
        "pictures/000002.png",
    ]
    for name in ("000001.png", "000002.png"):
        strip = pixels(tmp_path / "pictures" / name)
        shown = [strip[14:94, 14 + i * 102 : 104 + i * 102] for i in range(4)]
        assert strip.shape[1] == 4 * 102 - 12 + 28
        assert all(frame.std() > 15 for frame in shown)
        assert np.abs(shown[0].astype(int) - shown[3]).mean() > 1


def test_strips_break_into_even_rows(tasks: Path, tmp_path: Path) -> None:
    ok("render", str(tasks), "1", "--size", "90x80", "--columns", "3", "-o", "strip.png", cwd=tmp_path)
    height, width, _ = pixels(tmp_path / "strip.png").shape
    assert width == 2 * 102 - 12 + 28
    assert height > 2 * 80


def test_one_state_is_drawn_without_words(tasks: Path, tmp_path: Path) -> None:
    options = ("render", str(tasks), "1", "--as", "state", "--size", "96x64")
    ok(*options, "-o", "last.png", cwd=tmp_path)
    ok(*options, "--state", "3", "-o", "third.png", cwd=tmp_path)
    ok(*options, "--state", "0", "-o", "first.png", cwd=tmp_path)
    assert (tmp_path / "last.png").read_bytes() == (tmp_path / "third.png").read_bytes()
    assert (tmp_path / "last.png").read_bytes() != (tmp_path / "first.png").read_bytes()
    assert pixels(tmp_path / "last.png").shape == (64, 96, 3)


def test_an_animation_plays_the_demonstration_at_a_speed(tasks: Path, tmp_path: Path) -> None:
    ok("render", str(tasks), "1", "--as", "webp", "--size", "32x32", "--speed", "8", "-o", "fast.webp", cwd=tmp_path)
    ok("render", str(tasks), "1", "--as", "gif", "--size", "32x32", "--speed", "16", "-o", "faster.gif", cwd=tmp_path)
    fast = frames(tmp_path / "fast.webp")
    assert fast >= 8
    assert frames(tmp_path / "faster.gif") == pytest.approx(fast / 2, abs=2)
    ok("render", str(tasks), "1", "--as", "mp4", "--size", "32x32", "--speed", "8", "-o", "fast.mp4", cwd=tmp_path)
    with av.open(str(tmp_path / "fast.mp4")) as video:
        (stream,) = video.streams.video
        assert (stream.codec_context.name, stream.average_rate) == ("h264", 10)
        assert len(list(video.decode(stream))) == pytest.approx(fast + 14, abs=2), "the last frame stays for 1.5 s"


def test_recordings_are_drawn_as_they_were_performed(tmp_path: Path) -> None:
    sampled = ("sample", "tabletop", "-n", "1", "--count", "1", "--demonstrate", "recorded", "--format", "jsonl")
    ok(*sampled, "-o", "tasks.jsonl", cwd=tmp_path)
    shared = ("render", "tasks.jsonl", "--as", "state", "--size", "64x64", "--recordings")
    ok(*shared, "recorded", "-o", "shown.png", cwd=tmp_path)
    assert pixels(tmp_path / "shown.png").shape == (64, 64, 3)
    ok(*sampled, "--seed", "5", "-o", "others.jsonl", "--demonstrate", "others", cwd=tmp_path)
    for folder, name in (("others", "tasks"), ("recorded", "others")):
        done = run("render", f"{name}.jsonl", *shared[2:], folder, "-o", "no.png", cwd=tmp_path)
        assert done.returncode == 2 and f"{folder}/000001.npz does not show this task" in done.stderr
    kept = (tmp_path / "tasks.jsonl").read_bytes()
    again = run(*sampled, "--seed", "5", "-o", "tasks.jsonl", cwd=tmp_path)
    assert again.returncode == 4 and "recorded: already exists; remove it, or give a new folder" in again.stderr
    assert (tmp_path / "tasks.jsonl").read_bytes() == kept
    missing = run(*shared, "elsewhere", "-o", "shown.png", cwd=tmp_path)
    assert missing.returncode == 2 and "elsewhere/000001.npz" in missing.stderr and missing.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("3",), "it has 2 tasks, so none has the number 3"),
        (("-o", "one.png"), "2 pictures as strip need a folder"),
        (("1", "--as", "state", "--state", "9", "-o", "one.png"), "the states of the task are 0 to 3"),
    ],
)
def test_what_cannot_be_drawn_is_said_in_one_line(
    tasks: Path, tmp_path: Path, options: tuple[str, ...], complaint: str
) -> None:
    done = run("render", str(tasks), *options, cwd=tmp_path)
    assert done.returncode in (1, 2)
    assert complaint in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--size", "big"), "write WIDTHxHEIGHT"),
        (("--size", "9x9999"), "16 to 4096 pixels a side"),
        (("--as", "gif", "--speed", "0"), "positive number"),
        (("--speed", "nan"), "positive number"),
        (("--as", "gif", "--speed", "1e308"), "positive number"),
        (("--as", "gif", "--speed", "1e-308"), "positive number"),
        (("--state", "1"), "--state 1 goes with --as state; got --as strip"),
        (("-o", "one.nothing"), "a picture as strip is a .png, .jpg, "),
        (("--as", "gif", "-o", "one.png"), "a picture as gif is a .gif file"),
        (("-o", "no/folder/one.png"), "there is no folder no/folder; make it"),
    ],
)
def test_options_that_cannot_be_met_are_refused_before_the_file_is_read(
    tmp_path: Path, options: tuple[str, ...], complaint: str
) -> None:
    (tmp_path / "broken.jsonl").write_text("no task\n")
    done = run("render", "broken.jsonl", *options, cwd=tmp_path)
    assert done.returncode == (4 if "no/folder/one.png" in options else 2)
    assert complaint in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize("name", ["one.webp", "one.JPG", "dotted.folder"])
def test_the_end_of_a_name_says_how_a_picture_is_written(tasks: Path, tmp_path: Path, name: str) -> None:
    (tmp_path / "dotted.folder").mkdir()
    done = ok("render", str(tasks), "1", "--as", "state", "--size", "32x32", "-o", name, cwd=tmp_path)
    assert pixels(tmp_path / done.strip()).shape == (32, 32, 3)
    assert done.strip() == (name if name != "dotted.folder" else "dotted.folder/000001.png")


def test_tasks_of_a_folder_beside_their_file_are_drawn_from_anywhere(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    ok("new", "mine", cwd=home)
    ok("sample", "mine", "-n", "1", "--count", "1", "--format", "jsonl", "-o", "tasks.jsonl", cwd=home)
    drawn = ("render", "home/tasks.jsonl", "--as", "state", "--size", "32x32", "-o", "one.png")
    assert ok(*drawn, cwd=tmp_path) == "one.png\n"


def test_a_file_without_tasks_and_an_unwritable_folder_are_refused(tasks: Path, tmp_path: Path) -> None:
    (tmp_path / "empty.jsonl").write_text("")
    assert "no tasks in it" in run("render", "empty.jsonl", cwd=tmp_path).stderr
    (tmp_path / "file").write_text("")
    assert "cannot be created" in run("render", str(tasks), "-o", "file/folder", cwd=tmp_path).stderr


def test_a_witness_of_another_task_is_not_drawn(tmp_path: Path) -> None:
    lines = ok("sample", "tabletop", "-n", "3", "--count", "2", "--seed", "7", "--format", "jsonl").splitlines()
    first, second = map(json.loads, lines)
    (tmp_path / "tasks.jsonl").write_text(json.dumps({**first, "witness": second["witness"]}) + "\n")
    for form in ("strip", "state"):
        done = run("render", "tasks.jsonl", "1", "--as", form, "-o", "one.png", cwd=tmp_path)
        assert done.returncode == 2 and "its witness fails" in done.stderr and done.stderr.count("\n") == 1


def test_a_3d_scene_is_a_page_or_binary_gltf(tasks: Path, tmp_path: Path) -> None:
    assert ok("render", str(tasks), "1", "--as", "html", cwd=tmp_path) == "pictures/000001.html\n"
    page = (tmp_path / "pictures" / "000001.html").read_text()
    assert "tabletop, task 1" in page and "showEpisode" in page
    ok("render", str(tasks), "1", "--as", "glb", "-o", "task.glb", cwd=tmp_path)
    assert (tmp_path / "task.glb").read_bytes()[:4] == b"glTF"
    for options, problem in ((("--size", "90x80"), "no size in pixels"), (("-o", "task.png"), "is a .html file")):
        done = run("render", str(tasks), "1", "--as", "html", *options, cwd=tmp_path)
        assert (done.returncode, done.stdout) == (2, "") and problem in done.stderr
