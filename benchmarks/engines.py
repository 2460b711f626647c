"""Compare the four engines on domains that suit one or another of them: python benchmarks/engines.py [SECONDS].

Each count runs in a separate process, limited to SECONDS of processor time; the engine sharp needs its extra.
"""

from __future__ import annotations

import resource
import sys
from pathlib import Path

from peers_process import limit_processor_time, measured, report
from rich.console import Console
from rich.table import Table

from prag_asp import Limits, TaskSpace, load_domain

ENGINES = ("automaton", "symbolic", "clingo", "sharp")

APART = """
fluent(on). initially(on,false). action((a;b;c;d)). postcondition(a,on,true). postcondition((b;c;d),on,false).
#program step(t). :- occurs(A,t), occurs(A,t-2), t > 2.
"""
ROW = """
class(thing). entity(thing(1..12), thing). fluent(at(T,1..12)) :- entity(T,thing).
initially(at(thing(I),I), true) :- entity(thing(I),thing). initially(F,false) :- fluent(F), not initially(F,true).
action(swap(1..11)). goal(at(thing(1),2),true).
#program step(t).
holds(at(T,P),V,t)      :- occurs(swap(P),t), holds(at(T,P+1),V,t-1).
holds(at(T,P+1),V,t)    :- occurs(swap(P),t), holds(at(T,P),V,t-1), P < 12.
changed(at(T,P..P+1),t) :- occurs(swap(P),t), entity(T,thing).
"""
LAMPS = """
class(kind(1..40)). entity(lamp(I),kind(I)) :- class(kind(I)). initially(F,false) :- fluent(F).
fluent(lit(L)) :- entity(L,_). action(light(L)) :- entity(L,_).
precondition(light(L),lit(L),false) :- entity(L,_). postcondition(light(L),lit(L),true) :- entity(L,_).
"""
CASES = {
    "no action equal to the last but one": (APART, "", (10, 20)),
    "prag, loop-free": ("prag", "loop-free", (4,)),
    "hanoi, loop-free": ("hanoi", "loop-free", (10,)),
    "12 in a row, neighbours swap": (ROW, "", (6, 8)),
    "40 lamps, each lit once": (LAMPS, "", (4, 5)),
}
"""For each case: a domain (its name or its text), a condition on plans, and the lengths."""


def count(case: str, engine: str, length: int) -> None:
    """Count in this process, and report the count and the processor seconds of this process and its children."""
    domain, condition, _ = CASES[case]
    loaded = load_domain(domain) if "\n" not in domain else load_domain(text=domain)
    space = TaskSpace(loaded, length, engine=engine, limits=Limits(cached=False))
    before = resource.getrusage(resource.RUSAGE_SELF)
    result = (space.where(condition) if condition else space).count("plan")
    after, below = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    own = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    report(count=str(result), seconds=round(own + below.ru_utime + below.ru_stime, 2))


def main(limit: float) -> None:
    """Count each case with each engine, check that all counts agree, and print a table."""
    table = Table("domain", "length", "plans", *ENGINES, title=f"processor seconds, at most {limit:g}")
    for case, (_, _, lengths) in CASES.items():
        for length in lengths:
            runs = [measured(Path(__file__), [case, engine, str(length)], limit) for engine in ENGINES]
            counts = {run.results[0]["count"] for run in runs if run.results}
            assert len(counts) == 1, (case, length, counts)
            cells = [str(run.results[0]["seconds"]) if run.results else "-" for run in runs]
            table.add_row(case, str(length), *counts, *cells)
    Console().print(table)


if __name__ == "__main__":
    if len(sys.argv) > 2:
        limit_processor_time(float(sys.argv[1]))
        count(sys.argv[2], sys.argv[3], int(sys.argv[4]))
    else:
        main(float(sys.argv[1]) if len(sys.argv) == 2 else 25)
