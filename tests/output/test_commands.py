"""Commands that write leave whole files, old or new, whatever fails."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from prag_asp import TaskSpace, load_domain
from prag_asp.cli.domain_options import DomainOptions
from prag_asp.dataset import physics_filter
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import Budget, Verdict, validate_task
from tests.commands import PRAG, run
from tests.output.faults import Disk, content

OUTPUT, NOT_FOUND = 4, 1
SAMPLE = (
    "sample", "tabletop", "-n", "1", "--seed", "7", "--format", "jsonl", "--demonstrate", "rec", "-o", "out.jsonl",
)  # fmt: skip


@pytest.fixture(scope="module")
def feasible() -> Verdict:
    """A verdict with a witness and a recording."""
    domain = load_domain("tabletop")
    task = TaskSpace(domain, 1).sample(1, seed=7)[0]
    verdict = validate_task(task, scene_of(domain), seed=7, budget=Budget(tier="demonstration"))
    assert verdict.demonstration is not None
    return verdict


class Physics:
    """Says of two of three tasks that they are feasible, at once; breaks off when it has been asked so often."""

    def __init__(self, feasible: Verdict) -> None:
        self.feasible = feasible
        self.asked: list[int] = []
        self.breaks: int | None = None

    def __call__(self, tasks: Iterable[tuple[int, Any]], *_: object, **more: Any) -> Iterator[Verdict]:
        for index, _ in tasks:
            if len(self.asked) == self.breaks:
                raise KeyboardInterrupt
            self.asked.append(index)
            found = replace(self.feasible, index=index, causes={"objects collide": index})
            yield found if index % 3 else Verdict("not_found", found.budget, 7, index, reason="objects collide",
                                                  causes={"objects collide": 100})  # fmt: skip


@pytest.fixture
def physics(feasible: Verdict, monkeypatch: pytest.MonkeyPatch) -> Physics:
    made = Physics(feasible)
    monkeypatch.setattr(physics_filter, "validate_numbered", made)
    return made


def remembered(method: Callable[..., Any]) -> Callable[..., Any]:
    """Return a method of what a command line asks for that answers the same question once."""

    def found(asked: DomainOptions, *given: Any, **more: Any) -> Any:
        key = f"{method.__name__} {asked}"
        if key not in ANSWERS:
            ANSWERS[key] = method(asked, *given, **more)
        return ANSWERS[key]

    return found


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have each domain loaded once, and nothing flushed: no power is lost here."""
    for name in ("domain", "space", "spaces"):
        monkeypatch.setattr(DomainOptions, name, remembered(getattr(DomainOptions, name)))
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)


def test_an_interrupted_sample_leaves_the_old_file_and_no_recordings(tmp_path: Path, physics: Physics) -> None:
    whole = run(*SAMPLE, "--count", "6", cwd=tmp_path)
    assert whole.returncode == 0 and "9 sampled, 6 passed" in whole.stderr
    reference = content(tmp_path)
    assert len(reference) == 1 + 6
    draws = physics.asked
    assert draws == list(range(9))
    for breaks in (1, 5, 8):
        shutil.rmtree(tmp_path / "rec")
        (tmp_path / "out.jsonl").write_text("old\n")
        physics.asked, physics.breaks = [], breaks
        broken = run(*SAMPLE, "--count", "6", cwd=tmp_path)
        assert broken.returncode == 130 and f"{breaks} sampled, " in broken.stderr
        assert content(tmp_path) == {"out.jsonl": b"old\n"} and not [*tmp_path.glob("rec*")]
        physics.asked, physics.breaks = [], None
        again = run(*SAMPLE, "--count", "6", cwd=tmp_path)
        assert physics.asked == draws and content(tmp_path) == reference and again.stderr == whole.stderr


