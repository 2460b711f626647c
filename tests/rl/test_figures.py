"""The figures of the page on learning are those of the rows that are kept in benchmarks/learning/results."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pyarrow.parquet as pq
import pytest

from prag_asp.rl import Rate
from tests.docs.pages import DOCS, ROOT

RESULTS = ROOT / "benchmarks" / "learning" / "results"
TEXT = (DOCS / "guides" / "learning.md").read_text(encoding="utf-8")

Row = dict[str, Any]


def kept(name: str, **asked: Any) -> list[Row]:
    """Return the rows of a file with some values."""
    rows: list[Row] = pq.read_table(RESULTS / f"{name}.parquet").to_pylist()
    return [row for row in rows if asked.items() <= row.items()]


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


KINDS = {
    (row["skill"], row["agent"], row["reach"]) for row in pq.read_table(RESULTS / "plain.parquet").to_pylist()
}  # fmt: skip


@pytest.mark.parametrize(("skill", "agent", "reach"), sorted(KINDS))
def test_default_agents_learn_what_is_kept(skill: str, agent: str, reach: bool) -> None:
    rows = kept("plain", agent=agent, skill=skill, reach=reach)
    assert [row["seed"] for row in rows] == [*range(len(rows))] and {row["trials"] for row in rows} == {30}
    (steps,) = {row["steps"] for row in rows}
    seconds = sum(row["processor_seconds"] for row in rows) / len(rows)
    expected = [f"{steps:,}", each(rows), together(rows), f"{seconds:.0f} s"]
    environment = f"`{skill}`" + " with `ScriptedReach`" * reach
    assert cells(f"{environment} | {agent}")[1:] == expected


def test_success_of_the_oracle_against_length_is_what_is_kept() -> None:
    rows = kept("chained", policy="oracle")
    assert len(rows) == 30
    for length in range(1, 7):
        assert cells(str(length)) == [percent(Rate(sum(row["reached"] >= length for row in rows), 30))]


CLONES = pq.read_table(RESULTS / "composition.parquet").to_pylist()


def begun(rows: Sequence[Row], action: str = "") -> Rate:
    """Return how many of the actions that clones began succeeded, of all or of those whose text begins so."""
    ends = [
        number < row["reached"]
        for row in rows
        for number, each in enumerate(row["task"].split()[: row["reached"] + 1])
        if each.startswith(action)
    ]
    return Rate(sum(ends), len(ends))


@pytest.mark.parametrize(("kind", "part"), sorted({(row["kind"], row["part"]) for row in CLONES}))
def test_clones_transfer_as_is_kept(kind: str, part: str) -> None:
    rows = kept("composition", kind=kind, part=part)
    assert len(rows) == 20 and {(row["seed"], row["steps"]) for row in rows} == {(0, 3000)}
    whole = percent(Rate(sum(row["success"] for row in rows), len(rows)))
    assert cells(f"`{kind}` | `{part}`")[1:3] == [whole, percent(begun(rows))]


def test_actions_that_clones_cannot_do_are_those_that_are_kept() -> None:
    unseen, pairs = (kept("composition", kind="objects", part=part) for part in ("unseen_objects", "unseen_pairs"))
    text = " ".join(TEXT.split())
    for rate, words in (
        (begun(unseen, "pick(panda,can_1"), "picks of the can succeeded"),
        (begun(pairs, "stack"), "stacks succeeded"),
    ):
        assert f"{rate.successes} of {rate.trials} {words}" in text
