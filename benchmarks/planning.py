"""Compare counting plans of competition tasks with other tools: python benchmarks/planning.py CHECKOUT.

CHECKOUT is a copy of the public collection aibasel/downward-benchmarks. From each family of an optimal track it takes
the first tasks whose shortest plan Fast Downward (up-fast-downward) finds within the limit, and counts the plans of
that length and of one and a half times that length. Install the other tools with: pip install kstar-planner pyganak. A
tool that is missing, fails or exceeds the limit has no count and is not run on longer plans; if it exceeds the limit on
a count that ours finishes, its time is a lower bound. K* works on the translated task of Fast Downward, without actions
that are irrelevant for the goal, and so has fewer longer plans; these counts are not compared. Seconds are processor
time, actions cost 1, and the memory limit is 4 GB. With --answers FILE, results are saved in FILE and reused: a run can
be interrupted, resumed, and extended by more tasks or a higher limit. Exits with code 1 if two counts differ, or if the
count of the shortest plans is 0.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import click
from peers_process import measured
from planning_answers import UNFINISHED, Answer, Answers
from planning_tasks import PlanningTask, first_tasks, with_unit_costs
from rich.console import Console
from rich.table import Table

SCRIPT = Path(__file__).parent / "peers_planning.py"
OURS = "prag_asp"
PEERS = ("kstar", "pyganak", "clingo")
TOOLS = (OURS, *PEERS)
MANY = 1000
"""The number of plans that separates the two groups of the summary."""


@dataclass(frozen=True)
class Row:
    """The answers of the tools for a task and a length; `shortest` is the length of its shortest plan."""

    task: str
    length: int
    shortest: int
    answers: Mapping[str, Answer]

    @property
    def counts(self) -> list[int]:
        """The distinct counts, except those of longer plans by K*."""
        comparable = (tool for tool in self.answers if tool != "kstar" or self.length == self.shortest)
        return sorted({count for tool in comparable if (count := self.answers[tool].count) is not None})

    @property
    def wrong(self) -> bool:
        """Whether two counts differ, or the count of the shortest plans is 0."""
        return len(self.counts) > 1 or (self.length == self.shortest and 0 in self.counts)

    def counted(self, tool: str) -> bool:
        """Return whether a tool has a count."""
        return tool in self.answers and self.answers[tool].count is not None

    def times(self, peer: str) -> float | None:
        """Return the time of a tool relative to ours: a lower bound at the limit; None if it failed otherwise."""
        theirs, ours = self.answers[peer], self.answers[OURS]
        if theirs.count is None and not theirs.failure.startswith(UNFINISHED):
            return None
        return (theirs.limit if theirs.count is None else theirs.seconds) / ours.seconds

    def cells(self) -> list[str]:
        """Return the cells of the table: the task, the length, the count and the seconds of each tool."""
        counts = " or ".join(f"{count:,}" if count < 10**15 else f"{count:.1e}" for count in self.counts)
        seconds = (
            ("" if tool not in self.answers else f"{self.answers[tool].seconds:.2f}" if self.counted(tool) else "-")
            for tool in TOOLS
        )
        return [self.task, str(self.length), counts, *seconds]


@dataclass(frozen=True)
class Runner:
    """Runs `tools` on tasks, each with a time limit; for other tools it looks up saved answers."""

    answers: Answers
    tools: frozenset[str]
    limit: float
    folder: Path

    def rows(self, task: PlanningTask) -> Iterator[Row]:
        """Yield the answers for both lengths; nothing if the length of the shortest plan is unknown."""
        plain = with_unit_costs(task, self.folder)
        answer = self._answer("shortest", plain, 0, 0)
        shortest = answer.count if answer else None
        if not shortest:
            return
        answers: dict[str, Answer] = {}
        for length in dict.fromkeys([shortest, shortest * 3 // 2]):
            for tool in TOOLS:
                if tool in answers and answers[tool].count is None:
                    answers[tool] = replace(answers[tool], length=length)
                elif (answer := self._answer(tool, plain, length, shortest)) is not None:
                    answers[tool] = answer
                else:
                    answers.pop(tool, None)
            yield Row(task.name, length, shortest, dict(answers))

    def _answer(self, tool: str, task: PlanningTask, length: int, shortest: int) -> Answer | None:
        words = [tool, str(task.domain), str(task.problem), str(length), str(shortest)]
        run = partial(measured, SCRIPT, words, self.limit) if tool in self.tools else None
        return self.answers.get(task.name, tool, length, self.limit, run)


def summary(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the summary lines for each kind of length: ours, then each other tool compared with ours."""
    for first, kind in ((True, "shortest plans"), (False, "half as long again")):
        some = [row for row in rows if (row.length == row.shortest) == first and OURS in row.answers]
        if not some:
            continue
        accepted, counted = (sum(row.answers[OURS].accepted for row in some), sum(row.counted(OURS) for row in some))
        yield f"{kind}: {len(some)} tasks, {accepted / len(some):.1%} accepted, {counted / len(some):.1%} counted"
        for peer in PEERS:
            yield from (f"{kind}: {line}" for line in _beside(peer, [row for row in some if peer in row.answers]))


