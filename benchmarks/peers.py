"""Compare exact counting and sampling with other tools: python benchmarks/peers.py --limit 60.

Install the other tools with: pip install pyganak d4solver tididi-cnf pyapproxmc pyunigen pycmsgen. A tool that
is missing, fails or exceeds the limit is shown as '-', with the reason below the table. Seconds are processor time.
Exits with code 1 if two exact counts differ, or if the automaton is less than 10,000 times as fast as clingo at length
15.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory

import click
from peers_counting import ENUMERATORS
from peers_counting import TOOLS as COUNTERS
from peers_process import Run, measured
from peers_sampling import TOOLS as SAMPLERS
from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain

HERE = Path(__file__).parent
TRANSPORT = HERE / "transport"
QUESTIONS = (("plan", 7), ("plan", 11), ("plan", 15), ("plan", 30), ("skeleton", 15))
REQUIRED = Fraction(10_000)
SAMPLED_LENGTH = 5
"""With 2 objects and 2 places, the domain has 1,250 plans of this length."""


@dataclass(frozen=True)
class Cell:
    """The measured or extrapolated time of a tool for a count; or why it has none."""

    seconds: float | None
    count: int | None = None
    failure: str = ""
    estimated_from: int | None = None


def main_table(limit: float) -> tuple[Table, list[str], list[str]]:
    """Return the table of counting, the reasons for missing results, and the faults."""
    table = Table("", "count", *COUNTERS, title="counting, processor seconds (times the automaton's)")
    reasons: list[str] = []
    faults: list[str] = []
    enumerated: dict[tuple[str, str], Run] = {}
    for level, length in QUESTIONS:
        cells = {}
        for tool in COUNTERS:
            print(f"{level}s of length {length}: {tool}", file=sys.stderr)  # noqa: T201
            if tool not in ENUMERATORS:
                cells[tool] = _counted(measured(HERE / "peers_counting.py", [tool, *_arguments(level, length)], limit))
                continue
            if (tool, level) not in enumerated:
                longest = max(number for kind, number in QUESTIONS if kind == level)
                arguments = [tool, *_arguments(level, longest)]
                enumerated[tool, level] = measured(HERE / "peers_counting.py", arguments, limit)
            cells[tool] = _extrapolated(enumerated[tool, level], level, length, faults)
        ours = cells["automaton"]
        if ours.count is None or not ours.seconds:
            raise SystemExit(f"the automaton did not count {level}s of length {length}: {ours.failure}")
        for tool, cell in cells.items():
            if tool != "approxmc" and cell.count not in (None, ours.count):
                faults.append(f"{level}s of length {length}: {tool} counts {cell.count:,}, automaton {ours.count:,}")
            if cell.failure:
                reasons.append(f"{tool}, {level}s of length {length}: {cell.failure}")
        table.add_row(
            f"{level}s, n = {length}", f"{ours.count:,}" if ours.count < 10**15 else f"{ours.count:.1e}",
            *(_shown(cell, ours, tool) for tool, cell in cells.items()),
        )  # fmt: skip
        clingo = cells["clingo"].seconds
        if (level, length) == ("plan", 15) and (clingo is None or Fraction(clingo) < REQUIRED * Fraction(ours.seconds)):
            faults.append("the automaton is less than 10,000 times as fast as clingo at length 15")
    return table, reasons, faults


def _arguments(level: str, length: int) -> list[str]:
    return [str(TRANSPORT), level, str(length)]


def _counted(run: Run) -> Cell:
    if not run.results:
        return Cell(None, failure=run.failure)
    return Cell(run.results[-1]["seconds"], run.results[-1]["count"])


def _extrapolated(run: Run, level: str, length: int, faults: list[str]) -> Cell:
    """Return the time of an enumerator; extrapolated from its longest finished length if it did not finish this one."""
    for result in run.results:
        if result["length"] == length:
            return Cell(result["seconds"], result["count"])
    if not run.results:
        return Cell(None, failure=run.failure)
    longest = run.results[-1]
    space = TaskSpace(load_domain(TRANSPORT), longest["length"], engine="automaton")
    if space.count(level) != longest["count"]:  # type: ignore[arg-type]
        faults.append(f"{level}s of length {longest['length']}: an enumerator counts {longest['count']:,}")
    ratio = Fraction(space.at(length).count(level), longest["count"])  # type: ignore[arg-type]
    return Cell(float(Fraction(longest["seconds"]) * ratio), estimated_from=longest["length"])


def _shown(cell: Cell, ours: Cell, tool: str) -> str:
    if cell.seconds is None or ours.seconds is None:
        return "-"
    seconds = f"{cell.seconds:.3f}" if cell.seconds < 1 else f"{cell.seconds:,.1f}"
    if cell.seconds >= 10**6:
        seconds = f"{cell.seconds:.1e}"
    if tool == "automaton":
        return seconds
    ratio = cell.seconds / ours.seconds
    times = f"{ratio:,.0f}x" if ratio < 10**6 else f"{ratio:.0e}x"
    note = f"\nfrom n = {cell.estimated_from}" if cell.estimated_from else ""
    if tool == "approxmc" and cell.count is not None and ours.count:
        note = f"\n{float(Fraction(cell.count, ours.count) - 1):+.1%}"
    return f"{'~' if cell.estimated_from else ''}{seconds} ({times}){note}"


def sampling_table(limit: float, draws: int) -> tuple[Table, list[str]]:
    """Return the table of sampling, and the reasons for missing results."""
    table = Table("", "samples", "samples/s", "chi2/df", title="sampling 1,250 plans; chi2/df is 1 for uniform samples")
    reasons = []
    with TemporaryDirectory() as folder:
        text = (TRANSPORT / "domain.lp").read_text(encoding="utf-8")
        (Path(folder) / "domain.lp").write_text(text.replace("#const objects = 3.", "#const objects = 2."))
        for tool in SAMPLERS:
            print(f"sampling: {tool}", file=sys.stderr)  # noqa: T201
            arguments = [tool, folder, str(SAMPLED_LENGTH), str(draws)]
            run = measured(HERE / "peers_sampling.py", arguments, limit)
            if run.results:
                last = run.results[-1]
                rate = last["draws"] / max(last["seconds"], 1e-9)
                table.add_row(tool, f"{last['draws']:,}", f"{rate:,.0f}", f"{last['spread']:.2f}")
            else:
                table.add_row(tool, "-", "-", "-")
                reasons.append(f"{tool}: {run.failure}")
    return table, reasons


@click.command()
@click.option("--limit", type=float, default=60, show_default=True, help="Processor seconds for each tool and count.")
@click.option("--draws", type=int, default=12_500, show_default=True, help="Number of samples of each tool.")
def main(limit: float, draws: int) -> None:
    """Print the tables of counting and of sampling, and the reasons for missing results."""
    console = Console(width=None if sys.stdout.isatty() else 160)
    table, reasons, faults = main_table(limit)
    sampling, more = sampling_table(limit, draws)
    for shown in (table, sampling):
        console.print(shown)
    for reason in (*reasons, *more):
        console.print(f"- {reason}", highlight=False)
    for fault in faults:
        console.print(f"FAULT: {fault}", highlight=False)
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