def test_recordings_are_not_mixed_with_what_is_there(tmp_path: Path, physics: Physics) -> None:
    (tmp_path / "rec").mkdir()
    (tmp_path / "rec" / "000002.npz").write_bytes(b"old")
    done = run(*SAMPLE, "--count", "6", cwd=tmp_path)
    assert done.returncode == OUTPUT and "rec: already exists; remove it, or give a new folder" in done.stderr
    assert physics.asked == [] and content(tmp_path) == {"rec/000002.npz": b"old"}


def test_too_few_tasks_are_a_whole_file_and_an_exit_code_of_their_own(tmp_path: Path, physics: Physics) -> None:
    done = run(*SAMPLE, "--count", "6", "--max-draws", "4", cwd=tmp_path)
    assert done.returncode == NOT_FOUND
    assert done.stderr.endswith("only 2 of 6 tasks found in 4 draws; raise --max-draws\n")
    assert len((tmp_path / "out.jsonl").read_text().splitlines()) == 2


ANSWERS: dict[str, Any] = {}
WRITING = {
    "enumerate": ("enumerate", "blocks", "-n", "3", "-o", "out.txt"),
    "sample": ("sample", "blocks", "-n", "3", "--count", "9", "--format", "jsonl", "-o", "out.txt"),
    "split": ("split", "blocks", "-n", "3", "train=1/2", "test=1/2", "--count", "4", "-o", "out"),
    "export": ("export", "blocks", "-n", "1", "-o", "out.cnf"),
    "stats": ("stats", "blocks", "-n", "2", "-o", "out.txt"),
    "new": ("new", "mine"),
    "feasible": (*SAMPLE, "--count", "2"),
    "validate": ("validate", "tasks.jsonl", "--witness-only", "-o", "out.txt"),
    "render": ("render", "tasks.jsonl", "1", "2", "--as", "state", "--size", "16x16", "-o", "pictures"),
    "learn": ("learn", "mine", "-n", "1", "--count", "0", "--write"),
}


