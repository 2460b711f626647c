"""Count with one tool, in a process of its own: python benchmarks/peers_counting.py SECONDS TOOL FOLDER LEVEL LENGTH.

Each tool is timed from the domain to the count: grounding, clauses and all.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from peers_process import lengths_up_to, limit_processor_time, tell, timed

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.space.engines.word_formula import word_formula

ENUMERATORS = {"clingo": "clingo", "python-sat": "sat"}
"""Tools that find the words one by one, with the engine that does it."""


def formula(domain: Domain, level: Any, length: int) -> Cnf:
    """Return the clauses that all counters get."""
    return word_formula(DomainLogic(domain), level, length).cnf


def by_engine(name: str) -> Callable[[Domain, Any, int], int]:
    """Return how one of our engines counts."""
    return lambda domain, level, length: TaskSpace(domain, length, engine=name).count(level)


def by_ganak(domain: Domain, level: Any, length: int) -> int:
    """Count with pyganak, projected."""
    import pyganak  # noqa: PLC0415

    cnf = formula(domain, level, length)
    counter = pyganak.Counter()
    counter.new_vars(cnf.variables)
    counter.add_clauses(cnf.clauses)
    counter.set_sampling_set(cnf.shown)
    return int(counter.count())


def by_d4(domain: Domain, level: Any, length: int) -> int:
    """Count with d4, which its bindings let count models alone."""
    import py_d4  # noqa: PLC0415

    if level == "skeleton":
        raise SystemExit("the bindings count without projection only")
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
    """Count, and tell the count and the seconds; an enumerator tells those of every length on the way."""
    seconds, tool, folder, level, last = sys.argv[1:]
    limit_processor_time(float(seconds))
    domain = load_domain(folder)
    for length in lengths_up_to(int(last)) if tool in ENUMERATORS else [int(last)]:
        count, taken = timed(lambda length=length: TOOLS[tool](domain, level, length))  # type: ignore[misc]
        tell(length=length, count=count, seconds=taken)


if __name__ == "__main__":
    main()
