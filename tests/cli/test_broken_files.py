"""What is wrong with a file is said in one line, with the place and what to do, and never in words of Python."""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from tests.commands import ok, run

Change = Callable[[dict[str, Any]], object]
MEND = "; sample the task again, or set its witness to null"


@pytest.fixture(scope="module")
def whole() -> dict[str, Any]:
    """One feasible task of tabletop as a value of JSON."""
    line = ok("sample", "tabletop", "-n", "2", "--count", "1", "--seed", "7", "--format", "jsonl")
    return json.loads(line)


def object_of(witness: dict[str, Any]) -> str:
    """Return an object that takes part."""
    return next(iter(witness["moments"][0]["poses"]))


def arm(witness: dict[str, Any], k: int) -> dict[str, Any]:
    """Return the arm in a state."""
    return witness["moments"][k]["arms"]["panda"]


MALFORMED: dict[str, Change] = {
    "witness.version: is missing": lambda w: w.clear(),
    "witness.version: needs 2; got 3": lambda w: w.update(version=3),
    "witness.moments[2].arms.panda.joints: needs a list; got 'x'": lambda w: arm(w, 2).update(joints="x"),
    "witness.moments[2].arms.panda.joints: needs a list of 7; got a list of 6": lambda w: arm(w, 2)["joints"].pop(),
    "witness.moments[1].arms.panda.joints[3]: needs a finite number; got true": (
        lambda w: arm(w, 1)["joints"].__setitem__(3, True)
    ),
    f"witness.moments[1].arms.panda.width: needs a finite number; got {'1' + '0' * 39}...": (
        lambda w: arm(w, 1).update(width=10**400)
    ),
    "witness.moments[0].arms.panda.grasp[1]: needs a list of 4; got [0, 0, 1]": (
        lambda w: arm(w, 0).update(held="cube_1", grasp=[[0, 0, 0], [0, 0, 1]])
    ),
    "witness.moments[0].arms.panda.held: is missing": lambda w: arm(w, 0).pop("held"),
    "witness.moments[1].poses: is missing": lambda w: w["moments"][1].pop("poses"),
    "witness.moments[1].poses.ghost[0]: needs a list of 3; got []": (
        lambda w: w["moments"][1]["poses"].update(ghost=[[], [0, 0, 0, 1]])
    ),
    "witness.motions[0][0].held: needs a string or null; got 3": lambda w: w["motions"][0][0].update(held=3),
    "witness.motions[0][1].robot: is missing": lambda w: w["motions"][0][1].pop("robot"),
}
INCONSISTENT: dict[str, Change] = {
    "the witness has 1 motion, the task 2 actions": lambda w: w["motions"].pop(),
    "the witness has 2 states, the task 2 actions": lambda w: w["moments"].pop(),
    "state 1: ghost is not in the scene": (
        lambda w: w["moments"][1]["poses"].update(ghost=[[0.5, 0, 0.1], [0, 0, 0, 1]])
    ),
    "has no pose": lambda w: w["moments"][1]["poses"].pop(object_of(w)),
    "state 2: it has the arms of left; the scene has those of panda": (
        lambda w: w["moments"][2].update(arms={"left": arm(w, 2)})
    ),
}


def written(folder: Path, whole: dict[str, Any], changes: dict[str, Change]) -> Path:
    """Return a file with one task for each change of its witness, after an empty line."""
    lines = [""]
    for change in changes.values():
        broken = deepcopy(whole)
        change(broken["witness"])
        lines.append(json.dumps(broken))
    file = folder / "tasks.jsonl"
    file.write_text("\n".join(lines))
    return file


def test_each_malformed_witness_is_told_by_its_field_and_the_others_are_still_checked(
    tmp_path: Path, whole: dict[str, Any]
) -> None:
    file = written(tmp_path, whole, {**MALFORMED, "": lambda w: None})
    done = run("validate", str(file), "--witness-only")
    assert done.returncode == 1
    expected = [f"witness_fails\t{file}:{i}: {text}{MEND}" for i, text in enumerate(MALFORMED, 2)]
    assert [line.partition("\t")[2] for line in done.stdout.splitlines()] == [*expected, "feasible"]


