"""`prag-asp stats`, and the options of weights that it shares with `sample`."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from tests.commands import ok, run

SPACE = TaskSpace(load_domain("prag"), 3)


def test_tables_hold_the_decimals_of_the_exact_figures() -> None:
    text = ok("stats", "prag", "-n", "3", "--weight", "grasp=3")
    found = SPACE.statistics(weights={"grasp": 3})
    lines = {" ".join(line.split()[:-1]): line.split()[-1] for line in text.splitlines() if line}
    assert lines["tasks of length 3 that can be sampled"] == "2092"
    assert abs(float(lines["entropy, bits"]) - float(found.entropy)) < 1e-11
    assert abs(Fraction(lines["grasp > move"]) - found.expected_pairs["grasp", "move"]) <= Fraction(1, 2 * 10**6)
    assert abs(Fraction(lines["can_1"]) - found.contains_entity["can_1"]) <= Fraction(1, 2 * 10**6)
    widths = {len(line) for line in text.split("\n\n")[1].splitlines()}
    assert len(widths) == 1


def test_json_holds_the_exact_figures(tmp_path: Path) -> None:
    file = tmp_path / "figures.json"
    arguments = ("stats", "prag", "-n", "3", "--temperature", "1/2", "--weight", "grasp=3", "--format", "json")
    assert ok(*arguments, "-o", str(file)) == ""
    told = json.loads(file.read_text())
    found = SPACE.statistics(weights={"grasp": 9})
    assert told["words"] == 2092 and Fraction(told["total_weight"]) == found.total_weight
    assert told["entropy"] == str(found.entropy)
    assert {key: Fraction(share) for key, share in told["expected_names"].items()} == found.expected_names
    assert Fraction(told["expected_pairs"]["grasp>move"]) == found.expected_pairs["grasp", "move"]


def test_a_count_of_hundreds_of_digits_is_shown_short() -> None:
    text = ok("stats", "prag", "-n", "300", "--by", "skeleton")
    assert "e+" in text and max(map(len, text.splitlines())) < 80


def test_the_curve_is_written_beside_the_figures(tmp_path: Path) -> None:
    for name in ("curve.html", "curve.png", "curve.svg", "curve.pdf"):
        ok("stats", "prag", "-n", "3", "--plot", str(tmp_path / name))
        assert (tmp_path / name).stat().st_size > 10_000


def test_sample_draws_at_a_temperature_and_over_goals(tmp_path: Path) -> None:
    arguments = ("sample", "prag", "-n", "3", "--no-physics", "--count", "5", "--weight", "grasp=3")
    cold, hot, over = (ok(*arguments, *more) for more in (("--temperature", "1/9"), (), ("--over", "goals")))
    words = [str(task) for task in SPACE.sample(5, seed=0, weights={"grasp": 3}, over="goals")]
    assert over.splitlines() == words and len({cold, hot, over}) == 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["stats", "prag", "-n", "3", "--plot", "curve.txt"], "ends in .html, .png, .svg or .pdf"),
        (["stats", "prag", "-n", "3", "--temperature", "0"], "above 0"),
        (["stats", "prag", "-n", "3", "--by", "skeleton", "--weight", "grasp=2"], "skeletons have no weights"),
        (["stats", "prag", "-n", "3", "--weight", "panda=0"], "all 2092 weigh 0"),
        (["sample", "prag", "-n", "3", "--over", "stars"], "Invalid value for '--over'"),
    ],
)
def test_bad_input_is_answered_by_a_line(arguments: list[str], words: str) -> None:
    done = run(*arguments)
    assert words in done.stderr and "Traceback" not in done.stderr
    assert done.stdout == "" and done.returncode == (64 if words.startswith("Invalid value") else 2)
