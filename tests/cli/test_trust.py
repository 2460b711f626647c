"""A domain's own Python file on the command line: run where it is trusted, and nowhere else."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.commands import run_apart as run

STUDIO = Path(__file__).parents[2] / "examples" / "own_predicates"


@pytest.mark.parametrize("arguments", [["check", str(STUDIO)], ["sample", str(STUDIO), "-n", "3"]])
def test_without_trust_physics_ends_with_one_line(arguments: list[str]) -> None:
    done = run(*arguments)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert "predicates.py:1: defines looks_at in Python, which runs only if you trust the domain" in line
    assert "--trust" in line


def test_what_needs_no_physics_needs_no_trust() -> None:
    assert run("count", str(STUDIO), "-n", "3").stdout == "280\n"
    assert len(run("sample", str(STUDIO), "-n", "3", "--count", "4", "--no-physics").stdout.splitlines()) == 4


def test_with_trust_tasks_are_drawn_by_two_workers_and_their_witnesses_pass(tmp_path: Path) -> None:
    assert run("check", str(STUDIO), "--trust").stdout.startswith("own_predicates: ok; open world")
    file = tmp_path / "tasks.jsonl"
    drawn = ["sample", str(STUDIO), "-n", "4", "--count", "4", "--seed", "3", "--workers", "2", "--format", "jsonl"]
    done = run(*drawn, "--trust", "-o", str(file))
    assert done.returncode == 0, done.stderr
    assert all(json.loads(line)["witness"] for line in file.read_text().splitlines())
    again = run("validate", str(file), "--domain", str(STUDIO), "--witness-only", "--trust")
    assert again.returncode == 0 and again.stdout.count("feasible") == 4
    refused = run("validate", str(file), "--domain", str(STUDIO), "--witness-only")
    assert (refused.returncode, refused.stdout) == (2, "") and "--trust" in refused.stderr


def test_a_trusted_file_that_fails_ends_with_one_line(tmp_path: Path) -> None:
    folder = tmp_path / "studio"
    shutil.copytree(STUDIO, folder)
    (folder / "predicates.py").write_text("import math\nPREDICATES = {math.no: 1}\n")
    done = run("check", str(folder), "--trust")
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert "predicates.py:2: AttributeError: module 'math' has no attribute 'no'" in line


def test_a_predicate_with_a_wrong_result_ends_a_draw_with_its_line_alone(tmp_path: Path) -> None:
    folder = tmp_path / "studio"
    shutil.copytree(STUDIO, folder)
    file = folder / "predicates.py"
    text = file.read_text()
    file.write_text(text.replace("    return Volume(sides=tuple(sides))", "    return sides"))
    line = text[: text.index("def _volume")].count("\n") + 1
    drawn = ["sample", str(folder), "-n", "4", "--count", "20", "--where", "has at least 1 aim", "--trust"]
    done = run(*drawn)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(
        f"{file}:{line}: the volume of looks_at has to be a Volume, with numbers as its bounds"
    )
    assert done.stderr.count("\n") == 1
