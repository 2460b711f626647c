"""Count with one tool in a separate process: python benchmarks/peers_counting.py SECONDS TOOL FOLDER LEVEL LENGTH.

Each tool is timed from the domain to the count: including grounding and translation to clauses.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from peers_process import lengths_up_to, limit_processor_time, report, timed

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.space.engines.word_formula import word_formula

ENUMERATORS = {"clingo": "clingo", "python-sat": "sat"}
"""Tools that enumerate the plans one by one, with the name of our engine for each."""


def formula(domain: Domain, level: Any, length: int) -> Cnf:
    """Return the clauses for all counters."""
    return word_formula(DomainLogic(domain), level, length).cnf


def by_engine(name: str) -> Callable[[Domain, Any, int], int]:
    """Return a function that counts with one of our engines."""
    return lambda domain, level, length: TaskSpace(domain, length, engine=name).count(level)


def by_ganak(domain: Domain, level: Any, length: int) -> int:
    """Count with pyganak, with projection."""
    import pyganak  # noqa: PLC0415

    cnf = formula(domain, level, length)
    counter = pyganak.Counter()
    counter.new_vars(cnf.variables)
    counter.add_clauses(cnf.clauses)
    counter.set_sampling_set(cnf.shown)
    return int(counter.count())


def by_d4(domain: Domain, level: Any, length: int) -> int:
    """Count with d4, whose bindings do not support projection."""
    import py_d4  # noqa: PLC0415

    if level == "skeleton":
        raise SystemExit("the bindings do not support projection")
    cnf = formula(domain, level, length)
    return int(py_d4.Solver([list(clause) for clause in cnf.clauses], cnf.variables).count().getResult())


def by_tididi(domain: Domain, level: Any, length: int) -> int:
    """Count with tididi-cnf: models for plans, which is faster, and projected models for skeletons."""
    import tididi_cnf  # noqa: PLC0415

    cnf = formula(domain, level, length)
    projected = {"mode": "pmc", "show": cnf.shown} if level == "skeleton" else {"mode": "mc"}
    return int(tididi_cnf.count(cnf.clauses, num_vars=cnf.variables, **projected).count)


def by_approxmc(domain: Domain, level: Any, length: int) -> int:
    """Estimate with approxmc, at its default tolerance."""
    import pyapproxmc  # noqa: PLC0415

    cnf = formula(domain, level, length)
    counter = pyapproxmc.Counter(seed=1)
    counter.add_clauses([list(clause) for clause in cnf.clauses])
    cells, hashes = counter.count(projection=list(cnf.shown))
    return int(cells * 2**hashes)


TOOLS: dict[str, Callable[[Domain, Any, int], int]] = {
    "automaton": by_engine("automaton"),
    **{tool: by_engine(engine) for tool, engine in ENUMERATORS.items()},
    "pyganak": by_ganak,
    "d4": by_d4,
    "tididi-cnf": by_tididi,
    "approxmc": by_approxmc,
}


def main() -> None:
    """Report the count and the seconds; an enumerator reports those of every length up to LENGTH."""
    seconds, tool, folder, level, last = sys.argv[1:]
    limit_processor_time(float(seconds))
    domain = load_domain(folder)
    for length in lengths_up_to(int(last)) if tool in ENUMERATORS else [int(last)]:
        count, taken = timed(lambda length=length: TOOLS[tool](domain, level, length))  # type: ignore[misc]
        report(length=length, count=count, seconds=taken)


if __name__ == "__main__":
    main()