@pytest.mark.parametrize(
    "text",
    [
        "witness.moments[2].arms.panda.joints: needs a list; got 'x'",
        "witness.motions[0][0].held: needs a string or null; got 3",
    ],
)
def test_a_malformed_witness_is_not_drawn(tmp_path: Path, whole: dict[str, Any], text: str) -> None:
    file = written(tmp_path, whole, {text: MALFORMED[text]})
    done = run("render", str(file), "-o", str(tmp_path / "one.png"))
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"{file}:2: {text}{MEND}\n")


@pytest.mark.parametrize("value", ["NaN", "-Infinity", "1e999"])
def test_what_is_no_number_of_json_is_told_with_its_line(tmp_path: Path, whole: dict[str, Any], value: str) -> None:
    file = written(tmp_path, whole, {"": lambda w: arm(w, 1).update(width="?")})
    file.write_text(file.read_text().replace('"?"', value))
    for command in ("validate", "render"):
        done = run(command, str(file), cwd=tmp_path)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith(f"{file}:2: not a task: it is not JSON: ") and done.stderr.count("\n") == 1


@pytest.mark.parametrize("text", INCONSISTENT)
def test_a_witness_that_does_not_belong_to_its_task_is_not_drawn(
    tmp_path: Path, whole: dict[str, Any], text: str
) -> None:
    file = written(tmp_path, whole, {text: INCONSISTENT[text]})
    done = run("render", str(file), "-o", str(tmp_path / "one.png"))
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"{file}:2: ") and done.stderr.endswith(f"{text}{MEND}\n")
    assert done.stderr.count("\n") == 1


def test_a_witness_that_fails_its_check_is_not_performed(tmp_path: Path, whole: dict[str, Any]) -> None:
    file = written(tmp_path, whole, {"": lambda w: w["motions"][0][0].update(held="ghost")})
    done = run("render", str(file), "--as", "gif", "-o", str(tmp_path / "one.gif"))
    assert done.returncode == 2 and done.stderr.startswith(f"{file}:2: its witness fails: action 1, ")
    assert "it holds ghost, which has no pose" in done.stderr and done.stderr.count("\n") == 1


def test_a_recording_that_was_cut_off_is_told_with_the_task_and_the_file(tmp_path: Path, whole: dict[str, Any]) -> None:
    file = written(tmp_path, whole, {"": lambda w: None})
    (tmp_path / "000001.npz").write_bytes(b"PK\x03\x04 no more")
    done = run("render", str(file), "--recordings", str(tmp_path), "-o", str(tmp_path / "one.png"))
    assert done.returncode == 2 and done.stderr == (
        f"{file}:2: {tmp_path}/000001.npz: this is not a demonstration: "
        "it is not a .npz file, or is truncated; record it again with --demonstrate\n"
    )


def test_tasks_of_another_domain_are_told_with_both_names(tmp_path: Path, whole: dict[str, Any]) -> None:
    file = written(tmp_path, whole, {"": lambda w: None})
    told = "the file says that it is of 'tabletop', but it is read as one of 'prag'"
    done = run("validate", str(file), "--domain", "prag")
    assert done.stdout == f"1\tinvalid\tit is not a plan of prag; {told}\n"
    done = run("render", str(file), "--domain", "prag", "-o", str(tmp_path / "one.png"))
    assert done.returncode == 2 and told in done.stderr and done.stderr.count("\n") == 1
    whole = {**whole, "domain": "nowhere"}
    file.write_text(json.dumps(whole))
    for command in ("validate", "render"):
        done = run(command, str(file), cwd=tmp_path)
        assert done.returncode == 2 and done.stderr == (
            f"{file}:1: a task of 'nowhere'; no such domain is shipped or in this folder; name it with --domain\n"
        )


def test_a_wrong_goal_is_told_in_the_singular(tmp_path: Path, whole: dict[str, Any]) -> None:
    file = tmp_path / "tasks.jsonl"
    file.write_text("\n".join(json.dumps({**whole, **wrong}) for wrong in ({"goal": {}}, {"goal": {}, "initial": {}})))
    assert run("validate", str(file)).stdout.splitlines() == [
        "1\tinvalid\tits goal is not what its actions make",
        "2\tinvalid\tits initial state, goal are not what its actions make",
    ]
