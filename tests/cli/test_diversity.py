"""`prag-asp diversity`: what the functions of `prag_asp.analysis` give, as tables and JSON."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.analysis import compare_frequencies, count_neighbours, hamming_distribution, vendi_score
from tests.commands import ok, run

SPACE = TaskSpace(load_domain("prag"), 3)
PLAN = "grasp(panda,can_1) rotate(panda,can_1,straight) drop(panda,can_1)"


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = tmp_path_factory.mktemp("tasks") / "given.jsonl"
    for length in ("3", "2"):
        lines = ok("sample", "prag", "-n", length, "--count", "20", "--format", "jsonl", "--no-physics")
        file.write_text((file.read_text() if file.exists() else "") + lines)
    return str(file)


def test_json_holds_exact_figures(given: str) -> None:
    done = run("diversity", "prag", "-n", "3", "--tasks", given, "--format", "json")
    found, pairs = json.loads(done.stdout), hamming_distribution(SPACE)
    assert found["distance"]["pairs"] == list(pairs.pairs) and Fraction(found["distance"]["mean"]) == pairs.mean
    assert found["vendi"]["names"]["space"] == pytest.approx(vendi_score(SPACE, feature="names").score)
    assert (found["tasks"], found["given"]) == (SPACE.count(), 20)
    test = compare_frequencies(SPACE, list(SPACE.sample(20, seed=0, weights={})), "pairs")
    assert found["frequencies"]["pairs"]["degrees"] == test.degrees
    assert "20 tasks of other lengths left out" in done.stderr


def test_tables_have_a_row_for_each_distance_and_feature(given: str) -> None:
    text = ok("diversity", "prag", "-n", "3", "--tasks", given)
    for heading in ("distance", "Vendi score", "actions", "classes", "names", "pairs", "mean Hamming distance"):
        assert any(line.startswith(heading) for line in text.splitlines())
    assert text.count("degrees of freedom, p = ") == 4 and "fewer than 5 times" in text
    assert "distance" not in ok("diversity", "prag", "-n", "3", "--no-distances", "--feature", "names")


def test_neighbours_are_printed_with_a_nearest_task(tmp_path: Path) -> None:
    text = ok("diversity", "prag", "-n", "3", "--near", PLAN, "--radius", "2")
    numbers = count_neighbours(SPACE, PLAN.split(), 2)
    assert [line.split() for line in text.splitlines()[1:4]] == [[str(k), str(n)] for k, n in enumerate(numbers)]
    assert text.splitlines()[-1] == f"nearest, 0 edits: {PLAN}"
    ok("diversity", "prag", "-n", "3", "--near", PLAN, "--format", "json", "-o", str(tmp_path / "near.json"))
    assert json.loads((tmp_path / "near.json").read_text())["nearest"] == {"distance": 0, "plan": PLAN.split()}


def test_the_empty_task_has_neighbours_too() -> None:
    text = ok("diversity", "prag", "-n", "1", "--near", "", "--radius", "1")
    assert text.splitlines()[1:3] == ["0          0", f"1      {TaskSpace(load_domain('prag'), 1).count():5}"]


@pytest.mark.parametrize(
    ("arguments", "refused"),
    [
        (("prag", "-n", "3", "--near", PLAN, "--tasks", "x"), "give --near or --tasks"),
        (("prag", "-n", "3", "--radius", "2"), "give --near"),
        (("prag", "-n", "4", "--tasks", "GIVEN"), "no task of length 4; choose a length that it has"),
        (("blocks", "-n", "3", "--tasks", "GIVEN"), "it is read as one of 'blocks'"),
        (("prag", "-n", "3", "--where", "has at least 4 grasp"), "there is no task of prag of length 3"),
    ],
)
def test_what_cannot_be_measured_is_refused(arguments: tuple[str, ...], refused: str, given: str) -> None:
    done = run("diversity", *(given if each == "GIVEN" else each for each in arguments))
    assert done.returncode == 2 and refused in done.stderr and done.stderr.count("\n") == 1
