"""Sample with one tool in a separate process: python benchmarks/peers_sampling.py SECONDS TOOL FOLDER LENGTH DRAWS."""

from __future__ import annotations

import random
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from time import monotonic

import clingo
from peers_process import limit_processor_time, processor_seconds, report

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.ground.ground_step import unrolled
from prag_asp.program.grounding import Grounder
from prag_asp.space.engines.word_formula import word_formula

REPORT = 5.0
"""Seconds between two results, so that there is a result if the tool is stopped."""

Draws = Iterator[tuple[object, ...]]


def plan_formula(domain: Domain, length: int) -> Cnf:
    """Return the clauses for all samplers."""
    return word_formula(DomainLogic(domain), "plan", length).cnf


def automaton(domain: Domain, length: int) -> Draws:
    """Sample with our engine."""
    for draw in TaskSpace(domain, length, engine="automaton").sampling(weights={}, by="plan").draws(seed=0):
        yield draw.word


def unigen(domain: Domain, length: int) -> Draws:
    """Sample almost uniformly with unigen, in batches of 50."""
    import pyunigen  # noqa: PLC0415

    cnf = plan_formula(domain, length)
    seeds = random.Random(0)
    while True:
        sampler = pyunigen.Sampler(seed=seeds.randrange(2**31))
        for clause in cnf.clauses:
            sampler.add_clause(list(clause))
        _, _, models = sampler.sample(num=50, sampling_set=list(cnf.shown))
        for model in models:
            yield tuple(literal for literal in model if literal > 0)


def cmsgen(domain: Domain, length: int) -> Draws:
    """Sample with cmsgen, which gives no guarantee of uniformity."""
    import pycmsgen  # noqa: PLC0415

    cnf = plan_formula(domain, length)
    solver = pycmsgen.Solver(seed=1)
    solver.add_clauses([list(clause) for clause in cnf.clauses])
    while True:
        _, values = solver.solve()
        yield tuple(variable for variable in cnf.shown if values[variable])


def clingo_signs(domain: Domain, length: int) -> Draws:
    """Sample with clingo: random decisions and signs, and a new search for each plan."""
    grounder = Grounder(DomainLogic(domain).program, "1", "--rand-freq=1", "--sign-def=rnd")
    grounder.ground([("base", []), *unrolled(length)])
    plans: list[tuple[object, ...]] = []

    def add(model: clingo.Model) -> None:
        atoms = model.symbols(atoms=True)
        plans.append(tuple(sorted(str(atom) for atom in atoms if atom.match("occurs", 2))))

    seeds = random.Random(0)
    while True:
        solver = grounder.control.configuration.solver
        assert isinstance(solver, clingo.Configuration)
        solver[0].seed = str(seeds.randrange(2**31))
        grounder.control.solve(on_model=add)
        yield plans.pop()


TOOLS: dict[str, Callable[[Domain, int], Draws]] = {
    "automaton": automaton,
    "pyunigen": unigen,
    "pycmsgen": cmsgen,
    "clingo, random signs": clingo_signs,
}


def main() -> None:
    """Sample, and report the rate and the deviation from uniform frequencies, every few seconds and at the end."""
    seconds, tool, folder, length, draws = sys.argv[1:]
    limit_processor_time(float(seconds))
    domain = load_domain(folder)
    plans = TaskSpace(domain, int(length)).count("plan")
    begun, reported = processor_seconds(), monotonic()
    seen: Counter[tuple[object, ...]] = Counter()
    for number, word in enumerate(TOOLS[tool](domain, int(length)), 1):
        seen[word] += 1
        if number == int(draws) or monotonic() - reported > REPORT:
            reported = monotonic()
            report(draws=number, seconds=processor_seconds() - begun, spread=_spread(seen, plans), plans=plans)
        if number == int(draws):
            break


def _spread(seen: Counter[tuple[object, ...]], plans: int) -> float:
    """Return chi-square over its degrees of freedom: about 1 for uniform samples, for any number of them."""
    expected = seen.total() / plans
    assert len(seen) <= plans
    squares = sum((number - expected) ** 2 for number in seen.values()) + (plans - len(seen)) * expected**2
    return squares / expected / (plans - 1)


if __name__ == "__main__":
    main()
