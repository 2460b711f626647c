"""Compare counting and sampling answer sets of any program with other tools: python benchmarks/models.py --limit 120.

Install the other tools with: pip install pyganak d4solver aspmc pyunigen pycmsgen. A tool that is missing, fails
or exceeds the limit is shown as '-', with the reason below the table. Seconds are processor time of the process and its
children. Exits with code 1 if two counts differ.
"""

from __future__ import annotations

import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import click
from peers_models import COUNTERS, ENUMERATED, INDEPENDENT, OURS, PROGRAMS, SAMPLERS
from peers_process import measured, timed
from rich.console import Console
from rich.table import Table

from prag_asp import answer_sets

SCRIPT = Path(__file__).with_name("peers_models.py")
SAMPLES = 20_000


def counting(limit: float) -> tuple[Table, list[str], list[str]]:
    """Return the table of counting, the reasons for missing results, and the faults."""
    table = Table("program", "answer sets", *(f"{tool}, s" for tool in COUNTERS), "times faster than clingo")
    reasons, faults = list[str](), list[str]()
    for program in PROGRAMS:
        runs = {tool: measured(SCRIPT, [tool, program], limit) for tool in COUNTERS}
        results: dict[str, Any] = {tool: run.results[-1] for tool, run in runs.items() if run.results}
        reasons += [f"{tool}, {program}: {run.failure}" for tool, run in runs.items() if tool not in results]
        if OURS not in results:
            raise SystemExit(f"{program} is not counted: {runs[OURS].failure}")
        count = int(results[OURS]["count"])
        seconds = {tool: Fraction(each["seconds"]) for tool, each in results.items()}
        for tool, each in results.items():
            right = min(count, ENUMERATED) if tool == "clingo" else count
            if int(each["count"]) != right:
                faults.append(f"{program}: {tool} counts {each['count']}, prag-asp {count}")
        if "clingo" in seconds:
            seconds["clingo"] *= Fraction(count, min(count, ENUMERATED))
        shown = [power(seconds[tool]) if tool in seconds else "-" for tool in COUNTERS]
        faster = power(seconds["clingo"] / seconds[OURS]) if "clingo" in seconds else "-"
        table.add_row(program, f"{count:,}" if count < 10**18 else f"{len(str(count))} digits", *shown, faster)
    return table, reasons, faults


def power(number: Fraction) -> str:
    """Return a number with three digits, or as a power of ten if it is 10^9 or more."""
    return f"{float(number):.3g}" if number < 10**9 else f"10^{len(str(int(number))) - 1}"


def sampling(limit: float) -> tuple[Table, list[str]]:
    """Return the table of sampling colourings, and the reasons for missing results."""
    table = Table("", "samples", "samples/s", "chi2/df", title="4,100 colourings; chi2/df is 1 for uniform samples")
    reasons = []
    for tool in SAMPLERS:
        run = measured(SCRIPT, [tool], limit)
        if run.results:
            last = run.results[-1]
            rate = last["draws"] / max(last["seconds"], 1e-9)
            table.add_row(tool, f"{last['draws']:,}", f"{rate:,.0f}", f"{last['spread']:.3f}")
        else:
            table.add_row(tool, "-", "-", "-")
            reasons.append(f"{tool}: {run.failure}")
    return table, reasons


def large() -> str:
    """Return the sampling rate for a program with very many answer sets."""
    models = answer_sets(text=INDEPENDENT, constants={"n": 9, "m": 9})
    next(models.sample(1))  # compiled
    _, seconds = timed(lambda: list(models.sample(SAMPLES, seed=1)))
    return f"{SAMPLES / seconds:,.0f} samples a second of the {models.count():,} independent sets, once compiled"


@click.command()
@click.option(
    "--limit", type=click.FloatRange(min=1), default=120, show_default=True, help="Processor seconds for each tool."
)
def main(limit: float) -> None:
    """Print both tables."""
    console = Console(width=140)
    counted, missing, faults = counting(limit)
    console.print(counted)
    sampled, more = sampling(limit)
    console.print(sampled)
    for line in (large(), *missing, *more, *faults):
        console.print(line)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
