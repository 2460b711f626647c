"""The figures of the page on learning are those of the rows that are kept in benchmarks/learning/results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import pyarrow.parquet as pq
import pytest

from prag_asp.rl import Rate
from tests.docs.pages import DOCS, ROOT

RESULTS = ROOT / "benchmarks" / "learning" / "results"
TEXT = (DOCS / "guides" / "learning.md").read_text(encoding="utf-8")
TOLD = " ".join(TEXT.split())

Row = dict[str, Any]


def kept(name: str, **asked: Any) -> list[Row]:
    """Return the rows of a file with some values."""
    rows: list[Row] = pq.read_table(RESULTS / f"{name}.parquet").to_pylist()
    return [row for row in rows if asked.items() <= row.items()]


def last(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of the last test of each seed."""
    return [row for row in rows if row["step"] == max(each["step"] for each in rows)]


def together(rows: Sequence[Row], what: str = "successes", of: str = "trials") -> str:
    """Return the share of all rows with its interval, as the page has it."""
    return percent(Rate(sum(row[what] for row in rows), sum(row[of] for row in rows)))


def percent(rate: Rate) -> str:
    """Return a share with its interval, without the counts."""
    return str(rate).partition(";")[0] + ")"


def each(rows: Sequence[Row], what: str = "successes") -> str:
    """Return the share of each seed."""
    return ", ".join(f"{row[what] / row['trials']:.2f}" for row in rows)


def cells(begin: str) -> list[str]:
    """Return the cells of the one row of a table that begins so, without the first."""
    (found,) = [line for line in TEXT.splitlines() if line.startswith(f"| {begin} |")]
    return [cell.strip() for cell in found.strip("|").split("|")[1:]]


CURVES = [
    ("approach", "dense", "approach, dense", "5,000 steps"),
    ("approach", "sparse", "approach, sparse", "5,000 steps"),
    ("approach", "faded", "approach, faded with success", "5,000 steps"),
    ("grasp", "dense", "grasp, from the object, dense", "8,000 steps"),
]


@pytest.mark.parametrize(("skill", "reward", "kind", "steps"), CURVES)
def test_the_curves_are_those_that_are_kept(skill: str, reward: str, kind: str, steps: str) -> None:
    rows = [row for row in kept(skill, reward=reward) if row["seed"] < 3]
    ends = last(rows)
    assert {row["seed"] for row in ends} == {0, 1, 2} and {f"{row['step']:,} steps" for row in ends} == {steps}
    seconds = sum(row["processor_seconds"] for row in ends) / 3
    assert cells(f"{kind}, {steps}") == [f"{each(ends)} of 30", together(ends), f"{seconds:.0f} s"]
    found = [kept("fresh", skill=skill, reward=reward, length=length) for length in (2, 3)]
    assert {len(rows) for rows in found} == {3}
    assert cells(kind) == [cell for rows in found for cell in (f"{each(rows)} of 30", together(rows))]


def test_where_episodes_begin_is_told_as_it_is_kept() -> None:
    for name, begin in {
        "last": "with the grasp",
        "task": "at home",
        "any": "at a uniformly sampled stage",
        "backwards": "progressively nearer to home",
    }.items():
        rows = last(kept(f"grasp_from_{name}", reward="dense"))
        assert len(rows) == 3 and cells(begin) == [together(rows), together(rows, "whole")]
    assert f"completed {', '.join(str(row['whole']) for row in rows[:2])} and {rows[2]['whole']}" in TOLD


def test_the_whole_pick_is_told_as_it_is_kept() -> None:
    ends = {"witnesses": "witness states", "where the approach ends": "final states of the approach"}
    for whence, begin in ends.items():
        rows = last(kept("parts", skill="grasp", learned_from=whence))
        approached, held = (sum(row[what] for row in rows) for what in ("approach", "grasp"))
        expected = [f"{approached} of 90", f"{held} of {approached}", f"{each(rows, 'grasp')} of 30"]
        assert len(rows) == 3 and cells(begin) == [*expected, together(rows, "grasp")]


def test_success_against_length_is_told_as_it_is_kept() -> None:
    for length in range(1, 7):
        assert cells(str(length)) == list(shares(length))


def shares(length: int) -> Iterator[str]:
    """Yield the share of plans that came so far, of each policy."""
    for policy, count in {"oracle": 30, "learned": 90, "cloned": 90}.items():
        rows = kept("chained", policy=policy)
        assert len(rows) == count
        yield percent(Rate(sum(row["reached"] >= length for row in rows), count))


def test_what_the_text_says_is_what_is_kept() -> None:
    unseen = kept("fresh_unseen_box_1", length=2)
    reached = [f"{row['successes'] / row['trials']:.2f}" for row in unseen]
    assert f"box in {', '.join(reached[:2])} and {reached[2]} of 30 new witnesses" in TOLD
    assert f"together {together(unseen)}" in TOLD
    picks = last(kept("pick", reward="dense"))
    successes = [str(row["successes"]) for row in picks]
    assert f"reached {' and '.join(successes)} of 30 held-out witnesses after {picks[0]['step']:,} steps" in TOLD
    assert f"steps, {together(picks)}" in TOLD
    later = [row["successes"] for row in kept("grasp", reward="dense") if row["step"] >= 2000]
    assert "at least 28 at any test from step 2,000 on" in TOLD and min(later) >= 28
