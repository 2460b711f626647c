"""Tasks of the planning competitions beside the tools that others use: python benchmarks/planning.py CHECKOUT.

CHECKOUT is a copy of the public collection aibasel/downward-benchmarks. Of each family of an optimal track the first
tasks are taken whose shortest plan Fast Downward finds (up-fast-downward) within the limit; their plans of that length,
and of one and a half times it, are counted. The peers are installed by: pip install kstar-planner pyganak. A peer that
is missing, fails or takes longer than the limit has not counted, and is not asked for longer plans. Where its time ran
out on what ours counts, it takes at least so many times our seconds. K* works on what
Fast Downward's translation leaves of a task, without the actions that change nothing of use for the goal: so it has
fewer of the longer plans, and those numbers are not compared. Seconds are of processor time, actions cost 1, and each
tool has 4 GB. With --answers FILE, what is known stays there, and is not asked again: a run may be broken off, go on,
take more tasks or a higher limit. It ends with code 1 where two counts differ, or one is 0 for the shortest plans.
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
"""Plans beyond which counting is held to be another question than listing."""


@dataclass(frozen=True)
class Row:
    """What the tools say of a task and a length; no plan is shorter than `shortest`."""

    task: str
    length: int
    shortest: int
    answers: Mapping[str, Answer]

    @property
    def counts(self) -> list[int]:
        """The different counts, but those of longer plans by K*."""
        comparable = (tool for tool in self.answers if tool != "kstar" or self.length == self.shortest)
        return sorted({count for tool in comparable if (count := self.answers[tool].count) is not None})

    @property
    def wrong(self) -> bool:
        """Whether two counts differ, or one does not know of the shortest plan."""
        return len(self.counts) > 1 or (self.length == self.shortest and 0 in self.counts)

    def counted(self, tool: str) -> bool:
        """Tell whether a tool has counted."""
        return tool in self.answers and self.answers[tool].count is not None

    def times(self, peer: str) -> float | None:
        """Return how many times our seconds a peer takes, at least where its time ran out; None where it gave up."""
        theirs, ours = self.answers[peer], self.answers[OURS]
        if theirs.count is None and not theirs.failure.startswith(UNFINISHED):
            return None
        return (theirs.limit if theirs.count is None else theirs.seconds) / ours.seconds

    def cells(self) -> list[str]:
        """Return the cells of the table: the task, the length, the count and the seconds of each tool."""
        told = " or ".join(f"{count:,}" if count < 10**15 else f"{count:.1e}" for count in self.counts)
        seconds = (
            ("" if tool not in self.answers else f"{self.answers[tool].seconds:.2f}" if self.counted(tool) else "-")
            for tool in TOOLS
        )
        return [self.task, str(self.length), told, *seconds]


@dataclass(frozen=True)
class Asking:
    """Asks tools of tasks, each within a limit; of those that are not `asked`, what is known is looked up."""

    answers: Answers
    asked: frozenset[str]
    limit: float
    folder: Path

    def rows(self, task: PlanningTask) -> Iterator[Row]:
        """Yield what the tools say of the plans of both lengths; nothing where it is not known which is the first."""
        plain = with_unit_costs(task, self.folder)
        found = self._answer("shortest", plain, 0, 0)
        shortest = found.count if found else None
        if not shortest:
            return
        said: dict[str, Answer] = {}
        for length in dict.fromkeys([shortest, shortest * 3 // 2]):
            for tool in TOOLS:
                if tool in said and said[tool].count is None:
                    said[tool] = replace(said[tool], length=length)
                elif (answer := self._answer(tool, plain, length, shortest)) is not None:
                    said[tool] = answer
                else:
                    said.pop(tool, None)
            yield Row(task.name, length, shortest, dict(said))

    def _answer(self, tool: str, task: PlanningTask, length: int, shortest: int) -> Answer | None:
        words = [tool, str(task.domain), str(task.problem), str(length), str(shortest)]
        ask = partial(measured, SCRIPT, words, self.limit) if tool in self.asked else None
        return self.answers.get(task.name, tool, length, self.limit, ask)


def summary(rows: Sequence[Row]) -> Iterator[str]:
    """Yield what all tasks together say, for each kind of length: of ours, then of each peer beside ours."""
    for first, told in ((True, "shortest plans"), (False, "half as long again")):
        some = [row for row in rows if (row.length == row.shortest) == first and OURS in row.answers]
        if not some:
            continue
        accepted, counted = (sum(row.answers[OURS].accepted for row in some), sum(row.counted(OURS) for row in some))
        yield f"{told}: {len(some)} tasks, {accepted / len(some):.1%} accepted, {counted / len(some):.1%} counted"
        for peer in PEERS:
            yield from (f"{told}: {line}" for line in _beside(peer, [row for row in some if peer in row.answers]))


def _beside(peer: str, rows: Sequence[Row]) -> Iterator[str]:
    """Yield how a peer and ours do on the tasks that the peer was asked of."""
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
        told = (
            f"{peer} takes at least {median(least):.1f} times our seconds, in the median of {len(least)} counts of ours"
        )
        yield f"{told}; of {len(counted) - len(least)} others it told none"


@click.command()
@click.argument("checkout", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--family", "families", multiple=True, help="Family to take; all of the optimal tracks, unless given.")
@click.option("--first", default=5, show_default=True, help="Tasks of each family.")
@click.option(
    "--limit", type=float, default=60, show_default=True, help="Processor seconds for each tool and question."
)
@click.option(
    "--peer", "peers", multiple=True, type=click.Choice([*PEERS, "none"]), help="Peer to ask; all, unless given."
)
@click.option(
    "--answers", "path", type=click.Path(dir_okay=False, path_type=Path), help="File that keeps what is known."
)
@click.option("--ask/--look", default=True, help="Ask what is not known, or tell of what is known alone.")
def main(
    checkout: Path, families: tuple[str, ...], first: int, limit: float, peers: tuple[str, ...], path: Path, ask: bool
) -> None:
    """Print a table of counts and seconds, what is refused and why, and what all tasks together say."""
    asked = frozenset(["shortest", OURS, *(peers or PEERS)] if ask else [])
    with TemporaryDirectory() as folder:
        asking = Asking(Answers(path), asked, limit, Path(folder))
        rows: list[Row] = []
        for task in first_tasks(checkout.resolve(), families, first):
            for row in asking.rows(task):
                rows.append(row)
                print(*row.cells(), sep="  ", file=sys.stderr, flush=True)  # noqa: T201
    show(sorted(rows, key=lambda row: row.task))
    sys.exit(any(row.wrong for row in rows))


def show(rows: Sequence[Row]) -> None:
    """Print a table of all rows, and what they say together."""
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
