"""Tasks of the planning competitions beside the tools that others use: python benchmarks/planning.py CHECKOUT.

CHECKOUT is a copy of the public collection aibasel/downward-benchmarks. Of each family the first tasks are taken whose
shortest plan Fast Downward finds (up-fast-downward); their plans of that length, and of one and a half times it, are
counted. The peers are installed by: pip install kstar-planner pyganak. A peer that is missing, fails or takes longer
than the limit has not counted; K* lists shortest plans alone. Seconds are of processor time, actions cost 1. It ends
with code 1 where two counts differ.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import click
from peers_process import Run, measured
from rich.console import Console
from rich.table import Table

SCRIPT = Path(__file__).parent / "peers_planning.py"
PEERS = ("kstar", "pyganak", "clingo")
TOOLS = ("prag_asp", *PEERS)
COMMENT = re.compile(r";[^\n]*")
METRIC = re.compile(r"\(\s*:metric\b", re.IGNORECASE)


@dataclass(frozen=True)
class Question:
    """A task, a number of actions, and whether no plan is shorter."""

    name: str
    domain: Path
    problem: Path
    length: int
    shortest: bool


@dataclass(frozen=True)
class Answer:
    """What one tool says of a question; without a count, why not."""

    count: int | None
    seconds: float
    accepted: bool
    failure: str

    @classmethod
    def of(cls, run: Run) -> Answer:
        """Return what a run has told."""
        last = run.results[-1] if run.results else {}
        return cls(last.get("count"), last.get("seconds", 0.0), bool(run.results), run.failure)


def tasks(family: Path) -> Iterator[tuple[Path, Path]]:
    """Yield the domain and the problem of each task of a family, in the order of their numbers."""
    files = sorted(family.glob("*.pddl"), key=lambda path: (list(map(int, re.findall(r"\d+", path.stem))), path.name))
    for problem in files:
        own = (
            f"domain_{problem.name}",
            f"{problem.stem}-domain.pddl",
            f"{problem.stem[:3]}-domain.pddl",
            "domain.pddl",
        )
        found = next((family / name for name in own if (family / name).is_file()), None)
        if found and "domain" not in problem.name:
            yield found, problem


def without_metric(text: str) -> str:
    """Return a problem without its metric, so that each action costs 1."""
    text = COMMENT.sub("", text)
    found = METRIC.search(text)
    if not found:
        return text
    depth, end = 1, found.end()
    while depth:
        depth += {"(": 1, ")": -1}.get(text[end], 0)
        end += 1
    return text[: found.start()] + text[end:]


def questions(checkout: Path, families: Sequence[str], first: int, limit: float, folder: Path) -> Iterator[Question]:
    """Yield the tasks whose shortest plan is found, each with two lengths."""
    for name in families or sorted(path.name for path in checkout.iterdir() if any(path.glob("*.pddl"))):
        for domain, problem in islice(tasks(checkout / name), first):
            plain = folder / f"{name}-{problem.name}"
            plain.write_text(without_metric(problem.read_text(errors="replace")))
            length = Answer.of(measured(SCRIPT, ["shortest", str(domain), str(plain), "0"], limit)).count
            if length:
                yield Question(f"{name}/{problem.stem}", domain, plain, length, shortest=True)
                if length > 1:
                    yield Question(f"{name}/{problem.stem}", domain, plain, length * 3 // 2, shortest=False)


def asked(question: Question, peers: Sequence[str], limit: float) -> dict[str, Answer]:
    """Return what each tool says of a question."""
    words = [str(question.domain), str(question.problem), str(question.length)]
    chosen = [
        tool for tool in TOOLS if tool == "prag_asp" or (tool in peers and (question.shortest or tool != "kstar"))
    ]
    return {tool: Answer.of(measured(SCRIPT, [tool, *words], limit)) for tool in chosen}


def row(question: Question, answers: dict[str, Answer]) -> list[str]:
    """Return a row of the table: the task, the length, the count and the seconds of each tool."""
    counts = sorted({answer.count for answer in answers.values() if answer.count is not None})
    told = " or ".join(f"{count:,}" if count < 10**15 else f"{count:.1e}" for count in counts)
    seconds = (f"{answers[t].seconds:.2f}" if t in answers and answers[t].count is not None else "-" for t in TOOLS)
    return [question.name, str(question.length), told, *seconds]


def summary(found: Sequence[tuple[Question, dict[str, Answer]]]) -> Iterator[str]:
    """Yield what all tasks together say, a line for each kind of length and each peer."""
    for kind, told in ((True, "shortest"), (False, "half as long again")):
        rows = [answers for question, answers in found if question.shortest == kind]
        if not rows:
            continue
        accepted, counted = (
            sum(each["prag_asp"].accepted for each in rows),
            sum(each["prag_asp"].count is not None for each in rows),
        )
        yield f"{told}: {len(rows)} tasks, {accepted / len(rows):.0%} accepted, {counted / len(rows):.0%} counted"
        for peer in PEERS:
            theirs = [each for each in rows if peer in each and each[peer].count is not None]
            both = [
                each[peer].seconds / each["prag_asp"].seconds for each in theirs if each["prag_asp"].count is not None
            ]
            if theirs:
                times = f"; its seconds are {median(both):.1f} times ours in the median of both" if both else ""
                yield f"{told}: {peer} counts {len(theirs) / len(rows):.0%}{times}"


@click.command()
@click.argument("checkout", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--family", "families", multiple=True, help="Family to take; all of them, unless given.")
@click.option("--first", default=5, show_default=True, help="Tasks of each family.")
@click.option(
    "--limit", type=float, default=60, show_default=True, help="Processor seconds for each tool and question."
)
@click.option(
    "--peer", "peers", multiple=True, default=PEERS, type=click.Choice(PEERS), help="Peer to ask; all of them."
)
def main(checkout: Path, families: tuple[str, ...], first: int, limit: float, peers: tuple[str, ...]) -> None:
    """Print a table of counts and seconds, what is refused and why, and what all tasks together say."""
    console = Console(width=None if sys.stdout.isatty() else 160)
    table = Table("task", "length", "plans", *TOOLS)
    found: list[tuple[Question, dict[str, Answer]]] = []
    with TemporaryDirectory() as folder:
        for question in questions(checkout.resolve(), families, first, limit, Path(folder)):
            found.append((question, asked(question, peers, limit)))
            table.add_row(*row(*found[-1]))
            print(*row(*found[-1]), file=sys.stderr)  # noqa: T201
    console.print(table)
    for question, answers in found:
        ours = answers["prag_asp"]
        if ours.count is None:
            console.print(f"- {question.name}, length {question.length}: {ours.failure}", highlight=False)
    for line in summary(found):
        console.print(line, highlight=False)
    faults = [q for q, a in found if len({each.count for each in a.values() if each.count is not None}) > 1]
    for question in faults:
        console.print(f"FAULT: counts of {question.name} at length {question.length} differ", highlight=False)
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
