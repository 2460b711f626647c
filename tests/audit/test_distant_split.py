"""A split with a distance is proved again from its folder, and everything that is wrong with it is found."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.analysis import nearest_task
from tests.commands import ok, run

ARGUMENTS = ("split", "prag", "-n", "6", "--hold-out", "grasp>rotate", "--distance", "2")
TRAINING, TEST = TaskSpace(load_domain("prag"), 6).hold_out("grasp>rotate")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("split") / "parts"
    ok(*ARGUMENTS, "--count", "20", "-o", str(folder))
    return folder


def test_the_sizes_and_the_tasks_are_those_that_are_far_enough(made: Path) -> None:
    sizes = dict(line.split() for line in ok(*ARGUMENTS).splitlines())
    far = sum(nearest_task(TRAINING, task).distance >= 2 for task in TEST.sample(200, seed=2))
    assert sizes["train"] == str(TRAINING.count())
    assert int(sizes["test"]) / TEST.count() == pytest.approx(far / 200, abs=0.15)
    lines = (made / "test.txt").read_text().splitlines()
    assert len(set(lines)) == 20
    assert all(nearest_task(TRAINING, line.split()).distance >= 2 for line in lines)
    assert f"{made}: ok; 40 tasks; every task outside train is at least 2 edits from every task of train" in ok(
        "verify", str(made)
    )


def test_whole_skeletons_and_json_lines_are_verified_too(tmp_path: Path) -> None:
    shares = ("train=0.5", "test=0.5", "--skeletons", "--distance", "2")
    ok("split", "blocks", "-n", "6", *shares, "--count", "5", "--format", "jsonl", "-o", str(tmp_path / "parts"))
    assert "10 tasks" in ok("verify", str(tmp_path / "parts"))


def near_task() -> str:
    return next(str(task) for task in TEST.sample(200, seed=1) if nearest_task(TRAINING, task).distance < 2)


def with_lines(change: Callable[[list[str]], list[str]], file: str = "test.txt") -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        path = folder / file
        path.write_text("".join(f"{line}\n" for line in change(path.read_text().splitlines())))

    return spoil


def with_size(folder: Path) -> None:
    note = json.loads((folder / "split.json").read_text())
    note["parts"][1]["size"] = "7"
    (folder / "split.json").write_text(json.dumps(note))


@pytest.mark.parametrize(
    ("spoil", "found"),
    [
        (
            with_lines(lambda lines: [*lines[:-1], near_task()]),
            "test.txt: row 19: is 1 edit from the first part, not 2",
        ),
        (with_lines(lambda lines: [*lines, lines[0]]), "test.txt: row 20: is the same task as an earlier one"),
        (
            with_lines(lambda lines: [*lines, "fly(a)"]),
            "test.txt: row 20: is not a task: no action 'fly(a)'",
        ),
        (
            with_lines(lambda lines: [*lines[:-1], str(TEST[0])], "train.txt"),
            "train.txt: row 19: is not a task of train",
        ),
        (with_size, "split.json: parts, test: size is 7, but there are"),
        (lambda folder: (folder / "train.txt").unlink(), "train.txt: cannot be read"),
        (lambda folder: (folder / "domain" / "domain.lp").write_text(""), "differs from its record in split.json"),
    ],
)
def test_what_is_wrong_is_found(spoil: Callable[[Path], None], found: str, made: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(made, copy)
    spoil(copy)
    done = run("verify", str(copy))
    assert done.returncode == 1 and any(line.startswith(found) or found in line for line in done.stdout.splitlines())


def test_requests_that_cannot_be_proved_are_refused() -> None:
    for arguments, refused in (
        (("train=0.5", "test=0.5", "--distance", "2"), "random parts have neighbours of nearly every task"),
        (("--hold-out", "can", "--distance", "2", "--count", "1", "-o", "x", "--format", "sentences"), "jsonl, not"),
    ):
        done = run("split", "prag", "-n", "3", *arguments)
        assert done.returncode == 2 and refused in done.stderr


COVERING = ("split", "prag", "-n", "6", "--cover", "2", "--combinations", "3")


@pytest.fixture(scope="module")
def covering(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("covering") / "parts"
    ok(*COVERING, "--distance", "2", "--count", "12", "-o", str(folder))
    return folder


def test_a_covering_split_is_proved_again(covering: Path) -> None:
    assert ok("verify", str(covering)) == (
        f"{covering}: ok; 24 tasks; every task outside train is at least 2 edits from every task of train; "
        "train covers all 59 combinations; train lacks 3 larger combinations, and every other task contains at least "
        "one of them\n"
    )
    sizes = [int(line.split()[1]) for line in ok(*COVERING).splitlines()]
    assert sum(sizes) == TaskSpace(load_domain("prag"), 6).count()
    note = json.loads((covering / "split.json").read_text())
    assert note["reachable"] == 59 and len(note["combinations"]) == 3 and len(note["parts"][0]["ranks"]) == 12


def other_rank(folder: Path) -> None:
    note = json.loads((folder / "split.json").read_text())
    note["parts"][0]["ranks"][4] = "1"
    note["reachable"] = 58
    (folder / "split.json").write_text(json.dumps(note))


def other_combinations(folder: Path) -> None:
    note = json.loads((folder / "split.json").read_text())
    note["combinations"] += [{"0": "move", "1": "gripper", "3": place} for place in ("bowl", "crate")]
    (folder / "split.json").write_text(json.dumps(note))


def unread_combinations(folder: Path) -> None:
    note = json.loads((folder / "split.json").read_text())
    note["combinations"][0] = {"move": "gripper"}
    (folder / "split.json").write_text(json.dumps(note))


@pytest.mark.parametrize(
    ("spoil", "found"),
    [
        (other_rank, "train.txt: row 4: has rank "),
        (other_rank, "split.json: reachable: is 58, but there are 59 combinations"),
        (other_combinations, "split.json: combinations: no task of the first part has move("),
        (unread_combinations, "split.json: cannot be checked"),
        (with_lines(lambda lines: lines[:1] * 12, "train.txt"), "train.txt: has no task with "),
        (with_lines(lambda lines: [str(TRAINING[0]), *lines[1:]]), "test.txt: row 0: has none of the combinations"),
    ],
)
def test_what_is_wrong_with_a_covering_split_is_found(
    spoil: Callable[[Path], None], found: str, covering: Path, tmp_path: Path
) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(covering, copy)
    spoil(copy)
    done = run("verify", str(copy))
    assert done.returncode == 1 and any(line.startswith(found) for line in done.stdout.splitlines()), done.stdout


def test_requests_for_covering_splits_are_checked(tmp_path: Path) -> None:
    for arguments, refused in (
        (("--cover", "2", "--hold-out", "can"), "or --cover T; one of them"),
        (("--hold-out", "can", "--combinations", "2"), "--combinations are held out with --cover"),
        (("--cover", "2", "--skeletons"), "leave --skeletons out"),
        (("--cover", "2", "--count", "2", "-o", str(tmp_path)), "the file of train needs "),
    ):
        done = run("split", "prag", "-n", "3", *arguments)
        assert done.returncode == 2 and refused in done.stderr, done.stderr
