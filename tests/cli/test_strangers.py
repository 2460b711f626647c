"""What comes from a stranger, be it a domain, tasks or a recording, leads nowhere else, and is told in one line."""

from __future__ import annotations

import json
import os
import pty
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from prag_asp.errors import LONGEST
from prag_asp.space.engines import cache
from tests.commands import PRAG, Done, ok, run

SEEDS = Path(__file__).parents[1] / "fuzz" / "seeds"
SECRET = "tell_nobody"


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with a domain, tasks and recordings of it, beside a file that is none of their business."""
    own = tmp_path / "here"
    shutil.copytree(SEEDS, own)
    (tmp_path / "secret").write_text(f"{SECRET}.\n")
    return own


def one_line(done: Done, code: int = 2) -> str:
    assert (done.returncode, done.stdout) == (code, ""), done
    (line,) = done.stderr.splitlines()
    assert SECRET not in line and len(line) <= LONGEST and line.isprintable()
    return line


def secret(path: Path) -> None:
    path.unlink(missing_ok=True)
    here = next(parent for parent in path.parents if parent.name == "here")
    path.symlink_to(os.path.relpath(here.parent / "secret", path.parent))


def zeros(path: Path) -> None:
    path.unlink(missing_ok=True)
    path.symlink_to("/dev/zero")


def pipe(path: Path) -> None:
    path.unlink(missing_ok=True)
    os.mkfifo(path)


def endless(path: Path) -> None:
    path.unlink(missing_ok=True)
    with path.open("wb") as file:
        file.truncate(10**12)


@pytest.mark.parametrize(
    "name", ["domain.lp", "domain.toml", "learned.lp", "more.lp", "bodies/mug.urdf", "bodies/handle.obj"]
)
def test_what_is_no_file_in_place_of_a_file_of_a_domain_is_one_line(here: Path, name: str) -> None:
    with (here / "scene" / "domain.lp").open("a") as file:
        file.write('#include "more.lp".\n')
    (here / "scene" / "more.lp").write_text("class(more, item).\n")
    for lies in (secret, zeros, pipe, endless):
        lies(here / "scene" / name)
        assert one_line(run("check", "scene", cwd=here)).startswith("scene")


@pytest.mark.parametrize("arguments", [["count", "FILE.lp", "-n", "1"], ["check", "closed", "--settings", "FILE.lp"],
                                       ["validate", "FILE.lp"], ["render", "FILE.lp"]])  # fmt: skip
def test_what_the_user_names_is_no_pipe_or_device_either(here: Path, arguments: list[str]) -> None:
    for lies in (zeros, pipe, endless):
        lies(here / "FILE.lp")
        assert one_line(run(*arguments, cwd=here)).startswith("FILE.lp")


def test_what_the_user_names_may_be_a_link(here: Path, tmp_path: Path) -> None:
    (tmp_path / "domain").symlink_to(here / "closed")
    (tmp_path / "domain.lp").symlink_to(here / "closed" / "domain.lp")
    (tmp_path / "settings.toml").symlink_to(here / "closed" / "domain.toml")
    (tmp_path / "tasks.jsonl").symlink_to(here / "tasks.jsonl")
    given = ("domain.lp", "--settings", "settings.toml")
    assert ok("count", "domain", "-n", "3", cwd=tmp_path) == ok("count", *given, "-n", "3", cwd=tmp_path)
    told = ok("validate", "tasks.jsonl", "--domain", "here/scene", "--witness-only", cwd=tmp_path)
    assert told.count("feasible") == 2


def test_what_is_learned_is_not_written_through_a_link(here: Path, tmp_path: Path) -> None:
    secret(here / "scene" / "learned.lp")
    done = run("learn", "scene", "-n", "1", "--count", "0", "--write", cwd=here)
    assert "leads out of the folder" in one_line(done, done.returncode) and done.returncode
    assert (tmp_path / "secret").read_text() == f"{SECRET}.\n"


@pytest.mark.parametrize(
    ("arguments", "file"),
    [(["split", "timed", "-n", "3", "train=0.5", "test=0.5", "--count", "2", "-o", "out"], "out/train.txt"),
     (["render", "tasks.jsonl", "1", "2", "--as", "state", "--size", "16x16", "-o", "out"], "out/000001.png")],
)  # fmt: skip
def test_results_are_not_written_through_a_link(here: Path, tmp_path: Path, arguments: list[str], file: str) -> None:
    (here / "out").mkdir()
    secret(here / file)
    done = run(*arguments, cwd=here)
    assert done.returncode and done.stderr.splitlines()[-1].startswith(f"{file}: leads out of the folder")
    assert (tmp_path / "secret").read_text() == f"{SECRET}.\n"


def changed_task(here: Path, **changes: object) -> Path:
    first = json.loads((here / "tasks.jsonl").read_text().splitlines()[0])
    file = here / "one.jsonl"
    file.write_text(json.dumps({**first, **changes}))
    return file


@pytest.mark.parametrize("name", ["../outside", "ABSOLUTE", "link", "", "scene/../../outside", "a\0b", "x" * 5000])
def test_a_task_names_no_domain_that_lies_elsewhere(here: Path, tmp_path: Path, name: str) -> None:
    shutil.copytree(here / "scene", tmp_path / "outside")
    (here / "link").symlink_to("../outside")
    changed_task(here, domain=str(tmp_path / "outside") if name == "ABSOLUTE" else name)
    line = one_line(run("validate", "one.jsonl", "--witness-only", cwd=here))
    assert line.startswith("one.jsonl:1: a task of ") and "no such domain is shipped or in this folder" in line


@pytest.mark.parametrize("name", ["../../secret", "/etc/passwd", "link.npz", "a\x1b[31m\n.npz", ""])
def test_a_verdict_names_no_recording_that_lies_elsewhere(here: Path, name: str) -> None:
    secret(here / "recordings" / "link.npz")
    changed_task(here, verdict={"demonstration": name})
    line = one_line(run("render", "one.jsonl", "--recordings", "recordings", "-o", "one.png", cwd=here))
    assert line.startswith("one.jsonl:1: ") and "cannot be read" in line


def test_a_recording_that_grows_when_it_is_unpacked_is_refused(here: Path) -> None:
    path = here / "recordings" / "000001.npz"
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    np.savez_compressed(path, **{**arrays, "forces": np.zeros(75_000_000, np.float32)})
    assert path.stat().st_size < 10**6
    line = one_line(run("render", "tasks.jsonl", "1", "--recordings", "recordings", "-o", "one.png", cwd=here))
    assert "its arrays are larger than 256 MB" in line


def test_a_line_of_tasks_without_an_end_is_told(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("prag_asp.safe_reading", "prag_asp.dataset.jsonl"):
        monkeypatch.setattr(f"{module}.LONGEST_LINE", 1000)
    assert "tasks.jsonl:1: not a task: the line is longer than" in one_line(run("validate", "tasks.jsonl", cwd=here))


def test_what_a_message_quotes_is_escaped_and_cut(here: Path) -> None:
    settings = here / "closed" / "domain.toml"
    usual = settings.read_text()
    for key in ("\x1b[31mred", "two\nlines", "bell\x07", "right\u202eleft", "\u2028", "x" * 5000):
        settings.write_text(f"[weights]\n{json.dumps(key)} = 2\n")
        assert one_line(run("check", "closed", cwd=here)).startswith("closed/domain.toml:2: weights.")
        settings.write_text(usual)
        one_line(run("count", "closed", "-n", "1", "--where", f"uses {key}", cwd=here))
        assert one_line(run("count", "closed", "-n", key, cwd=here)).startswith("--length ")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["count"], "prag-asp count: Missing argument 'DOMAIN...'; see prag-asp count --help"),
        (["count", "prag", "--nope"], "prag-asp count: No such option"),
        (["sample", "prag", "-n", "1", "--format", "x\x1b[1m"], "prag-asp sample: Invalid value for '--format': "),
        (["nope\x07"], r"prag-asp: No such command 'nope\x07'"),
    ],
)
def test_a_wrong_command_line_is_told_in_one_line(arguments: list[str], told: str) -> None:
    line = one_line(run(*arguments), 64)
    assert line.startswith(told) and line.endswith("--help")


MANY = str(10**30)


@pytest.mark.parametrize(
    "arguments",
    [
        ("sample", "timed", "-n", "1", "--count", MANY),
        ("sample", "timed", "-n", "1", "--max-draws", MANY),
        ("sample", "timed", "-n", "1", "--workers", MANY),
        ("enumerate", "timed", "-n", "1", "--limit", MANY),
        ("split", "timed", "-n", "1", "a=1", "--count", MANY, "-o", "out"),
        ("learn", "scene", "-n", "1", "--count", MANY),
        ("generate", "timed", "-n", "1", "--tasks", MANY, "-o", "out"),
        ("generate", "timed", "-n", "1", "--tasks", "1", "--max-draws", MANY, "-o", "out"),
        ("generate", "timed", "-n", "1", "--tasks", "1", "--starts", MANY, "-o", "out"),
        ("render", "tasks.jsonl", "1", "--columns", MANY),
    ],
    ids=" ".join,
)
def test_a_number_that_is_larger_than_any_machine_is_told_in_one_line(here: Path, arguments: tuple[str, ...]) -> None:
    assert f"{MANY} is not in the range" in one_line(run(*arguments, cwd=here), 64)


def test_as_many_tasks_as_can_be_asked_for_are_those_that_there_are(here: Path) -> None:
    most = str(10**15)
    assert len(ok("enumerate", "timed", "-n", "1", "--limit", most, cwd=here).splitlines()) < 100
    asked = ("--no-physics", "--tasks", most, "--max-draws", most, "-o", "out")
    done = run("generate", "timed", "-n", "1", *asked, cwd=here)
    assert done.returncode == 1 and "found in 2 draws, 1 of them trivial" in done.stderr


def test_a_terminal_gets_no_character_that_it_would_obey_and_a_file_gets_the_bytes(here: Path) -> None:
    (here / "timed" / "domain.toml").write_text('[language]\ntake = "take \\u001b[2J it\\t{1}"\n')
    arguments = ["sample", "timed", "-n", "2", "--count", "9", "--format", "sentences"]
    assert "\x1b[2J" in ok(*arguments, cwd=here)
    ours, theirs = pty.openpty()
    process = subprocess.Popen([*PRAG, *arguments], cwd=here, stdout=theirs, stderr=subprocess.DEVNULL)
    os.close(theirs)
    shown = b""
    try:
        while piece := os.read(ours, 4096):
            shown += piece
    except OSError:  # so Linux says that nobody writes any more
        pass
    assert process.wait(timeout=300) == 0
    os.close(ours)
    assert b"\x1b" not in shown and rb"take \x1b[2J it" in shown


def test_only_one_file_of_the_command_writes_to_a_terminal() -> None:
    folder = Path(cache.__file__).parents[2] / "cli"
    texts = {path.name: path.read_text().replace("console.print(", "") for path in folder.rglob("*.py")}
    assert {name for name, text in texts.items() if "click.echo" in text or "print(" in text} == {"terminal.py"}
