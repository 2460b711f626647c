"""Compare `models count` with the fastest other engine on many programs: python benchmarks/model_engines.py --limit 20.

The engines are clingo's enumeration, pyganak and d4, the latter two on our clauses, without the time to write them. All
of them run one after the other in each round, and the least processor time of all rounds counts, that of children
included. Install d4 with: pip install d4solver. Exits with code 1 if two counts differ, or if ours takes more than 1.5
times the fastest and 0.3 s.
"""

from __future__ import annotations

import sys
from pathlib import Path

import click
from model_programs import PROGRAMS, Shape
from peers_process import limit_processor_time, measured, report, timed
from rich.console import Console
from rich.table import Table

from prag_asp import AnswerSets, answer_sets

OURS = "prag-asp"
TOOLS = (OURS, "clingo", "pyganak", "d4")
TIMES, SECONDS = 1.5, 0.3
"""The target: at most so many times the fastest engine, and so many seconds."""


def opened(shape: Shape) -> AnswerSets:
    """Return the answer sets of a program, as the command reads them."""
    return answer_sets(text=shape.text, constants=shape.constants, project=shape.project)


def count_with(tool: str, shape: Shape) -> tuple[int, float]:
    """Return the count of one tool and its processor seconds, from the text or, for counters, from the clauses."""
    opened(Shape("{a;b}. a :- b. b :- a."))._compiled.compile(lambda: None)  # load lazy imports
    if tool == OURS:
        return timed(lambda: opened(shape).count())
    if tool == "clingo":
        return timed(lambda: enumerate_models(shape))
    found = opened(shape)
    if found._compiled.no_clauses:
        raise SystemExit(found._compiled.no_clauses)
    cnf = found._compiled.counting_formula.cnf
    if tool == "pyganak":
        import pyganak  # noqa: PLC0415

        counter = pyganak.Counter()
        counter.new_vars(cnf.variables)
        counter.add_clauses(cnf.clauses)
        counter.set_sampling_set(cnf.shown)
        return timed(lambda: int(counter.count()))
    import py_d4  # noqa: PLC0415

    if shape.project:
        raise SystemExit("the bindings do not support projection")
    clauses = [list(clause) for clause in cnf.clauses]
    return timed(lambda: int(py_d4.Solver(clauses, cnf.variables).count().getResult()))


def enumerate_models(shape: Shape) -> int:
    """Return the number of answer sets that clingo enumerates."""
    import clingo  # noqa: PLC0415

    control = clingo.Control(["0", "--project=auto" if shape.project else "--project=no"], logger=lambda *_: None)
    control.add("base", [], shape.full_text)
    control.ground([("base", [])])
    control.solve()
    return int(control.statistics["summary"]["models"]["enumerated"])


def compare(name: str, limit: float, rounds: int) -> tuple[dict[str, float], list[int]]:
    """Return the least seconds of each tool that counts a program within the limit, and the distinct counts."""
    seconds: dict[str, float] = {}
    counts: set[int] = set()
    for tool in TOOLS * rounds:
        run = measured(Path(__file__), [tool, name], limit)
        if run.results:
            counts.add(int(run.results[-1]["count"]))
            seconds[tool] = min(seconds.get(tool, limit), float(run.results[-1]["seconds"]))
    return seconds, sorted(counts)


@click.command()
@click.option("--limit", type=click.FloatRange(min=1), default=20, show_default=True, help="Processor seconds a run.")
@click.option("--rounds", type=click.IntRange(min=1), default=1, show_default=True, help="Runs of each tool.")
@click.option("--only", default="", metavar="TEXT", help="Only programs whose names have this text.")
def main(limit: float, rounds: int, only: str) -> None:
    """Print the table."""
    table = Table("program", "answer sets", *(f"{tool}, s" for tool in TOOLS), "times the fastest")
    faults = []
    for name in (each for each in PROGRAMS if only in each):
        seconds, counts = compare(name, limit, rounds)
        fastest = min((taken for tool, taken in seconds.items() if tool != OURS), default=limit)
        ours = seconds.get(OURS, limit)
        shown = [f"{seconds[tool]:.3f}" if tool in seconds else "-" for tool in TOOLS]
        number = (
            f"{counts[0]:,}" if counts and counts[0] < 10**12 else f"{len(str(counts[0]))} digits" if counts else "-"
        )
        table.add_row(name, number, *shown, f"{ours / max(fastest, 0.001):.2g}")
        sys.stderr.write(f"{name}: {' '.join(shown)} {counts[:2]}\n")
        if len(counts) > 1:
            faults.append(f"{name}: counts differ: {', '.join(map(str, counts))}")
        if fastest < limit and ours > TIMES * fastest + SECONDS:
            faults.append(f"{name}: {ours:.2f} s, the fastest {fastest:.2f} s")
    console = Console(width=140)
    console.print(table)
    for line in faults:
        console.print(line)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[2] in TOOLS:
        limit_processor_time(float(sys.argv[1]))
        count, taken = count_with(sys.argv[2], PROGRAMS[sys.argv[3]])
        report(count=str(count), seconds=taken)
    else:
        main()