def _beside(peer: str, rows: Sequence[Row]) -> Iterator[str]:
    """Yield the comparison of a tool and ours on the tasks on which the tool was run."""
    if not rows:
        return
    theirs, ours = (sum(row.counted(tool) for row in rows) for tool in (peer, OURS))
    yield f"{peer} counts {theirs} of {len(rows)}, ours {ours}"
    both = [row for row in rows if row.counted(peer) and row.counted(OURS)]
    few = {row.task for row in both if row.counts[0] <= MANY}
    kinds = {
        "all": both,
        f"up to {MANY:,} plans": [row for row in both if row.task in few],
        f"more than {MANY:,} plans": [row for row in both if row.task not in few],
    }
    for kind, some in kinds.items():
        if some:
            times = median(row.answers[peer].seconds / row.answers[OURS].seconds for row in some)
            yield f"{peer} takes {times:.1f} times our seconds, in the median of the {len(some)} counts of both, {kind}"
    counted = [row for row in rows if row.counted(OURS)]
    least = [times for row in counted if (times := row.times(peer)) is not None]
    if least:
        bound = (
            f"{peer} takes at least {median(least):.1f} times our seconds, in the median of {len(least)} counts of ours"
        )
        yield f"{bound}; for {len(counted) - len(least)} others there is no time"


@click.command()
@click.argument("checkout", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option(
    "--family", "families", multiple=True, help="Family of tasks (repeatable); by default all of the optimal tracks."
)
@click.option("--first", default=5, show_default=True, help="Tasks of each family.")
@click.option("--limit", type=float, default=60, show_default=True, help="Processor seconds for each tool and count.")
@click.option(
    "--peer",
    "peers",
    multiple=True,
    type=click.Choice([*PEERS, "none"]),
    help="Tool to compare with (repeatable); by default all.",
)
@click.option("--answers", "path", type=click.Path(dir_okay=False, path_type=Path), help="File of saved answers.")
@click.option("--ask/--look", default=True, help="Run the tools, or show saved answers only.")
def main(
    checkout: Path, families: tuple[str, ...], first: int, limit: float, peers: tuple[str, ...], path: Path, ask: bool
) -> None:
    """Print a table of counts and seconds, the failures with their reasons, and a summary."""
    tools = frozenset(["shortest", OURS, *(peers or PEERS)] if ask else [])
    with TemporaryDirectory() as folder:
        runner = Runner(Answers(path), tools, limit, Path(folder))
        rows: list[Row] = []
        for task in first_tasks(checkout.resolve(), families, first):
            for row in runner.rows(task):
                rows.append(row)
                print(*row.cells(), sep="  ", file=sys.stderr, flush=True)  # noqa: T201
    show(sorted(rows, key=lambda row: row.task))
    sys.exit(any(row.wrong for row in rows))


def show(rows: Sequence[Row]) -> None:
    """Print a table of all rows and their summary."""
    console = Console(width=None if sys.stdout.isatty() else 160, highlight=False)
    table = Table("task", "length", "plans", *TOOLS)
    for row in rows:
        table.add_row(*row.cells())
    console.print(table)
    for row in rows:
        ours = row.answers.get(OURS)
        if ours and ours.count is None:
            console.print(f"- {row.task}, length {row.length}: {ours.failure}", markup=False)
    for line in summary(rows):
        console.print(line)
    for row in rows:
        if row.wrong:
            console.print(f"FAULT: {row.task}, shortest {row.shortest}, has at length {row.length} plans: {row.counts}")


if __name__ == "__main__":
    main()