@pytest.fixture(scope="module")
def given(feasible: Verdict, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what the commands read: two tasks with witnesses, and a domain."""
    folder = tmp_path_factory.mktemp("given")
    done = run("sample", "tabletop", "-n", "1", "--count", "2", "--format", "jsonl", "-o", "tasks.jsonl", cwd=folder)
    assert done.returncode == run("new", "mine", cwd=folder).returncode == 0
    return folder


@pytest.mark.parametrize("name", WRITING)
def test_at_each_failure_of_the_disk_no_file_is_cut_and_the_next_run_ends_well(
    tmp_path: Path, name: str, physics: Physics, given: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prag_asp.physics.still", lambda *_, **__: Image.new("RGB", (8, 8)))
    monkeypatch.setattr("prag_asp.physics.check_witness", lambda *_: [])  # they were found just now

    def begun(home: Path) -> Path:
        if name in ("validate", "render", "learn"):
            return Path(shutil.copytree(given, home))
        home.mkdir()
        return home

    reference = begun(tmp_path / "reference")
    with Disk().working() as disk:
        done = run(*WRITING[name], cwd=reference)
    assert done.returncode == 0, done.stderr
    whole, total = content(reference), len(disk.asked)
    assert total >= 6
    for number in range(1, total + 1):
        home = begun(tmp_path / str(number))
        with Disk(number, (1, 10**6)[number % 2], (errno.ENOSPC, errno.EIO)[number // 2 % 2]).working() as broken:
            done = run(*WRITING[name], cwd=home)
        if len(broken.asked) < number:  # what is made once, such as the folder of the cache, is there by now
            assert done.returncode == 0 and content(home) == whole
            break
        assert done.returncode == OUTPUT, (number, disk.asked[number - 1], done.stderr)
        assert "cannot be" in done.stderr and "Traceback" not in done.stderr
        found = {file: text for file, text in content(home).items() if ".part" not in file}
        assert all(whole[file] == text for file, text in found.items())
        again = run(*WRITING[name], cwd=home)
        if name in ("new", "feasible") and any("/" in file for file in found):  # the folder is there already, whole
            assert again.returncode == (2 if name == "new" else OUTPUT)
        else:
            assert again.returncode == 0, (number, again.stderr)
        assert content(home) == whole
        shutil.rmtree(home)


def test_a_disk_without_room_leaves_the_old_file(tmp_path: Path) -> None:
    """The system itself says that there is no more room: a limit on the size of files, set in the process."""
    command = ["enumerate", "prag", "-n", "4", "-o", "out.txt"]
    assert run(*command, cwd=tmp_path).returncode == 0
    whole = (tmp_path / "out.txt").read_bytes()
    (tmp_path / "out.txt").write_text("old\n")
    code = (
        "import resource, sys; sys.dont_write_bytecode = True;"  # which Python would cut, and believe
        "from prag_asp.cli import line_output; line_output.BUFFER = 100;"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv.pop(1)),) * 2);"
        "from prag_asp.cli import main; main()"
    )
    for room in ("0", "5", "3000"):
        done = subprocess.run(
            [sys.executable, "-c", code, room, *command], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == OUTPUT, done.stderr
        assert done.stderr.splitlines()[-1] == "out.txt: cannot be written: File too large; free some space"
        assert (tmp_path / "out.txt").read_text() == "old\n"
    done = run(*command, cwd=tmp_path)
    assert done.returncode == 0 and content(tmp_path) == {"out.txt": whole}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("command", ["count prag -n 3", "enumerate prag -n 3", "check prag", "stats prag -n 3"])
def test_a_full_disk_behind_stdout_is_one_line_and_the_code_of_output(command: str) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([*PRAG, *command.split()], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == OUTPUT and done.stderr.count("\n") == 1, done.stderr
    assert "No space left on device" in done.stderr


@pytest.mark.parametrize("command", ["count prag -n 3", "enumerate prag -n 6", "check prag", "stats prag -n 3"])
def test_a_closed_pipe_is_quiet_and_has_the_code_of_output(command: str) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as closed:
        done = subprocess.run([*PRAG, *command.split()], stdout=closed, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (OUTPUT, "")


def test_what_is_no_file_is_written_as_it_is(tmp_path: Path) -> None:
    assert run("enumerate", "blocks", "-n", "1", "-o", "/dev/null").returncode == 0
    assert Path("/dev/null").is_char_device()
    os.mkfifo(tmp_path / "pipe")
    command = f"cat pipe > piped.txt & {' '.join(map(repr, PRAG))} enumerate blocks -n 1 -o pipe; wait"
    subprocess.run(["sh", "-c", command], cwd=tmp_path, check=True, timeout=120)
    assert (tmp_path / "piped.txt").read_text() == run("enumerate", "blocks", "-n", "1").stdout


def test_validate_writes_what_it_prints_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = ("sample", "tabletop", "-n", "1", "--no-physics", "--count", "6", "--format", "jsonl", "-o", "tasks.jsonl")
    assert run(*drawn, cwd=tmp_path).returncode == 0
    checked = ("validate", "tasks.jsonl", "--budget", "1x1")
    printed = run(*checked, cwd=tmp_path)
    with monkeypatch.context() as patch:
        broken(patch, 4)
        first = run(*checked, "-o", "report.txt", cwd=tmp_path)
    assert first.returncode == 130 and set(content(tmp_path)) == {"tasks.jsonl"}
    done = run(*checked, "-o", "report.txt", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (printed.returncode, "", printed.stderr)
    assert (tmp_path / "report.txt").read_text() == printed.stdout
    assert set(content(tmp_path)) == {"tasks.jsonl", "report.txt"}


def broken(monkeypatch: pytest.MonkeyPatch, time: int) -> None:
    """Have validation broken off at the n-th task."""
    from prag_asp.physics.validator import Validator

    validate: Callable[..., Verdict] = Validator.validate
    done: list[int] = []

    def breaks(*given: Any, **more: Any) -> Verdict:
        done.append(1)
        if len(done) == time:
            raise KeyboardInterrupt
        return validate(*given, **more)

    monkeypatch.setattr(Validator, "validate", breaks)
